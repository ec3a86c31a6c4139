#include "sim/model/cam/cam_torus.hpp"

namespace thimble::sim::cam {

namespace field = cambus::field;

namespace {

// The layers in which a pin is connected by such a code.
std::uint32_t layers_with(const CamModule& module, std::size_t pin, std::uint32_t code) {
  const cambus::Field& of = field::kConnect[pin];
  std::uint32_t layers = 0xffff;
  for (std::size_t bit = 0; bit < of.bits; ++bit) {
    const std::uint32_t plane = module.registers.planes(of.of)[of.first_bit + bit];
    layers &= (code >> bit & 1U) != 0 ? plane : ~plane;
  }
  return layers;
}

}  // namespace

CamTorus::CamTorus(const TorusShape& shape) {
  const auto& along = shape.modules;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    modules.emplace_back(shape.log2_sites, i == 0);
    const std::array<std::size_t, 3> at{i % along[0], i / along[0] % along[1],
                                        i / (along[0] * along[1])};
    auto& wires = neighbors_.emplace_back();
    for (std::size_t pin = 0; pin < kPins; ++pin) {
      const std::size_t axis = pin / 2;
      const std::size_t step = pin % 2 == 1 ? 1 : along[axis] - 1;
      auto there = at;
      there[axis] = (at[axis] + step) % along[axis];
      wires[pin] = there[0] + along[0] * (there[1] + along[1] * there[2]);
    }
  }
}

std::uint32_t connection(const CamModule& module, std::size_t pin, std::size_t layer) noexcept {
  return module.registers.get(field::kConnect[pin], layer);
}

// A pin that is a constant is an output and reads itself; any other senses what its wire carries,
// which is 1 unless the other end is the constant 0.
std::uint16_t CamTorus::glue_and(std::size_t module) const noexcept {
  std::uint32_t all = 0xffff;
  for (std::size_t pin = 0; pin < kPins; ++pin) {
    const CamModule& other = modules[neighbor(module, pin)];
    const std::uint32_t is_0 = layers_with(modules[module], pin, cambus::kPinIs0) |
                               (layers_with(other, opposite(pin), cambus::kPinIs0) &
                                ~layers_with(modules[module], pin, cambus::kPinIs1));
    all &= ~is_0;
  }
  return static_cast<std::uint16_t>(all);
}

}  // namespace thimble::sim::cam
