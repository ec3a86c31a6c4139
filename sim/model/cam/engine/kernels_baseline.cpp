#define THIMBLE_VECTOR_BYTES 16
#define THIMBLE_WORTH_OPS 140
#define THIMBLE_KERNELS kBaselineKernels
#define THIMBLE_KERNELS_NAME "baseline"
#include "sim/model/cam/engine/vector_kernels_body.hpp"
