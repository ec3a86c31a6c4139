#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "daemon/config/load.hpp"
#include "daemon/session/plugins.hpp"
#include "daemon/session/runtime.hpp"
#include "sim/fault/faulty_enumerator.hpp"
#include "sim/model/hand/person.hpp"
#include "tests/support/postponed_executor.hpp"

namespace thimble::test {

inline constexpr const char* kTwoArms = R"(
[[arm]]
name = "left"
device = "hid:left"
model = "phantom-vintage"
amplifier_max_a = 3.0
world = "box"
[[arm]]
name = "right"
device = "hid:right"
model = "phantom-vintage"
amplifier_max_a = 3.0
world = "box"
[[world]]
name = "box"
source = "box:3"
)";
inline constexpr const char* kAddresses[] = {"hid:left", "hid:right"};
inline constexpr std::size_t kLeft = 0;
inline constexpr std::size_t kRight = 1;
// A bus that refuses some of its devices, and shows some under other ids.
class RefusingBus final : public bus::BusEnumerator {
 public:
  explicit RefusingBus(sim::SimEnumerator& below) : below_(below) {}
  [[nodiscard]] std::vector<bus::BusDeviceInfo> list() override {
    std::vector<bus::BusDeviceInfo> devices = below_.list();
    for (bus::BusDeviceInfo& device : devices) {
      if (vendors.count(device.address.text) > 0) device.vendor_id = vendors[device.address.text];
    }
    return devices;
  }
  [[nodiscard]] std::optional<bus::BusEvent> poll_event() override { return below_.poll_event(); }
  [[nodiscard]] Result<std::unique_ptr<bus::HidDevice>> open_hid(
      const bus::DeviceAddress& address) override {
    ++tries[address.text];
    if (throwing.count(address.text) > 0) throw std::runtime_error(address.text + " broke");
    if (refusals.count(address.text) == 0) return below_.open_hid(address);
    return fail(refusals[address.text], address.text + " is refused today");
  }
  [[nodiscard]] Result<std::unique_ptr<bus::UsbDevice>> open_usb(
      const bus::DeviceAddress& address, const bus::UsbClaim& claim) override {
    return below_.open_usb(address, claim);
  }

  std::map<std::string, Errc> refusals;
  std::set<std::string> throwing;                // instead of being opened
  std::map<std::string, std::uint16_t> vendors;  // instead of the models' own
  std::map<std::string, int> tries;

 private:
  sim::SimEnumerator& below_;
};

// Guards of which is known whom they watch, and which may refuse.
class KnownGuards final : public devices::ArmGuards {
 public:
  class Guard final : public devices::ArmGuard {
   public:
    explicit Guard(KnownGuards& all) : all_(all) {}
    [[nodiscard]] rt::Heartbeat& heartbeat() noexcept override { return heartbeat_; }
    Result<void> ask(const bus::DeviceAddress& address, const ZeroCommand&) override {
      if (all_.is_refusing) return fail(Errc::Timeout, "it does not answer");
      all_.watched.push_back(address.text);
      return {};
    }
    [[nodiscard]] Result<bool> is_watching() override {
      if (all_.have_ended) return fail(Errc::System, "it ended");
      return true;
    }

   private:
    KnownGuards& all_;
    rt::Heartbeat heartbeat_;
  };
  [[nodiscard]] Result<std::unique_ptr<devices::ArmGuard>> make() override {
    return std::make_unique<Guard>(*this);
  }
  bool is_refusing{false};
  bool have_ended{false};
  std::vector<std::string> watched;
};

