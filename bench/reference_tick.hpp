#pragma once

// The force law of one wall and nothing else, in plain code without headers of the project: what
// a tick cannot be cheaper than on this machine.
class ReferenceTick {
 public:
  void tick() noexcept;

 private:
  double position_m_{0.015};
  double sum_newton_{0};
};
