#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "hal/plugin/plugin_check.hpp"
#include "hal/plugin/plugin_driver.hpp"
#include "hal/plugin/plugin_model.hpp"
#include "tests/support/closed_loop.hpp"

// A plugin that answers everything at random. Nothing that it can say may end the host, move it to
// a force that its limiter would not allow, or put a number into a sample that no arm can have.
namespace thimble {
namespace {

// What the tables draw from; those of a device by its seed, which comes with the settings.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : source_(seed) {}

  std::uint64_t word() { return source_(); }
  bool one_in(std::uint64_t n) { return source_() % n == 0; }
  double number() {
    constexpr std::array kWorst{std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity(),
                                -std::numeric_limits<double>::infinity(),
                                1e308,
                                -1e308,
                                5e-324,
                                -0.0};
    if (one_in(300)) return kWorst[source_() % kWorst.size()];
    return std::uniform_real_distribution<double>(-0.1, 0.1)(source_);
  }
  std::int32_t status() {
    if (one_in(20)) return static_cast<std::int32_t>(source_());
    return one_in(10) ? static_cast<std::int32_t>(source_() % 5) : std::int32_t{THIMBLE_OK};
  }
  template <class Struct>
  void scribble(Struct& out) {
    auto* bytes = reinterpret_cast<unsigned char*>(&out);
    for (auto left = source_() % 20; left > 0; --left) {
      bytes[source_() % sizeof(out)] = static_cast<unsigned char>(source_());
    }
  }