// Two real arms, as far as a session can tell, each in the hand of a person once it is plugged in;
// runs as the daemon does, in virtual time.
class TwoRealArms {
 public:
  Result<std::unique_ptr<session::Runtime>> make(const std::vector<std::string>& overrides) {
    const config::ConfigResult config = config::parse(kTwoArms, "two-arms.toml", overrides);
    if (!config) throw std::runtime_error(to_string(config.error().front()));
    session::RigParts parts{plugins_.models, plugins_.drivers};
    parts.real_buses = &cables_;
    parts.guards = &guards_;
    parts.real_clock = &clock_;
    parts.executor_for_board = [this](const std::string&) -> devices::DeviceExecutor& {
      return board_work_;
    };
    if (is_work_postponed_) {
      parts.executor_for = [this](const std::string& arm) -> devices::DeviceExecutor& {
        return work_[arm == "right" ? kRight : kLeft];
      };
    }
    return session::Runtime::create(*config, parts);
  }
  void start(const std::vector<std::string>& overrides = {}) {
    for (PostponedExecutor& work : work_) work.postpone(is_start_postponed_);
    auto runtime = make(overrides);
    for (PostponedExecutor& work : work_) work.postpone(true);
    if (!runtime) throw std::runtime_error(runtime.error().message);
    sut_ = *std::move(runtime);
  }
  // With somebody who holds it, reads what the status says, and then feels about.
  void plug(std::size_t arm) {
    const bus::DeviceAddress address{kAddresses[arm]};
    if (people_[arm] != nullptr) {
      static_cast<void>(plugs_.replug(address));
      return;
    }
    auto model = plugins_.models.find("phantom-vintage")->create_hid({.amplifier_max_a = 3});
    ASSERT_TRUE(model);
    ASSERT_TRUE(plugs_.plug(address, *std::move(model)));
    sim::HandSettings hand;
    hand.motion = motion_;
    hand.seed = arm + 1;
    people_[arm] = std::make_unique<sim::Person>(*plugs_.arm_backend(address), hand);
  }
  void unplug(std::size_t arm) { static_cast<void>(plugs_.unplug({kAddresses[arm]})); }
  void clear(std::size_t arm) {
    session::ArmSession& session = rig(arm).session();
    session.controls().request_clear(session.snapshot().fault.number);
  }
  // As the daemon: the servos, and then what came of the buses.
  void tick() {
    static_cast<void>(clock_.sleep_until(clock_.now() + std::chrono::milliseconds(1)));
    for (const auto& arm : sut_->arms()) arm->session().loop().tick({});
    static_cast<void>(sut_->pump(clock_.now()));
    for (const Error& trouble : sut_->follow_buses(clock_.now())) troubles_.push_back(trouble);
    for (auto& arrival : sut_->take_arrivals()) sut_->take_over(std::move(arrival));
    for (std::size_t i = 0; i < 2; ++i) {
      if (people_[i] == nullptr) continue;
      if (frame(i).calibration == CalibrationState::NeedsUser) people_[i]->ask_to_calibrate();
      // What the motors held before a tick ends with the tick and the amplifier's own delay.
      const bool is_active = state(i) == OperatingState::Active;
      const double push_newton = norm(plugs_.arm_backend({kAddresses[i]})->truth().motor_force);
      rested_s_[i] = is_active ? 0 : rested_s_[i] + 0.001;
      if (rested_s_[i] > 0.005 && push_newton > 0) ++forces_unasked_;
    }
  }
  void run(double s) {
    for (const MonotonicTime end = clock_.now() + from_seconds(s); clock_.now() < end;) tick();
  }
  session::ArmRig& rig(std::size_t i) { return *sut_->arms()[i]; }
  const servo::ServoFrame& frame(std::size_t i) { return rig(i).session().snapshot().frame; }
  OperatingState state(std::size_t i) { return frame(i).state; }

  session::Plugins plugins_;
  sim::VirtualClock clock_;
  sim::SimEnumerator plugs_{clock_};
  RefusingBus bus_{plugs_};
  sim::FaultyEnumerator cables_{bus_, clock_};
  KnownGuards guards_;
  // What the kernel is asked for lasts until the test says so; else it is done at once.
  bool is_work_postponed_{false};
  bool is_start_postponed_{false};  // and that of the start, too
  test::PostponedExecutor work_[2];
  test::PostponedExecutor board_work_{false};  // of worlds on a board
  sim::HandMotion motion_{sim::HandMotion::Explore};
  std::unique_ptr<sim::Person> people_[2];
  std::unique_ptr<session::Runtime> sut_;
  std::vector<Error> troubles_;
  double rested_s_[2]{};
  int forces_unasked_{0};
};

}  // namespace thimble::test
