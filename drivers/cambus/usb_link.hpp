#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/cambus/usb_frame.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/usb_device.hpp"

namespace thimble::cambus {

struct UsbLinkCounters {
  std::uint64_t answered{0};  // requests, each once
  std::uint64_t sent{0};      // requests, each time
  std::uint64_t restarts{0};  // after a doubt: what follows says of which kind; the first is none
  std::uint64_t spoilt{0};    // replies that are none, or not the one to come
  std::uint64_t lost{0};      // packets that the bus says it lost
  std::uint64_t late{0};      // nothing came for kPatience
  bool operator==(const UsbLinkCounters&) const = default;
};

// Bytes that are asked for; all there when nothing is missing.
struct UsbFetch {
  std::vector<std::uint8_t> bytes;
  std::size_t missing{0};
  [[nodiscard]] bool is_here() const noexcept { return missing == 0; }
};

// Reads and writes of a board's page and window over two bulk pipes, carried out in their order:
// several under way at once, and after any doubt asked again from the first unanswered one on
// (docs/cambus.md, section 7).
//
// Time: that of who calls. What nobody looked at does not count as silence: a visit is for at most
// kVisit.
// Thread: one. Not RT. No call waits. Ownership: owns the device.
// Errors: Disconnected (the device is gone), and is_silent().
class UsbLink {
 public:
  // All ours. A reply takes less than a millisecond; a doubt costs kPatience at most.
  static constexpr Duration kPatience = std::chrono::milliseconds(50);
  static constexpr Duration kGivenUp = std::chrono::milliseconds(300);
  static constexpr Duration kVisit = std::chrono::milliseconds(20);
  static constexpr std::size_t kMostUnderWay = usb::kMostReplies;
  // Ours: what is asked for again after a loss is not the whole list.
  static constexpr std::size_t kMostWriteBytes = 4096;

  UsbLink(std::unique_ptr<bus::UsbDevice> device, std::size_t packet_bytes);

  // Offsets and lengths are multiples of 4; nothing is sent before pump().
  [[nodiscard]] std::shared_ptr<const UsbFetch> read(std::uint32_t offset, std::size_t bytes);
  void write(std::uint32_t offset, std::span<const std::uint8_t> bytes);
  // At most one request's bytes, that leave when all before has been answered: what would do harm
  // if something before it were repeated behind it.
  void write_last(std::uint32_t offset, std::span<const std::uint8_t> bytes);

  // Forgets what has never been sent; what the board may have had stays in its order, and is sent
  // to its end. What was asked for and is forgotten never comes. Whether a write_last() was.
  [[nodiscard]] bool drop_unsent();

  // Hears and says what there is. Ok or Disconnected.
  IoStatus pump(MonotonicTime now);
  // It answered nothing for kGivenUp. Latches.
  [[nodiscard]] bool is_silent() const noexcept { return is_silent_; }
  // Of writes that have not been answered.
  [[nodiscard]] std::size_t unwritten_bytes() const noexcept { return unwritten_bytes_; }
  [[nodiscard]] const UsbLinkCounters& counters() const noexcept { return counters_; }
  // About what the bus carries one way: packets one by one, 16 in a millisecond at full speed (of
  // 19 that USB 2.0, 5.8.4 has room for), at high speed one in each of its eight microframes.
  [[nodiscard]] std::uint32_t bytes_per_s() const noexcept {
    const bool is_high_speed = packet_bytes_ > usb::kFullSpeedPacketBytes;
    return static_cast<std::uint32_t>(packet_bytes_) * (is_high_speed ? 8'000U : 16'000U);
  }

 private:
  struct Request {
    UsbHead head;
    std::vector<std::uint8_t> payload;  // of a write
    bool is_last{false};
    bool is_sent{false};              // once, at least; of none behind one that was not
    std::shared_ptr<UsbFetch> fetch;  // of a read
    std::size_t place{0};             // in it
  };

  void append_write(std::uint32_t offset, std::span<const std::uint8_t> bytes, bool is_last);
  [[nodiscard]] std::size_t reply_packets(const UsbHead& head) const noexcept;

  [[nodiscard]] IoStatus hear();
  void take_packet(const bus::UsbPacket& packet);
  void take_transfer();
  void take_reply(const UsbReply& reply);
  [[nodiscard]] bool is_answer_to(const Request& request, const UsbHead& head) const noexcept;
  void look_for_losses();
  void wait(MonotonicTime now);
  void restart() noexcept;
  [[nodiscard]] IoStatus speak();
  // Whether there is something to be sent.
  [[nodiscard]] bool prepare();

  std::unique_ptr<bus::UsbDevice> device_;
  std::size_t packet_bytes_;

  std::deque<Request> requests_;    // not answered, in their order
  std::size_t under_way_{0};        // of these, sent
  std::size_t packets_to_come_{0};  // of their replies
  std::size_t unwritten_bytes_{0};
  std::uint16_t number_{0};  // the last one that was used

  enum class Stream : std::uint8_t { Lost, Beginning, Running };
  Stream stream_{Stream::Lost};
  std::uint16_t begun_with_{0};

  std::vector<std::uint8_t> leaving_;  // a transfer
  std::size_t left_{0};                // of it, with the bus
  std::vector<std::uint8_t> arriving_;
  std::uint64_t heard_{0};   // sequence of the last packet
  std::uint64_t losses_{0};  // as the bus has counted them

  std::optional<MonotonicTime> looked_at_;  // while there is something to wait for
  Duration quiet_{0};                       // since anything of use came, or was sent anew
  Duration silent_{0};                      // since a request was answered
  bool is_silent_{false};
  UsbLinkCounters counters_;
};

}  // namespace thimble::cambus
