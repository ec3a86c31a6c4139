#define THIMBLE_VECTOR_BYTES 64
#define THIMBLE_WORTH_OPS 240
#define THIMBLE_KERNELS kAvx512Kernels
#define THIMBLE_KERNELS_NAME "avx512"
#include "sim/model/cam/engine/vector_kernels_body.hpp"
