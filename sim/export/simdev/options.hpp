#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace thimble::sim {

inline constexpr int kExitUsage = 2;  // the command line is a mistake

struct SimdevOptions {
  std::string model;                 // "phantom-vintage"; "sim:" in front is taken off
  std::vector<std::string> plugins;  // files that bring more of them
  bool is_uhid{false};
  bool is_vhci{false};
  // 0: one that is free, which is then printed.
  std::optional<std::uint16_t> usbip_port;
  std::string socket;          // of the verbs; empty: none
  std::string serial_number;   // empty: as the model says
  double amplifier_max_a{0};   // 0: as the model says
  unsigned frames_at_once{0};  // 0: each round of each frame at its own time
  // Of a frame's model time; 0: all of it is computed when the bus looks. Not with frames_at_once.
  unsigned slices_per_frame{0};
  // Of what is left to chance: in the model, and in the faults that it is told to show.
  std::uint64_t seed{0};
};

// What the command line says, or the exit status where that ends the program: 0 after --help or
// --version, 2 after a mistake, which is printed. Thread: the main one. Not RT.
[[nodiscard]] tl::expected<SimdevOptions, int> parse_simdev_options(int argc,
                                                                    const char* const* argv);

}  // namespace thimble::sim
