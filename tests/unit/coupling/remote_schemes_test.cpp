#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/coupling/constraint_model.hpp"
#include "daemon/coupling/scheme.hpp"
#include "daemon/link/in_process_link.hpp"
#include "daemon/link/thimble_arm_end.hpp"
#include "daemon/link/thimble_world_end.hpp"
#include "daemon/world/voxel_world.hpp"
#include "tests/unit/coupling/finger.hpp"

// Every scheme over our own datagrams, beside the same in one process.

namespace thimble::coupling {
namespace {

using std::chrono::milliseconds;
using testing::Finger;
using testing::Reference;

constexpr int kWarmUp_ticks = 6000;  // at rest in free space, until next to nothing tells the start
constexpr int kTicks = 4000;

std::unique_ptr<WorldCoupling> world_half(Scheme scheme, world::World& world) {
  if (has_own_world_half(scheme)) {
    return make_own_world_half(scheme, {.force_at = ForceAt::Both}, world, 1).value();
  }
  return make_world_coupling(ConstraintModel::GhostPoint, world, 1).value();
}

class Carriage {
 public:
  virtual ~Carriage() = default;
  virtual void send(const HandSample& sample, MonotonicTime now) = 0;
  virtual void pump(MonotonicTime now) = 0;
  virtual bool receive(ConstraintSet& out) = 0;
  virtual LinkQuality quality() = 0;
};

class InProcess final : public Carriage {
 public:
  InProcess(Scheme scheme, world::World& world, const link::ImpairmentSettings& impairment)
      : half_(world_half(scheme, world)), link_({.impairment = impairment}, *half_) {}
  void send(const HandSample& sample, MonotonicTime) override { link_.arm_end().send(sample); }
  void pump(MonotonicTime now) override { link_.pump(now); }
  bool receive(ConstraintSet& out) override { return link_.arm_end().receive(out); }
  LinkQuality quality() override { return link_.arm_end().quality(); }

 private:
  std::unique_ptr<WorldCoupling> half_;
  link::InProcessLink link_;
};

link::LinkKey some_key() {
  std::array<std::byte, link::LinkKey::kSize> bytes{};
  bytes.fill(std::byte{7});
  return link::LinkKey(bytes);
}

class Remote final : public Carriage {
 public:
  Remote(Scheme scheme, world::World& world, const link::ImpairmentSettings& impairment,
         double deadband_m = 0)
      : arm_({.impairment = impairment,
              .key = some_key(),
              .half = {.scheme = link::ShortName::of(to_string(scheme)), .force_at = 1},
              .deadband_m = deadband_m},
             counted()),
        world_(
            {.key = some_key()},
            [&world](const link::ThimbleHalf& arm) -> Result<std::unique_ptr<WorldCoupling>> {
              return world_half(parse_scheme(arm.scheme.view()).value(), world);
            },
            counted()) {}
  void send(const HandSample& sample, MonotonicTime) override { arm_.offer(sample); }
  void pump(MonotonicTime now) override {
    for (bool is_over = false; !is_over;) {
      is_over = true;
      for (ConstraintSet reply; arm_.take_reply(now, reply);) newest_ = reply;
      for (link::ThimbleDatagram datagram; arm_.poll(now, datagram); is_over = false) {
        world_.on_datagram(link::Endpoint(), datagram.view(), now);
      }
      for (link::ThimbleWorldEnd::Reply reply; world_.poll(now, reply); is_over = false) {
        arm_.on_datagram(reply.datagram.view(), now);
      }
    }
  }
  bool receive(ConstraintSet& out) override {
    if (!newest_) return false;
    out = *newest_;
    newest_.reset();
    return true;
  }
  LinkQuality quality() override { return arm_.quality(); }
  [[nodiscard]] link::LinkCounters counters() const { return arm_.status().counters; }

