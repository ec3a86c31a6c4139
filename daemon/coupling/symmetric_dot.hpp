#pragma once

#include "daemon/world/push_out.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// Sum of the products along the axes, in order of size: permuted axes give the same bits. Units and
// frame: of its arguments. Thread: any. RT: THIMBLE_RT. Errors: none, what is not finite stays so.
template <class A, class B>
[[nodiscard]] THIMBLE_RT double symmetric_dot(A a, B b) noexcept {
  return world::symmetric_sum(a.x * b.x, a.y * b.y, a.z * b.z);
}

}  // namespace thimble::coupling
