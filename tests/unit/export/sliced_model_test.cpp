#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "sim/model/arm/register_arm_models.hpp"
#include "sim/model/falcon/falcon_arm_model.hpp"
#include "sim/model/falcon/falcon_parameters.hpp"

namespace thimble::sim {
namespace {

constexpr Duration kFrame{1'000'000};
constexpr int kFrames = 500;

// A model's clock, which goes to the end of a frame at once, or by chance in up to ten slices,
// few of which end where the mechanics' own steps do.
class Frames {
 public:
  explicit Frames(bool is_sliced) : is_sliced_(is_sliced) {}

  template <class Model>
  void run_next(Model& model) {
    const MonotonicTime end = now_ + kFrame;
    model.advance(now_);  // as the frame before, or at the start
    while (is_sliced_ && (now_ = now_ + Duration(100'000 + dice_() % 700'000)) < end) {
      model.advance(now_);
    }
    now_ = end;
    model.advance(end);
  }

 private:
  bool is_sliced_;
  std::mt19937 dice_{3};
  MonotonicTime now_{};
};

// What the arm says and what is true of it, frame by frame, while it is pushed about.
std::string history(plugin::SimHidModel& model, bool is_sliced) {
  Frames frames(is_sliced);
  std::mt19937 dice(7);
  std::vector<std::uint8_t> report(model.describe().output_report_bytes);
  std::vector<std::uint8_t> said(model.describe().input_report_bytes);
  std::string all;
  for (int i = 0; i < kFrames; ++i) {
    frames.run_next(model);
    if (i % 50 == 0) model.arm_backend()->push_tip({std::sin(i), 0.5, -0.3});
    for (std::uint8_t& byte : report) byte = static_cast<std::uint8_t>(dice() % 8);
    model.out_report(report);
    const std::size_t size = model.in_report(said);
    all.append(said.begin(), said.begin() + static_cast<std::ptrdiff_t>(size));
    const auto tip =
        std::bit_cast<std::array<char, sizeof(Position3)>>(model.arm_backend()->truth().tip);
    all.append(tip.begin(), tip.end());
  }
  return all;
}

TEST(ModelInSlices, AnArmOfThePhantomFamilyMovesAndSpeaksTheSame) {
  plugin::SimModelRegistry models;
  register_arm_models(models);
  for (const plugin::SimModelEntry& entry : models.entries()) {
    const auto whole = *entry.create_hid({.amplifier_max_a = 3, .seed = 1});
    const auto sliced = *entry.create_hid({.amplifier_max_a = 3, .seed = 1});
    const Position3 begin = whole->arm_backend()->truth().tip;
    EXPECT_EQ(history(*sliced, true), history(*whole, false)) << entry.name;
    EXPECT_NE(whole->arm_backend()->truth().tip, begin) << entry.name << " rests";
  }
}

TEST(ModelInSlices, AFalconMovesTheSame) {
  FalconArmModel whole(falcon_parameters());
  FalconArmModel sliced(falcon_parameters());
  Frames one(false);
  Frames other(true);
  const Position3 begin = whole.arm_backend()->truth().tip;
  for (int i = 0; i < kFrames; ++i) {
    const Force3 push{0.3 * std::sin(i), 0.2, 0.1};
    whole.arm_backend()->push_tip(push);
    sliced.arm_backend()->push_tip(push);
    one.run_next(whole);
    other.run_next(sliced);
    ASSERT_EQ(whole.arm_backend()->truth().tip, sliced.arm_backend()->truth().tip) << i;
  }
  EXPECT_NE(whole.arm_backend()->truth().tip, begin);
}

}  // namespace
}  // namespace thimble::sim