 private:
  std::mt19937_64 source_;
};

// A force that reached encode(), and the currents that the newest sample gave for one.
struct Asked {
  Force3 force{};
  thimble_sample sample{};
};
struct Witness {
  std::vector<Asked> asked;
  int forgotten = 0;
};

// The settings' model is its seed, or SEED@ADDRESS of a witness.
struct Device {
  explicit Device(const char* model) : chance(std::strtoull(model, nullptr, 10)) {
    const char* at = std::strchr(model, '@');
    if (at != nullptr) witness = reinterpret_cast<Witness*>(std::strtoull(at + 1, nullptr, 10));
  }
  Chance chance;
  Witness* witness = nullptr;
  thimble_sample newest{};  // that the host takes
  std::uint64_t unsure_samples = 0;
};
Device& device_of(void* device) { return *static_cast<Device*>(device); }
Chance& chance_of(void* device) { return device_of(device).chance; }

std::int32_t match(const thimble_hid_info*, const thimble_driver_settings* settings,
                   thimble_reason* reason) {
  Chance chance(std::strtoull(settings->model, nullptr, 10));
  chance.scribble(*reason);
  return THIMBLE_OK;
}

std::int32_t open(const thimble_hid_info*, const thimble_driver_settings* settings,
                  thimble_capabilities* said, void** device, thimble_reason* reason) {
  auto made = std::make_unique<Device>(settings->model);
  Chance* chance = &made->chance;
  said->joint_count = chance->one_in(2) ? 3 : 6;
  std::strcpy(said->model, "hostile");
  said->peak_force_newton = 8;
  said->continuous_force_newton = 2;
  said->max_stiffness_newton_per_m = 1000;
  said->workspace_radius_m = 0.1;
  std::fill_n(said->peak_current_a, THIMBLE_MOTORS, 3.0);
  std::fill_n(said->continuous_current_a, THIMBLE_MOTORS, 1.0);
  said->sample_period_ns = 1'000'000;
  if (chance->one_in(3)) chance->scribble(*said);
  chance->scribble(*reason);
  if (chance->one_in(20)) return THIMBLE_REFUSED;
  *device = made.release();
  return THIMBLE_OK;
}

// What it answers: nothing, or that it must be calibrated, for a while.
void forget_calibration(void* device) {
  Device& self = device_of(device);
  if (self.witness != nullptr) ++self.witness->forgotten;
  self.unsure_samples = self.chance.word() % 2 * (self.chance.word() % 20);
}

// An arm that somebody moves from wall to wall, so that it is driven and pushed: of the numbers,
// only a few are wild.
std::int32_t decode_moved(Device& self, const thimble_hid_report& report, thimble_sample& sample) {
  Chance& chance = self.chance;
  constexpr double kTurn_rad_per_s = 3;
  sample.tip_m[0] = 0.09 * std::sin(kTurn_rad_per_s * 1e-9 * double(report.arrived_at_ns));
  sample.calibration = self.unsure_samples > 0 ? THIMBLE_CALIBRATION_NEEDS_PERSON : 2;
  if (self.unsure_samples > 0) --self.unsure_samples;
  for (auto& motor : sample.motor_current_a_per_newton) {
    for (double& current : motor) current = chance.number() * 20;
  }
  if (chance.one_in(100)) chance.scribble(sample);
  const std::int32_t status = chance.one_in(50) ? chance.status() : std::int32_t{THIMBLE_OK};
  if (status == THIMBLE_OK && plugin::is_sound(sample)) self.newest = sample;
  return status;
}

std::int32_t decode(void* device, const thimble_hid_report* report, thimble_sample* sample) {
  Chance& chance = chance_of(device);
  EXPECT_LE(report->size, sizeof(report->bytes));
  if (device_of(device).witness != nullptr) {
    return decode_moved(device_of(device), *report, *sample);
  }
  sample->calibration = chance.one_in(50) ? static_cast<std::int32_t>(chance.word() % 5) : 2;
  for (double& angle : sample->joint_position_rad) angle = chance.number();
  for (double& place : sample->tip_m) place = chance.number() / 20;
  for (auto& motor : sample->motor_current_a_per_newton) {
    for (double& current : motor) current = chance.number();
  }
  if (chance.one_in(30)) chance.scribble(*sample);
  return chance.status();
}

std::int32_t encode(void* device, const thimble_wrench* wrench, std::uint8_t* bytes) {
  Chance& chance = chance_of(device);
  const auto* force = wrench->force_newton;
  EXPECT_TRUE(is_finite(force[0], force[1], force[2]));
  EXPECT_LE(norm(force[0], force[1], force[2]), 100);
  if (Witness* witness = device_of(device).witness; witness != nullptr) {
    witness->asked.push_back({{force[0], force[1], force[2]}, device_of(device).newest});
  }
  for (int i = 0; i < THIMBLE_REPORT_BYTES; ++i) {
    bytes[i] = static_cast<std::uint8_t>(chance.word());
  }
  return device_of(device).witness == nullptr || chance.one_in(50) ? chance.status()
                                                                   : std::int32_t{THIMBLE_OK};
}

const thimble_driver kDriver = {
    sizeof(thimble_driver),
    0,
    "hostile",
    &match,
    &open,
    [](void* device) { delete &device_of(device); },
    &forget_calibration,
    &decode,
    &encode,
};

// The other half, which also asks the hand out of turn.
struct Model {
  Chance chance;
  const thimble_tip_load* load = nullptr;
};
Model& model_of(void* device) { return *static_cast<Model*>(device); }

std::int32_t create(const thimble_model_settings* settings, thimble_model_facts* facts,
                    void** device, thimble_reason* reason) {
  auto* model = new Model{Chance(settings->seed)};
  facts->frame_period_ns = 1'000'000;
  facts->info.input_report_bytes = 1 + model->chance.word() % 64;
  facts->info.output_report_bytes = 1 + model->chance.word() % 64;
  for (double& place : facts->home_m) place = model->chance.number();
  if (model->chance.one_in(3)) model->chance.scribble(*facts);
  model->chance.scribble(*reason);
  *device = model;
  return THIMBLE_OK;
}

void ask(Model& model, std::int64_t near_ns) {
  if (model.load == nullptr) return;
  Chance& chance = model.chance;
  const std::int64_t t_ns = chance.one_in(9)
                                ? static_cast<std::int64_t>(chance.word())
                                : near_ns - static_cast<std::int64_t>(chance.word() % 2'000'000);
  const std::int64_t dt_ns =
      chance.one_in(9) ? static_cast<std::int64_t>(chance.word()) : std::int64_t{50'000};
  const double tip_m[3] = {chance.number(), chance.number(), chance.number()};
  const double velocity_m_per_s[3] = {chance.number(), chance.number(), chance.number()};
  double newton[3] = {};
  model.load->force_on_tip(model.load->context, t_ns, dt_ns, tip_m, velocity_m_per_s, newton);
  EXPECT_TRUE(is_finite(newton[0], newton[1], newton[2]));
  static_cast<void>(model.load->is_button_pressed(model.load->context, t_ns));
}

thimble_model hostile_model() {
  thimble_model model{};
  model.struct_bytes = sizeof(model);
  std::strcpy(model.name, "hostile");
  model.create = &create;
  model.destroy = [](void* device) { delete &model_of(device); };
  model.advance = [](void* device, std::int64_t t_ns) {
    for (auto left = model_of(device).chance.word() % 8; left > 0; --left) {
      ask(model_of(device), t_ns);
    }
  };
  model.out_report = [](void* device, const std::uint8_t*, std::uint32_t size) {
    EXPECT_LE(size, 64U);
    ask(model_of(device), 0);
  };
  model.in_report = [](void* device, std::uint8_t* bytes) {
    Chance& chance = model_of(device).chance;
    for (int i = 0; i < THIMBLE_REPORT_BYTES; ++i)
      bytes[i] = static_cast<std::uint8_t>(chance.word());
    return static_cast<std::uint32_t>(chance.one_in(9) ? chance.word() : chance.word() % 65);
  };
  model.power_cycle = [](void*) {};
  model.hold_tip = [](void* device, const thimble_tip_load* load) { model_of(device).load = load; };
  model.push_tip = [](void*, const double*) {};
  model.move_tip_to = [](void* device, const double*) { return model_of(device).chance.status(); };
  model.press_calibration_button = [](void*, std::int32_t) {};
  model.press_stylus_button = [](void*, std::int32_t) {};
  model.turn_stylus = [](void*, const double*) {};
  model.read_truth = [](void* device, thimble_arm_truth* truth) {
    model_of(device).chance.scribble(*truth);
  };
  return model;
}

const thimble_model kModel = hostile_model();

void bring(session::Plugins& plugins) {
  plugins.drivers.add(plugin::make_plugin_driver(kDriver));
  plugins.models.add(plugin::plugin_model_entry(kModel));
}

// A device of that seed on a bus of that seed, or nothing: it may refuse to be.
struct Opened {
  explicit Opened(std::uint64_t seed) {
    bring(plugins);
    auto model = plugins.models.find("hostile")->create_hid({.amplifier_max_a = 0, .seed = seed});
    if (!model || !buses.plug({"sim:hostile"}, *std::move(model))) return;
    plugin::DriverSettings settings;
    settings.model = std::to_string(seed);
    const bus::BusDeviceInfo info = buses.list().at(0);
    auto opened = plugins.drivers.drivers().back()->open(buses, info, settings);
    if (opened) device = *std::move(opened);
  }
  session::Plugins plugins;
  sim::VirtualClock clock;
  sim::SimEnumerator buses{clock};
  std::unique_ptr<HapticDevice> device;
};

void expect_sound(const HapticState& state) {
  for (const double angle_rad : state.joint_position_rad) EXPECT_LE(std::abs(angle_rad), 1e6);
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(state.tip[axis]), 10);
  for (const auto& row : state.motor_current_per_force.row) {
    for (const double current : row) EXPECT_LE(std::abs(current), 1e4);
  }
}

TEST(HostilePlugin, NoNumberThatNoArmHasGetsIntoASample) {
  int opened = 0;
  int samples = 0;
  std::uint64_t malformed = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Opened sut(seed);
    if (!sut.device) continue;
    ++opened;
    HapticState state;
    std::uint64_t last = 0;
    for (int tick = 0; tick < 200; ++tick) {
      sut.clock.run_for(std::chrono::milliseconds(1));
      if (sut.device->read(state) == IoStatus::Ok) {
        ++samples;
        EXPECT_GT(state.sample_sequence, last);
        EXPECT_LE(state.sampled_at, sut.clock.now());
        last = state.sample_sequence;
      }
      expect_sound(state);
      static_cast<void>(sut.device->write(LimitedWrench::zero()));
      if (tick % 50 == 49) sut.device->forget_calibration();
    }
    malformed += sut.device->counters().malformed;
  }
  EXPECT_GT(opened, 100);
  EXPECT_GT(samples, 10000);
  EXPECT_GT(malformed, 1000U);
}

