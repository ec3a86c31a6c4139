#pragma once

#include <array>
#include <optional>

#include "hal/rt/annotations.hpp"
#include "sim/model/falcon/falcon_parameters.hpp"
#include "sim/model/falcon/triple.hpp"

namespace thimble::sim {

// What ties the grip to the three cranks: for each leg, with p from its knee to where its rods end
// (in the plane of the crank) and y the grip's place across that plane,
//
//   G = ((|p| - (d + e))² + y² - b²) / 2 = 0
//
// since the parallelogram spans sqrt(b² - y²) of |p| and the links at its ends the rest. README.md
// has the derivation. Differentiated, A x' + diag(b) q' = 0 and A x" + diag(b) q" + h = 0.
//
// Frame: the device's, z out of it towards the person; m, rad.
// Thread: immutable, any. RT: all but the constructor. Errors: nothing where no pose exists.
class DeltaLinkage {
 public:
  explicit DeltaLinkage(const FalconParameters& parameters);

  // Sines and cosines of the cranks' angles; everything else is made of them.
  struct Cranks {
    Triple sine, cosine;
  };
  THIMBLE_RT [[nodiscard]] static Cranks cranks(const Triple& q_rad) noexcept;

  // Of the same cranks after that step.
  THIMBLE_RT [[nodiscard]] static Cranks turned(const Cranks& from,
                                                const Triple& step_rad) noexcept;

  // Of a leg's plane: p, its length, and y.
  struct Reach {
    double out_m, up_m, length_m, across_m;
  };
  struct Constraint {
    Triple value;  // G, m²; 0 where grip and cranks fit
    Matrix3 a;     // dG/dx
    Triple b;      // dG/dq of each leg's own crank
    std::array<Reach, 3> reach;
  };
  // Cranks, the grip that they hold, and the constraint there.
  struct Pose {
    Cranks cranks;
    Triple x;
    Constraint constraint;
    Matrix3 a_inverse;
  };
  THIMBLE_RT [[nodiscard]] Constraint constrain(const Cranks& cranks,
                                                const Triple& x) const noexcept;
  // h: what G" is when neither crank nor grip accelerates; `at`: the constraint where they are.
  THIMBLE_RT [[nodiscard]] Triple bias(const Cranks& cranks, const Constraint& at,
                                       const Triple& rate, const Triple& velocity) const noexcept;
  // Crank angles that hold the grip at `x`, knees outwards. Closed form.
  THIMBLE_RT [[nodiscard]] std::optional<Triple> inverse(const Triple& x) const noexcept;
  // Where the cranks hold the grip, sought from `near`; the grip must not be more than a few
  // centimetres from it, else another way to assemble the arm may be found.
  THIMBLE_RT [[nodiscard]] std::optional<Pose> forward(const Cranks& cranks,
                                                       const Triple& near) const noexcept;

 private:
  struct Leg {
    Triple outward, across;  // unit vectors; the third is z
  };
  [[nodiscard]] Reach reach(std::size_t leg, const Cranks& cranks, const Triple& x) const noexcept;

  FalconParameters p_;
  std::array<Leg, 3> legs_{};
};

}  // namespace thimble::sim
