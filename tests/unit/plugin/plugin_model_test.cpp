#include "hal/plugin/plugin_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace thimble::plugin {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// What a model in this program does and was told; its address is the settings' seed.
struct ModelScript {
  std::int32_t create = THIMBLE_OK;
  bool gives_device = true;
  std::string reason;
  std::int64_t frame_ns = 1'000'000;
  std::function<void(const thimble_tip_load*, std::int64_t)> advance = [](const thimble_tip_load*,
                                                                          std::int64_t) {};
  std::uint32_t in_bytes = 14;
  thimble_arm_truth truth{};

  const thimble_tip_load* load = nullptr;
  std::vector<std::string> told;
};

ModelScript& script_of(void* device) { return *static_cast<ModelScript*>(device); }
std::string text(const char* verb, const double* v) {
  return std::string(verb) + " " + std::to_string(v[0]) + " " + std::to_string(v[1]) + " " +
         std::to_string(v[2]);
}

void fill_backend(thimble_model& model) {
  model.hold_tip = [](void* device, const thimble_tip_load* load) {
    script_of(device).load = load;
  };
  model.push_tip = [](void* device, const double* newton) {
    script_of(device).told.push_back(text("push", newton));
  };
  model.move_tip_to = [](void* device, const double* tip_m) {
    script_of(device).told.push_back(text("move", tip_m));
    return tip_m[0] > 1 ? std::int32_t{THIMBLE_REFUSED} : std::int32_t{THIMBLE_OK};
  };
  model.press_calibration_button = [](void* device, std::int32_t pressed) {
    script_of(device).told.push_back("calibration " + std::to_string(pressed));
  };
  model.press_stylus_button = [](void* device, std::int32_t pressed) {
    script_of(device).told.push_back("stylus " + std::to_string(pressed));
  };
  model.turn_stylus = [](void* device, const double* angle_rad) {
    script_of(device).told.push_back(text("turn", angle_rad));
  };
  model.read_truth = [](void* device, thimble_arm_truth* truth) {
    *truth = script_of(device).truth;
  };
}

thimble_model scripted_model() {
  thimble_model model{};
  model.struct_bytes = sizeof(model);
  std::strcpy(model.name, "scripted");
  std::strcpy(model.description, "as the test says");
  model.create = [](const thimble_model_settings* settings, thimble_model_facts* facts,
                    void** device, thimble_reason* reason) {
    auto& script = *reinterpret_cast<ModelScript*>(settings->seed);
    facts->frame_period_ns = script.frame_ns;
    facts->info.vendor_id = 0x1234;
    facts->info.product_id = 6;
    facts->info.input_report_bytes = 14;
    facts->info.output_report_bytes = 8;
    std::memset(facts->info.product, 'p', sizeof(facts->info.product));  // without its end
    facts->home_m[1] = 0.02;
    std::strcpy(reason->text, script.reason.c_str());
    *device = script.gives_device ? &script : nullptr;
    return script.create;
  };
  model.destroy = [](void* device) { script_of(device).told.push_back("destroy"); };
  model.advance = [](void* device, std::int64_t t_ns) {
    script_of(device).advance(script_of(device).load, t_ns);
  };
  model.out_report = [](void* device, const std::uint8_t* bytes, std::uint32_t size) {
    script_of(device).told.push_back("out " + std::to_string(size) + " " +
                                     std::to_string(bytes[0]));
  };
  model.in_report = [](void* device, std::uint8_t* bytes) {
    bytes[0] = 7;
    return script_of(device).in_bytes;
  };
  model.power_cycle = [](void* device) { script_of(device).told.push_back("power"); };
  fill_backend(model);
  return model;
}

class Hand final : public TipLoad {
 public:
  Force3 force_on_tip(MonotonicTime, Duration dt, Position3 tip, Velocity3) noexcept override {
    asked.push_back(seconds(dt));
    tips.push_back(tip);
    return answer;
  }
  [[nodiscard]] bool is_button_pressed(MonotonicTime) const noexcept override { return true; }
  Force3 answer{1, 2, 3};
  std::vector<double> asked;
  std::vector<Position3> tips;
};