 private:
  static link::RandomBytes counted() {
    return [next = 1U](std::span<std::byte> out) mutable {
      for (std::byte& byte : out) byte = std::byte(next++ & 0xFFU);
    };
  }
  link::ThimbleArmEnd arm_;
  link::ThimbleWorldEnd world_;
  std::optional<ConstraintSet> newest_;
};

struct Trace {
  std::vector<double> force_newton;
  double most_offset_m{0};
  double generated_joule{0};
};

// A finger that is drawn into a wall and out again.
Trace felt(Scheme scheme, Carriage& carriage) {
  SchemeSettings settings;
  settings.spring_damper.force_at = ForceAt::Both;
  const auto arm = make_arm_coupling(scheme, settings);
  Finger finger(-0.005);
  Reference reference{.x_m = -0.005};
  MonotonicTime now{};
  arm->reset(now, {-0.005, 0, 0});
  Trace out;
  for (int tick = -kWarmUp_ticks; tick < kTicks; ++tick) {
    now = now + Finger::kServo;
    carriage.pump(now);
    ConstraintSet reply;
    const bool is_fresh = carriage.receive(reply);
    const Finger::Sight sight = finger.look();
    const ArmOutput output = arm->step({.now = now,
                                        .dt = Finger::kServo,
                                        .tip = {sight.x_m, 0, 0},
                                        .tip_velocity = {sight.v_m_per_s, 0, 0},
                                        .fresh = is_fresh ? &reply : nullptr,
                                        .link = carriage.quality()});
    carriage.send(output.sample, now);
    carriage.pump(now);
    if (tick >= 0) reference.advance(tick);
    finger.move(reference.x_m, tick < 0 ? 0 : reference.v_m_per_s, output.force.x);
    out.most_offset_m = std::max(out.most_offset_m, norm(output.offset));
    if (tick >= 0) out.force_newton.push_back(output.force.x);
  }
  out.generated_joule = finger.energy().generated_joule();
  return out;
}

template <class Kind>
std::vector<double> forces(Scheme scheme, double delay_s) {
  world::VoxelWorld world(world::make_box(3).value(), "box:3");
  Kind carriage(scheme, world, {.delay_s = delay_s});
  return felt(scheme, carriage).force_newton;
}

// A slave begins where its session does, a round trip or two later over a link, and stays some
// nanometres aside: where an encoder's step is on the edge it comes a tick sooner or later.
double most_difference_newton(Scheme scheme, double delay_s) {
  const bool has_slave = scheme == Scheme::SpringDamper || scheme == Scheme::Wave;
  return has_slave && delay_s > 0 ? 0.02 : 0;
}

double root_mean_square_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(RemoteSchemes, AreFeltOverOurOwnDatagramsAsInOneProcess) {
  for (const Scheme scheme : kSchemes) {
    for (const double delay_s : {0.0, 0.02, 0.1}) {
      SCOPED_TRACE(std::string(to_string(scheme)) + ", " + std::to_string(delay_s) + " s");
      const std::vector<double> here = forces<InProcess>(scheme, delay_s);
      const std::vector<double> there = forces<Remote>(scheme, delay_s);
      ASSERT_EQ(here.size(), there.size());
      EXPECT_LE(root_mean_square_difference(here, there), most_difference_newton(scheme, delay_s));
      EXPECT_LT(*std::min_element(there.begin(), there.end()), -0.3);  // the wall was felt
    }
  }
}

// Of the bounds of teleop.md 2(e): the wall lies no further than the band makes it, the hand is
// given no more than a shift may give, and full stiffness stays.
TEST(RemoteSchemes, ADeadbandHalvesThePacketsAndBreaksNoBound) {
  constexpr double kBand_m = 0.0005;
  struct Network {
    double delay_s{0};
    double loss{0};
  };
  for (const Scheme scheme : {Scheme::GhostPoint, Scheme::ConstraintPlane}) {
    for (const auto& [delay_s, loss] : {Network{0, 0},
                                        {0, 0.05},
                                        {0.02, 0},
                                        {0.05, 0.05},
                                        {0.1, 0},
                                        {0.2, 0.05},
                                        {0.5, 0},
                                        {0.5, 0.05}}) {
      SCOPED_TRACE(std::string(to_string(scheme)) + ", " + std::to_string(delay_s) + " s, loss " +
                   std::to_string(loss));
      const link::ImpairmentSettings impairment{.delay_s = delay_s, .loss = loss, .seed = 3};
      world::VoxelWorld world(world::make_box(3).value(), "box:3");
      Remote whole(scheme, world, impairment);
      const Trace with_all = felt(scheme, whole);
      Remote banded(scheme, world, impairment, kBand_m);
      const Trace with_band = felt(scheme, banded);
      EXPECT_LT(2 * banded.counters().sent, whole.counters().sent);
      // One more than the band: a loss costs what the hand moves in kMaxGap.
      const double lost_m = loss > 0 ? 0.2 * 5e-3 : 0;
      EXPECT_LE(with_band.most_offset_m, with_all.most_offset_m + kBand_m + 2e-4 + lost_m);
      EXPECT_LT(with_band.generated_joule, 1e-3);
      const double least =
          *std::min_element(with_band.force_newton.begin(), with_band.force_newton.end());
      EXPECT_LT(least, -0.2);  // the wall was felt: half of the K·H that a shift leaves
      EXPECT_GT(least, -8.5);
    }
  }
}

}  // namespace
}  // namespace thimble::coupling
