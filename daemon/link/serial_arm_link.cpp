#include "daemon/link/serial_arm_link.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "daemon/link/arm_mailbox.hpp"
#include "daemon/link/line_arm_end.hpp"

namespace thimble::link {

class SerialArmLink::Impl {
 public:
  Impl(LinePorts& ports, const Clock& clock, const Settings& settings, rt::WakeSignal* wake)
      : clock_(&clock),
        line_(settings.line),
        mailbox_(wake),
        end_(make_line_arm_end(settings.end, settings.line.bit_per_s)),
        port_(ports.make_port(line_.node, line_.bit_per_s)) {
    port_->start({.on_bytes =
                      [this](std::span<const std::byte> bytes) {
                        end_->on_bytes(bytes, clock_->now());
                        step();
                      },
                  .on_timer = [this] { step(); }});
  }

  void step() {
    const MonotonicTime now = clock_->now();
    coupling::HandSample sample;
    if (mailbox_.take(sample)) end_->offer(sample);
    for (coupling::ConstraintSet reply; end_->take_reply(now, reply);) mailbox_.deliver(reply);
    const bool has_room = port_->has_room();
    if (SerialFrame frame; has_room && end_->poll(now, frame)) port_->send(frame);
    mailbox_.publish(end_->quality());
    const std::optional<MonotonicTime> due = end_->next_due();
    const Duration least = has_room ? Duration::zero() : kLineAbsentWait;
    if (due) port_->wake_after(now, std::max(*due - now, least));
  }

  [[nodiscard]] coupling::ArmLink& arm_end() { return mailbox_; }
  [[nodiscard]] LinkStatus status() const {
    LinkStatus status = end_->status();
    tell_of_line(line_, port_->last_error(), status);
    return status;
  }

 private:
  const Clock* clock_;
  SerialLine line_;
  ArmMailbox mailbox_;
  std::unique_ptr<LineArmEnd> end_;
  std::unique_ptr<LinePort> port_;  // last: its handlers use the rest
};

SerialArmLink::SerialArmLink(LinePorts& ports, const Clock& clock, const Settings& settings,
                             rt::WakeSignal* wake)
    : impl_(std::make_unique<Impl>(ports, clock, settings, wake)) {}
SerialArmLink::~SerialArmLink() = default;

coupling::ArmLink& SerialArmLink::arm_end() noexcept { return impl_->arm_end(); }
void SerialArmLink::on_wake() { impl_->step(); }
LinkStatus SerialArmLink::status() const { return impl_->status(); }

}  // namespace thimble::link