class PluginModelTest : public testing::Test {
 protected:
  Result<std::unique_ptr<SimHidModel>> create() {
    return plugin_model_entry(table_).create_hid(
        {.amplifier_max_a = 0, .seed = reinterpret_cast<std::uintptr_t>(&script_)});
  }
  void SetUp() override {
    auto made = create();
    ASSERT_TRUE(made) << made.error().message;
    sut_ = *std::move(made);
    arm_ = sut_->arm_backend();
  }
  thimble_model table_ = scripted_model();
  ModelScript script_;
  Hand hand_;
  std::unique_ptr<SimHidModel> sut_;
  ArmBackend* arm_{nullptr};
};

TEST_F(PluginModelTest, DescribesItself) {
  const SimModelEntry entry = plugin_model_entry(table_);
  EXPECT_EQ(entry.name, "scripted");
  EXPECT_EQ(entry.description, "as the test says");
  const bus::BusDeviceInfo info = sut_->describe();
  EXPECT_EQ(info.address.text, "sim:scripted");
  EXPECT_EQ(info.kind, bus::BusKind::Hid);
  EXPECT_EQ(info.vendor_id, 0x1234);
  EXPECT_EQ(info.product, std::string(THIMBLE_STRING_BYTES, 'p'));
  EXPECT_EQ(info.input_report_bytes, 14U);
  EXPECT_EQ(info.output_report_bytes, 8U);
  EXPECT_EQ(sut_->frame_period(), milliseconds(1));
  EXPECT_EQ(arm_->home_position(), (Position3{0, 0.02, 0}));
}

TEST_F(PluginModelTest, OneThatCannotBeMadeSaysWhy) {
  script_.create = THIMBLE_REFUSED;
  script_.reason = "no seed";
  EXPECT_EQ(create().error().message, "no seed");
  script_.reason.clear();
  EXPECT_THAT(create().error().message, HasSubstr("does not say why"));
  script_.create = THIMBLE_OK;
  script_.gives_device = false;
  EXPECT_THAT(create().error().message, HasSubstr("gave no device"));
  script_.gives_device = true;
  EXPECT_THAT(script_.told, IsEmpty());
  script_.frame_ns = 0;
  EXPECT_THAT(create().error().message, HasSubstr("frame period"));
  EXPECT_THAT(script_.told, ElementsAre("destroy"));
}

TEST_F(PluginModelTest, PassesTheVerbsOnAndNoNumberThatIsNone) {
  arm_->push_tip({1, 0, 0});
  arm_->push_tip({kNaN, 5, 5});
  EXPECT_TRUE(arm_->move_tip_to({0.5, 0, 0}));
  EXPECT_FALSE(arm_->move_tip_to({1.5, 0, 0}));
  EXPECT_FALSE(arm_->move_tip_to({kNaN, 0, 0}));
  arm_->press_calibration_button(true);
  arm_->press_stylus_button(false);
  arm_->turn_stylus({0, 1, 0});
  arm_->turn_stylus({0, kNaN, 0});
  sut_->power_cycle();
  const std::array<std::uint8_t, 2> bytes{9, 8};
  sut_->out_report(bytes);
  sut_.reset();
  EXPECT_THAT(script_.told,
              ElementsAre("push 1.000000 0.000000 0.000000", "push 0.000000 0.000000 0.000000",
                          "move 0.500000 0.000000 0.000000", "move 1.500000 0.000000 0.000000",
                          "calibration 1", "stylus 0", "turn 0.000000 1.000000 0.000000", "power",
                          "out 2 9", "destroy"));
}

TEST_F(PluginModelTest, AReportLongerThanAPacketIsNone) {
  std::array<std::uint8_t, 64> out{};
  EXPECT_EQ(sut_->in_report(out), 14U);
  EXPECT_EQ(out[0], 7);
  for (const std::uint32_t bad : {65U, UINT32_MAX}) {
    script_.in_bytes = bad;
    EXPECT_EQ(sut_->in_report(out), 0U);
  }
  script_.in_bytes = 14;
  EXPECT_EQ(sut_->in_report(std::span(out).first(13)), 0U) << "longer than there is room for";
}

