#pragma once

// Largest stable stiffnesses, N/m. Symbols: m mass of hand and arm, kg; b damping of both, N·s/m;
// D delay there and back, s; Ts period of the servo, s; B damping of the scheme, N·s/m.
// Pure. Errors: none; all arguments must be positive.
namespace thimble::lab {

// K = b/(Ts/2 + D): a wall of which the force comes back late (Gil; Diolaiti; Hulin), short D.
// SOURCE: teleop.md 2(a).
[[nodiscard]] double short_delay_limit_newton_per_m(double damping_newton_s_per_m, double delay_s,
                                                    double period_s);

// The same for any D: m·s² + b·s + K·exp(−s·τ) = 0, τ = D + Ts/2, has a root s = jω where
// ω·tan(ω·τ) = b/m, K = b·ω/sin(ω·τ), 0 < ω·τ < π/2. For D → 0 the formula above. Ours.
struct Crossing {
  double newton_per_m{0};
  double swing_hz{0};  // at which it swings there
};
[[nodiscard]] Crossing any_delay_limit(double mass_kg, double damping_newton_s_per_m,
                                       double delay_s, double period_s);

// K_c = 2·B/(D + Ts), spring and dampers with a force at both ends. SOURCE: teleop.md 2(b),
// 4·B_m·B_s > D²·K_c², sufficient; Ts is ours: half of it a force is held, half of it lies between
// a velocity and the two positions of which it is made.
[[nodiscard]] double both_ends_limit_newton_per_m(double damping_newton_s_per_m, double delay_s,
                                                  double period_s);

// K_c = 1.5·B/(D + Ts), the same with the force at the world's end only. Sufficient.
// SOURCE: decision 0421; Ts as above.
[[nodiscard]] double world_end_limit_newton_per_m(double damping_newton_s_per_m, double delay_s,
                                                  double period_s);

}  // namespace thimble::lab
