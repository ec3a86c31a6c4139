#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "drivers/cambus/board_port.hpp"
#include "drivers/cambus/board_watch.hpp"
#include "drivers/cambus/usb_link.hpp"
#include "hal/bus/bus_enumerator.hpp"

namespace thimble::cambus {

// What to claim of a board, and how long its packets are.
struct UsbBoardMatch {
  bus::UsbClaim claim;
  std::size_t packet_bytes{0};
};
// By descriptors alone. Pure. Errors: NotMine.
[[nodiscard]] Result<UsbBoardMatch> match_usb_board(const bus::BusDeviceInfo& info);

// A board over USB: its page and its window (docs/cambus.md, sections 6 and 7). What is put and
// got is on its way for a while; what is got belongs to the board that was opened.
class UsbPort final : public BoardPort {
 public:
  [[nodiscard]] const BoardFacts& facts() const noexcept override { return facts_; }

  // NoData where it is on its way. What comes is of a moment after the call before that got one.
  IoStatus poll(MonotonicTime now, BoardStatus& out) override;
  IoStatus confirm(MonotonicTime now) override;
  IoStatus ring(const std::array<std::uint32_t, page::kHostRegisters>& registers,
                std::uint32_t meant) override;
  [[nodiscard]] bool is_taken(const BoardStatus& status) const noexcept override {
    return status.acknowledged == rung_;
  }
  // A board that says how much it holds does not say how much we keep: what was put is one list of
  // ours, behind what could not be dropped of the one before. Backlogged while there is more.
  static constexpr std::size_t kMostLeftBytes = UsbLink::kMostUnderWay * UsbLink::kMostWriteBytes;
  IoStatus put(std::uint32_t offset, std::span<const std::uint8_t> bytes) override;
  // What was asked for is forgotten with the next put() or ring().
  IoStatus get(std::uint32_t offset, std::span<std::uint8_t> bytes) override;
  void drop_unsent() override;

  [[nodiscard]] std::uint32_t bytes_per_s() const noexcept override { return bytes_per_s_; }
  [[nodiscard]] Gone why_gone() const noexcept override { return watch_.why_gone(); }
  [[nodiscard]] const PortCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] const UsbLinkCounters& link() const noexcept { return link_.counters(); }
  // Put, and not answered.
  [[nodiscard]] std::size_t unwritten_bytes() const noexcept { return link_.unwritten_bytes(); }

 private:
  friend class UsbOpening;
  using Fetch = std::shared_ptr<const UsbFetch>;

  // The words that change, and behind them, whose they are.
  struct Look {
    Fetch status;
    Fetch identity;
    MonotonicTime asked_at{};
  };
  // Likewise, of the window.
  struct Got {
    std::uint32_t offset{0};
    Fetch bytes;
    Fetch identity;
  };

  UsbPort(UsbLink link, const BoardFacts& facts, std::uint32_t rung, MonotonicTime now)
      : link_(std::move(link)),
        bytes_per_s_(link_.bytes_per_s()),
        facts_(facts),
        rung_(rung),
        now_(now),
        watch_(facts, now) {}

  IoStatus pump(MonotonicTime now);
  [[nodiscard]] Fetch ask_for_identity();
  void look(MonotonicTime now);
  [[nodiscard]] bool is_in_window(std::uint32_t offset, std::size_t bytes) const noexcept;

  UsbLink link_;
  std::uint32_t bytes_per_s_;
  BoardFacts facts_;
  std::uint32_t rung_;
  std::optional<std::uint32_t> acknowledged_;  // as it was seen last
  std::optional<Look> look_;
  std::vector<Got> gots_;
  MonotonicTime now_;  // of the last poll
  BoardWatch watch_;
  PortCounters counters_;
};

// Finds out what board it is, which takes as long as the bus does.
// Thread: one. Ownership: owns the device until it is a port's.
class UsbOpening {
 public:
  UsbOpening(std::unique_ptr<bus::UsbDevice> device, const UsbBoardMatch& match);

  // Errors: Busy, it has not said all yet: ask again; Disconnected; those of parse_board_facts().
  // After any but Busy, and after success, it is over.
  [[nodiscard]] Result<std::unique_ptr<UsbPort>> poll(MonotonicTime now);

 private:
  UsbLink link_;
  std::shared_ptr<const UsbFetch> identity_;
  std::shared_ptr<const UsbFetch> doorbell_;
};

}  // namespace thimble::cambus