TEST_F(PluginModelTest, TruthThatIsNotFiniteIsZero) {
  script_.truth.tip_m[0] = 0.1;
  script_.truth.motor_current_a[2] = 2;
  script_.truth.gimbal_rad[1] = 1;
  script_.truth.motor_force_newton[1] = kNaN;
  script_.truth.mechanical_energy_j = kNaN;
  script_.truth.is_amplifier_on = 1;
  const ArmTruth truth = arm_->truth();
  EXPECT_EQ(truth.tip, (Position3{0.1, 0, 0}));
  EXPECT_EQ(truth.motor_current_a, (std::array{0.0, 0.0, 2.0}));
  EXPECT_EQ(truth.gimbal_rad, (std::array{0.0, 1.0, 0.0}));
  EXPECT_EQ(truth.motor_force, Force3{});
  EXPECT_EQ(truth.mechanical_energy_j, 0);
  EXPECT_TRUE(truth.is_amplifier_on);
}

// What a plant may ask the hand is answered; all else is no force.
TEST_F(PluginModelTest, TheHandIsAskedInTurnOnlyAndWithNumbersOnly) {
  std::vector<double> answers;
  const auto ask = [&answers](const thimble_tip_load* load, std::int64_t t_ns, std::int64_t dt_ns,
                              double tip_x_m) {
    const double tip_m[3] = {tip_x_m, 0, 0};
    const double still[3] = {};
    double newton[3] = {99, 99, 99};
    load->force_on_tip(load->context, t_ns, dt_ns, tip_m, still, newton);
    answers.push_back(newton[0]);
  };
  const thimble_tip_load* kept = nullptr;
  script_.advance = [&](const thimble_tip_load* load, std::int64_t t_ns) {
    kept = load;
    ask(load, t_ns - 500'000, 50'000, 0.1);  // good
    ask(load, t_ns - 600'000, 50'000, 0.1);  // backwards
    ask(load, t_ns + 1, 50'000, 0.1);        // ahead
    ask(load, t_ns, 0, 0.1);                 // no time
    ask(load, t_ns, INT64_MAX, 0.1);         // for ever
    ask(load, t_ns, 50'000, kNaN);           // nowhere
    ask(load, t_ns, 50'000, 0.2);            // good
    answers.push_back(load->is_button_pressed(load->context, t_ns));
    answers.push_back(load->is_button_pressed(load->context, t_ns + 1));
  };
  arm_->hold_tip(&hand_);
  sut_->advance(MonotonicTime{milliseconds(1)});
  ask(kept, 1'000'000, 50'000, 0.1);  // out of turn
  EXPECT_THAT(answers, ElementsAre(1, 0, 0, 0, 0, 0, 1, 1, 0, 0));
  EXPECT_THAT(hand_.tips, ElementsAre(Position3{0.1, 0, 0}, Position3{0.2, 0, 0}));
  EXPECT_THAT(hand_.asked, ElementsAre(50e-6, 50e-6));

  answers.clear();
  hand_.answer.x = kNaN;
  sut_->advance(MonotonicTime{milliseconds(2)});
  EXPECT_EQ(answers[0], 0) << "a hand's force that is no number is none";
  arm_->hold_tip(nullptr);
  EXPECT_EQ(script_.load, nullptr);
}

TEST_F(PluginModelTest, TimeNeverGoesBackwards) {
  std::vector<std::int64_t> times;
  script_.advance = [&times](const thimble_tip_load*, std::int64_t t_ns) { times.push_back(t_ns); };
  sut_->advance(MonotonicTime{milliseconds(5)});
  sut_->advance(MonotonicTime{milliseconds(4)});
  sut_->advance(MonotonicTime{milliseconds(5) + microseconds(1)});
  EXPECT_THAT(times, ElementsAre(5'000'000, 5'001'000));
}

}  // namespace
}  // namespace thimble::plugin