// One force for the arm after another, against the limits of the session.
void expect_within(const servo::LimiterSettings& limits, Duration dt, Force3 before,
                   const Asked& asked) {
  const double newton = norm(asked.force);
  const double most_rise_newton = limits.max_rise_newton_per_s * seconds(dt) * (1 + 1e-9);
  EXPECT_LE(newton, limits.max_force_newton * (1 + 1e-9));
  EXPECT_LE(newton - norm(before), most_rise_newton);
  if (dot(asked.force, before) <= 0) {
    EXPECT_LE(newton, most_rise_newton) << "a turn starts from zero";
  }
  for (std::size_t motor = 0; motor < THIMBLE_MOTORS; ++motor) {
    const auto& row = asked.sample.motor_current_a_per_newton[motor];
    const double current_a = dot(Force3{row[0], row[1], row[2]}, asked.force);
    EXPECT_LE(std::abs(current_a), limits.peak_current_a[motor] * (1 + 1e-9));
  }
}

TEST(HostilePlugin, TheWholeSessionKeepsItsLimits) {
  int sessions = 0;
  int driven = 0;
  int pushed = 0;
  int forgotten = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const std::string number = std::to_string(seed);
    if (!Opened(seed).device) continue;
    test::ClosedLoop::Setup setup;
    setup.bring = &bring;
    Witness witness;
    setup.text = "[[arm]]\nname = 'right'\ndevice = 'sim:hostile'\nworld = 'box'\nmodel = '" +
                 number + "@" + std::to_string(reinterpret_cast<std::uintptr_t>(&witness)) +
                 "'\nhand.seed = " + number + "\n[[world]]\nname = 'box'\nsource = 'box:3'\n";
    test::ClosedLoop sut({}, setup);
    ++sessions;
    const servo::LimiterSettings& limits = sut.settings().limiter;
    bool was_driven = false;
    bool was_pushed = false;
    Force3 before{};
    sut.run(2, [&] {
      const servo::ServoFrame& frame = sut.frame();
      EXPECT_TRUE(is_finite(frame.force) && is_finite(frame.tip) && is_finite(frame.offset));
      for (const Asked& asked : witness.asked) {
        expect_within(limits, sut.settings().period(), before, asked);
        before = asked.force;
        if (norm(asked.force) > 1) was_pushed = true;
      }
      witness.asked.clear();
      if (frame.state != OperatingState::Active) {
        EXPECT_EQ(norm(frame.force), 0);
      }
      was_driven = was_driven || frame.state == OperatingState::Active;
      const plugin::ArmTruth truth = sut.truth();
      EXPECT_TRUE(is_finite(truth.tip) && is_finite(truth.motor_force));
      // A person who clears every fault at once.
      const Fault& fault = sut.snapshot().fault;
      if (fault.code != FaultCode::None) sut.controls().request_clear(fault.number);
    });
    if (was_driven) ++driven;
    if (was_pushed) ++pushed;
    forgotten += witness.forgotten;
  }
  EXPECT_GT(sessions, 20);
  EXPECT_GT(driven, 20);
  EXPECT_GT(pushed, 10);
  EXPECT_GT(forgotten, 100);
}

}  // namespace
}  // namespace thimble
