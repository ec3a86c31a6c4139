#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "hal/base/burst_pause.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/gpio_mailboxes.hpp"
#include "hal/linux/gpiod_chip.hpp"

namespace thimble::linux {

// What the bus does with the lines of one GPIO chip, through libgpiod (gpiod_chip.hpp).
//
// Edges that were lost leave a hole in the numbers, as GpiodLine knows of them. A lost edge shows
// as one that repeats the level before it, too (GpioMailboxes counts so), or as a level that the
// chip tells otherwise. A chip that is pulled out wakes nobody (Linux 6.1, gpiolib-cdev.c): asking
// for the levels finds out. A level that the chip did not take is told to nobody either: each is
// followed by a question, and until that has an answer the output is written again, whatever level
// it shall have by then.
//
// A CP2112 has no edges to tell: its driver reads the levels every 40 ms and makes them. Who lets
// go of such a line while it reads makes Linux sleep where it may not (hid-cp2112.c, 6.1: a
// cancel_delayed_work_sync() below a spin lock), after which the process that did it dies at its
// next page fault (docs/decisions/0516). So its lines are asked for their levels and nothing else,
// and the edges are made here, of what differs from reading to reading.
//
// Thread: one at a time. Not RT: behind USB or I2C each call is a transfer that may last seconds.
// Ownership: the mailboxes and the clock must outlive it. Outputs go low before it closes.
// Errors: Result when opening; a chip that is gone shows in the mailboxes.
class GpioTransfers {
 public:
  // `folder` has the nodes, "gpiochip0" and so on. Looking for the chip opens those that it may,
  // which changes nothing in them. Errors: as bus::GpioChips::open().
  [[nodiscard]] static Result<std::unique_ptr<GpioTransfers>> open(const std::string& folder,
                                                                   const bus::GpioClaim& claim,
                                                                   bus::GpioMailboxes& mail,
                                                                   const Clock& clock);
  ~GpioTransfers();
  GpioTransfers(const GpioTransfers&) = delete;
  GpioTransfers& operator=(const GpioTransfers&) = delete;

  // Until an edge waits, `wake` is readable, or levels are to be read; while the lines chatter, no
  // more often than BurstPause has it.
  void wait(int wake) noexcept;
  // Brings the edges and the levels that are due, and takes the outputs.
  void serve() noexcept;

 private:
  GpioTransfers(bool has_edges, bus::GpioMailboxes& mail, const Clock& clock) noexcept
      : mail_(&mail), clock_(&clock), has_edges_(has_edges) {}
  [[nodiscard]] Result<void> request(const GpiodChip& chip, const bus::GpioClaim& claim);
  void take_edges() noexcept;
  bool take_edges_of(std::size_t input) noexcept;
  void read_levels() noexcept;
  void make_edges(std::uint32_t high, std::uint32_t answered, MonotonicTime at) noexcept;
  void write_outputs() noexcept;
  [[nodiscard]] static bool write(GpiodLine& line, bool is_high) noexcept;
  void note(int code) noexcept;

  bus::GpioMailboxes* mail_;
  const Clock* clock_;
  bool has_edges_;  // the kernel's, to be told
  std::vector<GpiodLine> inputs_;
  std::vector<GpiodLine> outputs_;
  std::uint32_t written_{0};
  std::uint32_t unsure_{0};  // outputs of which nobody knows whether the chip took the last level
  std::uint32_t read_{0};    // the levels before, where edges are made of them
  std::uint32_t known_{0};   // inputs that have one
  MonotonicTime next_read_{};
  BurstPause pause_;
};

}  // namespace thimble::linux
