#include "daemon/link/line_arm_end.hpp"

#include <utility>

#include "daemon/link/earliest.hpp"

namespace thimble::link {
namespace {

std::span<const std::byte> bytes_of(const ThesisRequest& request) { return request; }
std::span<const std::byte> bytes_of(const ThimbleDatagram& datagram) { return datagram.view(); }

template <class End, class Datagram>
class LineArmEndOf final : public LineArmEnd {
 public:
  LineArmEndOf(End end, std::uint32_t bit_per_s) : end_(std::move(end)), pace_(bit_per_s) {}

  void offer(const coupling::HandSample& sample) noexcept override { end_.offer(sample); }

  void on_bytes(std::span<const std::byte> bytes, MonotonicTime now) override {
    deframer_.on_read(now);
    for (const std::byte byte : bytes) {
      if (const auto datagram = deframer_.push(byte)) end_.on_datagram(*datagram, now);
    }
    end_.counters().receive_errors = deframer_.counters().damaged;
  }

  bool poll(MonotonicTime now, SerialFrame& out) override {
    polled_at_ = now;
    is_waiting_ = now < pace_.free_at();
    if (is_waiting_) return false;
    bool is_due = false;
    // Of several that are due at once the newest says most.
    for (Datagram datagram; end_.poll(now, datagram); is_due = true) {
      out = frame(bytes_of(datagram));
    }
    if (is_due) pace_.on_sent(out.size, now);
    return is_due;
  }

  bool take_reply(MonotonicTime now, coupling::ConstraintSet& out) override {
    return end_.take_reply(now, out);
  }

  [[nodiscard]] std::optional<MonotonicTime> next_due() const override {
    std::optional<MonotonicTime> due = end_.next_due();
    if (!is_waiting_) return due;
    // What is due to leave waits for the line.
    if (due && *due <= polled_at_) due.reset();
    take_earlier(due, pace_.free_at());
    return due;
  }

  [[nodiscard]] coupling::LinkQuality quality() const noexcept override { return end_.quality(); }
  [[nodiscard]] LinkStatus status() const override { return end_.status(); }

 private:
  End end_;
  Deframer deframer_;
  LinePace pace_;
  MonotonicTime polled_at_{};
  bool is_waiting_{false};  // for the line, when it was polled
};

}  // namespace

std::unique_ptr<LineArmEnd> make_line_arm_end(const ArmEndSettings& settings,
                                              std::uint32_t bit_per_s) {
  if (settings.protocol == ArmEndSettings::Protocol::Thimble) {
    return std::make_unique<LineArmEndOf<ThimbleArmEnd, ThimbleDatagram>>(
        make_thimble_end(settings), bit_per_s);
  }
  return std::make_unique<LineArmEndOf<ThesisArmEnd, ThesisRequest>>(make_thesis_end(settings),
                                                                     bit_per_s);
}

}  // namespace thimble::link
