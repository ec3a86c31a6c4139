#define THIMBLE_VECTOR_BYTES 32
#define THIMBLE_WORTH_OPS 160
#define THIMBLE_KERNELS kAvx2Kernels
#define THIMBLE_KERNELS_NAME "avx2"
#include "sim/model/cam/engine/vector_kernels_body.hpp"
