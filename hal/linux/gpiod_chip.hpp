#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "hal/base/result.hpp"
#include "hal/bus/gpio_lines.hpp"
#include "hal/linux/gpio_inventory.hpp"

namespace thimble::linux {

// All that hal/linux asks of libgpiod, and the only place that knows which of its two interfaces
// this is: gpiod_1.cpp is compiled with 1.6 (Debian 12), gpiod_2.cpp with 2.x, as CMake finds it.

struct GpiodEdge {
  bool is_high{false};
  bool is_after_loss{false};  // others between it and the one before were lost, or may have been
  bool operator==(const GpiodEdge&) const = default;
};
struct GpiodEdges {
  // Of one line, as many as Linux 6.1 keeps (gpiolib-cdev.c: lineevent_state; a linereq of one).
  static constexpr std::size_t kMost = 16;

  std::array<GpiodEdge, kMost> edges{};
  std::size_t count{0};  // kMost: there may be more
};

// How an input is asked for.
struct GpiodInput {
  bus::GpioPull pull{bus::GpioPull::AsIs};
  bool has_edges{false};  // both ways
};

// One line of a chip, which nobody else can have as long as it lives.
//
// Which edges were lost: libgpiod 2 hands on the kernel's numbers, and a hole in them is a loss.
// Libgpiod 1.6 has no numbers: the kernel drops those of a line behind 16 that wait, so that 16
// that are read at once come after a loss, whether there was one or not (docs/decisions/0474).
//
// Thread: one at a time. Not RT: each call, the destructor too, may be a transfer that lasts
// seconds. Errors: of the functions that give no Result, in errno.
class GpiodLine {
 public:
  struct State;
  explicit GpiodLine(std::unique_ptr<State> state) noexcept;
  ~GpiodLine();
  GpiodLine(GpiodLine&&) noexcept;
  GpiodLine& operator=(GpiodLine&&) noexcept;

  // Of an input with edges: readable while some wait; hung up, or an error, when the line is gone.
  [[nodiscard]] int fd() const noexcept;
  [[nodiscard]] std::optional<bool> level() noexcept;
  // Of an output. That the chip did not take it nobody is told: Linux 6.1, a driver's set()
  // returns nothing.
  [[nodiscard]] bool set(bool is_high) noexcept;
  // Those that wait, the oldest first. Waits where there is none.
  [[nodiscard]] bool read_edges(GpiodEdges& out) noexcept;

 private:
  std::unique_ptr<State> state_;
};

// A chip, by its node. Looking at one changes nothing in it.
// Thread, real-time class: as GpiodLine. Ownership: lines outlive it.
class GpiodChip {
 public:
  struct State;
  // Errors: Permission, NotFound, System.
  [[nodiscard]] static Result<GpiodChip> open(const std::string& node);
  ~GpiodChip();
  GpiodChip(GpiodChip&&) noexcept;
  GpiodChip& operator=(GpiodChip&&) noexcept;

  [[nodiscard]] const std::string& label() const noexcept;  // of any bytes: the chip's own
  [[nodiscard]] std::size_t lines() const noexcept;
  // Its texts are of any bytes, too. Errors: NotFound for a chip that is gone, System for a place
  // beyond lines().
  [[nodiscard]] Result<GpioLineInfo> line_info(std::size_t line) const;
  // The place of the first line of that name.
  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;
  // An output is low from here on. `name`: what errors call it. Errors: Busy where somebody has it,
  // Permission, NotFound, System.
  [[nodiscard]] Result<GpiodLine> request_output(std::size_t line, const std::string& name) const;
  [[nodiscard]] Result<GpiodLine> request_input(std::size_t line, const std::string& name,
                                                const GpiodInput& input) const;

 private:
  explicit GpiodChip(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace thimble::linux
