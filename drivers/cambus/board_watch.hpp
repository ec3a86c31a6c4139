#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "drivers/cambus/board_facts.hpp"
#include "drivers/cambus/board_port.hpp"
#include "hal/base/io_status.hpp"
#include "hal/base/time.hpp"

namespace thimble::cambus {

// The first words of a page, which say whose it is and that it lives.
using IdentityWords = std::array<std::uint32_t, page::kIdentityBytes / sizeof(std::uint32_t)>;

// Whether the board that was opened is still there, by the words that it says of itself; why it was
// given up stays (docs/cambus.md, section 6).
//
// Thread: one at a time. Ownership: values. Errors: Disconnected where it is given up, now or
// before.
class BoardWatch {
 public:
  // The board with these facts, seen at `now`.
  BoardWatch(const BoardFacts& facts, MonotonicTime now) noexcept
      : incarnation_(facts.incarnation), beat_at_(now) {}

  // Is it the one that was opened?
  IoStatus check_identity(const IdentityWords& words) noexcept;
  // Does it live? The words came at `now` and tell of a moment not before `asked_at`.
  IoStatus check_beat(const IdentityWords& words, MonotonicTime asked_at,
                      MonotonicTime now) noexcept;
  IoStatus give_up(Gone why) noexcept;

  [[nodiscard]] bool is_gone() const noexcept { return gone_ != Gone::No; }
  [[nodiscard]] Gone why_gone() const noexcept { return gone_; }

 private:
  [[nodiscard]] IoStatus status() const noexcept {
    return is_gone() ? IoStatus::Disconnected : IoStatus::Ok;
  }

  std::uint32_t incarnation_;
  std::optional<std::uint32_t> beat_;
  MonotonicTime beat_at_;  // when this beat was first seen
  Gone gone_{Gone::No};
};

}  // namespace thimble::cambus
