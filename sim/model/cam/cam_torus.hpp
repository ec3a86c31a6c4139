#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/model/cam/cam_module.hpp"

namespace thimble::sim::cam {

struct TorusShape {
  std::array<std::size_t, 3> modules{1, 1, 1};  // along x, y, z
  int log2_sites{22};                           // of a module

  [[nodiscard]] std::size_t size() const noexcept { return modules[0] * modules[1] * modules[2]; }
};

// Glue pins in the order of their register: XM, XP, YM, YP, ZM, ZP.
inline constexpr std::size_t kPins = 6;

// Modules and the glue wires between them: XP of one is wired to XM of the next along x, and so on
// around. Module (x, y, z) has index x + X (y + Y z).
class CamTorus {
 public:
  // Module 0 is the marked one.
  explicit CamTorus(const TorusShape& shape);

  [[nodiscard]] std::size_t size() const noexcept { return modules.size(); }
  // At the other end of a pin's wire: always the opposite pin.
  [[nodiscard]] std::size_t neighbor(std::size_t module, std::size_t pin) const noexcept {
    return neighbors_[module][pin];
  }
  [[nodiscard]] static std::size_t opposite(std::size_t pin) noexcept { return pin ^ 1U; }

  // The AND of what each layer of a module senses on its glue pins while nothing scans.
  [[nodiscard]] std::uint16_t glue_and(std::size_t module) const noexcept;

  std::vector<CamModule> modules;

 private:
  std::vector<std::array<std::size_t, kPins>> neighbors_;
};

// Which code connects a pin of a module, for one layer.
[[nodiscard]] std::uint32_t connection(const CamModule& module, std::size_t pin,
                                       std::size_t layer) noexcept;

}  // namespace thimble::sim::cam
