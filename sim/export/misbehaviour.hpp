#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>

#include "hal/base/time.hpp"

namespace thimble::sim {

// What a device that is offered to a kernel does wrong on demand.
//
// Thread: one, that of its port. RT: all: no allocation, lock or system call; spoil() is bounded by
//     the room. Times: the model's clock. Errors: none.
class Misbehaviour {
 public:
  explicit Misbehaviour(std::uint64_t seed) noexcept : random_(seed) {}

  // Refuses everything: endpoints and requests stall, what is written is lost.
  void stall_until(MonotonicTime t) noexcept { stalls_until_ = t; }
  // Neither takes nor gives anything, and refuses nothing: it says NAK.
  void be_silent_until(MonotonicTime t) noexcept { silent_until_ = t; }
  // The next `reports` that it sends have 1 to 8 bits turned over, picked by chance (one that is
  // picked twice is turned back); are cut to half; are made 2 n + 1 bytes of n, but no more than
  // there is room for, or one more than that where they fill it. One report may be due for all
  // three, in this order.
  void corrupt(std::uint32_t reports) noexcept { corrupt_ = reports; }
  void shorten(std::uint32_t reports) noexcept { short_ = reports; }
  void babble(std::uint32_t reports) noexcept { babble_ = reports; }
  // Of the next `packets` that it is sent it takes the first half, and the host may hear how much.
  void cut_what_comes(std::uint32_t packets) noexcept { cut_ = packets; }

  // The next `transfers` halt the endpoint that they are on, until the host ends that (USB 2.0,
  // 9.4.5): not requests, which have nothing to halt.
  void halt(std::uint32_t transfers) noexcept { halt_ = transfers; }

  // Asked for each transfer that the model would be asked for, of which it counts those that halt.
  [[nodiscard]] bool halts(bool is_in) noexcept;
  // Asked for each transfer or request, of which it counts those that it refuses.
  [[nodiscard]] bool refuses(MonotonicTime now) noexcept {
    if (!is_stalling(now)) return false;
    ++struck_.refused;
    return true;
  }
  [[nodiscard]] bool is_stalling(MonotonicTime now) const noexcept { return now < stalls_until_; }
  [[nodiscard]] bool is_silent(MonotonicTime now) const noexcept { return now < silent_until_; }
  // Somebody waited for it in a round in which it was silent.
  void note_unanswered() noexcept { ++struck_.unanswered; }
  // Does to the report in the first `size` bytes of `room` what is due. Returns its new size; more
  // than `room` for one that babbles beyond it.
  [[nodiscard]] std::size_t spoil(std::span<std::uint8_t> room, std::size_t size) noexcept;

  // What it would take of a packet or report that it is sent; then that it took it: a NAK takes
  // nothing, and the same one comes again.
  [[nodiscard]] std::span<const std::uint8_t> taken_of(
      std::span<const std::uint8_t> sent) const noexcept {
    return cut_ > 0 ? sent.first(sent.size() / 2) : sent;
  }
  void note_taken(std::span<const std::uint8_t> sent) noexcept;

  // What it did wrong so far, so that who asked for it can tell that it happened.
  struct Struck {
    std::uint64_t refused{0};
    std::uint64_t unanswered{0};  // rounds of its wire
    std::uint64_t corrupted{0};   // reports, as the two below
    std::uint64_t shortened{0};
    std::uint64_t babbled{0};
    std::uint64_t cut{0};         // of those that it was sent
    std::uint64_t halted{0};      // transfers, that halted their endpoint
    std::uint64_t halted_out{0};  // those of them that go out
    bool operator==(const Struck&) const = default;
  };
  [[nodiscard]] const Struck& struck() const noexcept { return struck_; }

 private:
  MonotonicTime stalls_until_{};
  MonotonicTime silent_until_{};
  std::uint32_t corrupt_{0};
  std::uint32_t short_{0};
  std::uint32_t babble_{0};
  std::uint32_t cut_{0};
  std::uint32_t halt_{0};
  Struck struck_{};
  std::mt19937_64 random_;
};

}  // namespace thimble::sim
