#include "daemon/coupling/surface_touch.hpp"

#include "daemon/coupling/coordinate_frame.hpp"

namespace thimble::coupling {

Force3 rub(Displacement3& stretch, Velocity3 sliding, const SurfaceProperties& surface,
           double hold_newton) noexcept {
  const double stiffness = surface.stiffness.newton_per_m;
  const double length_m = symmetric_length_m(stretch);
  if (stiffness * length_m > hold_newton)
    stretch = (hold_newton / (stiffness * length_m)) * stretch;
  const double damping = surface.damping.newton_s_per_m;
  const Displacement3 wanted{stiffness * stretch.x + damping * sliding.x,
                             stiffness * stretch.y + damping * sliding.y,
                             stiffness * stretch.z + damping * sliding.z};
  const double size_newton = symmetric_length_m(wanted);
  const double share = size_newton > hold_newton ? hold_newton / size_newton : 1;
  return Force3{-share * wanted.x, -share * wanted.y, -share * wanted.z};
}

}  // namespace thimble::coupling
