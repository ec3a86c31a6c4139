#include "tests/vm/replay/stepped_bus.hpp"

#include <utility>

namespace thimble::replay {
namespace {

// An answer takes a frame of 1 ms, or two; a look in a guest takes the emulator longer than 50 us.
constexpr Duration kLook = std::chrono::microseconds(400);

}  // namespace

template <typename Condition>
bool SteppedBus::wait_until(Condition is_there) const {
  const MonotonicTime deadline = machine_->now() + kPatience;
  while (!is_there()) {
    if (machine_->now() > deadline) return false;
    static_cast<void>(machine_->sleep_until(machine_->now() + kLook));
  }
  return true;
}

class SteppedBus::Hid final : public bus::HidDevice {
 public:
  Hid(const SteppedBus& bus, std::unique_ptr<bus::HidDevice> device)
      : bus_(bus), device_(std::move(device)) {}

  IoStatus read_newest(bus::HidReport& out) noexcept override {
    if (bus_.pace_ == Pace::Waits && !wait_for_answer()) return IoStatus::Disconnected;
    const IoStatus status = device_->read_newest(out);
    if (status != IoStatus::Ok) return status;
    out.arrived_at = bus_.clock_->now();
    out.sequence = ++reports_;
    bus_.transcript_->from_device.push_back(Transcript::copy(out.payload()));
    return status;
  }
  IoStatus submit(std::span<const std::uint8_t> report) noexcept override {
    const IoStatus status = device_->submit(report);
    bus_.transcript_->to_device.push_back(Transcript::copy(report));
    ++sent_;
    return status;
  }
  [[nodiscard]] bus::HidCounters counters() const noexcept override { return device_->counters(); }

 private:
  // The way out has to be free again, too: whether it is decides what the next submit() says.
  bool wait_for_answer() {
    return bus_.wait_until([this] {
      const bus::HidCounters now = device_->counters();
      return now.reports_out + now.writes_failed >= sent_ && now.reports_in >= sent_;
    });
  }

  const SteppedBus& bus_;
  std::unique_ptr<bus::HidDevice> device_;
  std::uint64_t sent_{0};
  std::uint64_t reports_{0};
};

class SteppedBus::Usb final : public bus::UsbDevice {
 public:
  Usb(const SteppedBus& bus, std::unique_ptr<bus::UsbDevice> device, std::uint8_t in)
      : bus_(bus), device_(std::move(device)), in_(in) {}

  IoStatus read(std::uint8_t endpoint, bus::UsbPacket& out) noexcept override {
    if (!wait_for_answer()) return IoStatus::Disconnected;
    if (!waiting_) {
      const IoStatus status = fetch();
      if (status != IoStatus::Ok || endpoint != in_) return status;
    }
    out = *std::exchange(waiting_, std::nullopt);
    out.arrived_at = bus_.clock_->now();
    out.sequence = ++packets_;
    bus_.transcript_->from_device.push_back(Transcript::copy(out.payload()));
    return IoStatus::Ok;
  }
  IoStatus submit(std::uint8_t endpoint, std::span<const std::uint8_t> packet) noexcept override {
    const IoStatus status = device_->submit(endpoint, packet);
    bus_.transcript_->to_device.push_back(Transcript::copy(packet));
    ++sent_;
    return status;
  }
  IoStatus start_control(const bus::UsbControlRequest& request) noexcept override {
    const IoStatus status = device_->start_control(request);
    if (status == IoStatus::Ok) ++sent_;
    return status;
  }
  // The bus tells of the end of a request before it tells of the packet that answers it.
  IoStatus read_control(bus::UsbControlReply& out) noexcept override {
    return wait_for_answer() ? device_->read_control(out) : IoStatus::Disconnected;
  }
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t endpoint) const noexcept override {
    return device_->counters(endpoint);
  }

 private:
  bool wait_for_answer() {
    if (bus_.pace_ == Pace::Virtual) return true;
    return bus_.wait_until([this] { return fetched_ >= sent_ || fetch() != IoStatus::NoData; });
  }
  IoStatus fetch() noexcept {
    bus::UsbPacket packet;
    const IoStatus status = device_->read(in_, packet);
    if (status != IoStatus::Ok) return status;
    ++fetched_;
    waiting_ = packet;
    return status;
  }

  const SteppedBus& bus_;
  std::unique_ptr<bus::UsbDevice> device_;
  std::uint8_t in_;
  std::optional<bus::UsbPacket> waiting_;
  std::uint64_t sent_{0};
  std::uint64_t fetched_{0};
  std::uint64_t packets_{0};
};

Result<std::unique_ptr<bus::HidDevice>> SteppedBus::open_hid(const bus::DeviceAddress& address) {
  Result<std::unique_ptr<bus::HidDevice>> device = buses_->open_hid(address);
  if (!device) return device;
  return std::make_unique<Hid>(*this, *std::move(device));
}

Result<std::unique_ptr<bus::UsbDevice>> SteppedBus::open_usb(const bus::DeviceAddress& address,
                                                             const bus::UsbClaim& claim) {
  Result<std::unique_ptr<bus::UsbDevice>> device = buses_->open_usb(address, claim);
  if (!device) return device;
  for (const bus::UsbPipe& pipe : claim.pipes) {
    if (!bus::is_usb_in(pipe.endpoint)) continue;
    return std::make_unique<Usb>(*this, *std::move(device), pipe.endpoint);
  }
  return fail(Errc::InvalidArgument, address.text + ": nothing would answer");
}

}  // namespace thimble::replay
