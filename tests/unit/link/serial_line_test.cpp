#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "daemon/link/line_arm_end.hpp"
#include "daemon/link/line_world_end.hpp"
#include "tests/unit/link/thimble_table.hpp"

// Both ends of a serial line in virtual time: every byte takes its ten bits.
namespace thimble::link {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using Protocol = ArmEndSettings::Protocol;

// One direction of a cable.
class Wire {
 public:
  Wire(std::uint32_t bit_per_s, double spoiled, unsigned seed)
      : byte_time_(Duration(10'000'000'000 / bit_per_s)), spoiled_(spoiled), random_(seed) {}

  void put(std::span<const std::byte> bytes, MonotonicTime now) {
    for (std::byte byte : bytes) {
      free_at_ = std::max(free_at_, now) + byte_time_;
      const bool is_spoiled = spoiled_(random_);
      if (is_spoiled && random_() % 2 == 0) continue;  // lost
      if (is_spoiled) byte ^= std::byte(1U << (random_() % 8));
      under_way_.push_back({free_at_, byte});
    }
  }
  std::vector<std::byte> take(MonotonicTime now) {
    std::vector<std::byte> out;
    for (; !under_way_.empty() && under_way_.front().at <= now; under_way_.pop_front()) {
      out.push_back(under_way_.front().byte);
    }
    return out;
  }
  // Of what was put and has not arrived.
  [[nodiscard]] std::size_t held() const { return under_way_.size(); }

 private:
  struct Byte {
    MonotonicTime at{};
    std::byte byte{};
  };
  Duration byte_time_;
  std::bernoulli_distribution spoiled_;
  std::mt19937 random_;
  MonotonicTime free_at_{};
  std::deque<Byte> under_way_;
};

class Line {
 public:
  Line(Protocol protocol, std::uint32_t bit_per_s, double spoiled = 0,
       SendMode mode = SendMode::Streamed)
      : there(bit_per_s, spoiled, 1),
        back(bit_per_s, spoiled, 2),
        arm(make_line_arm_end({.mode = mode, .protocol = protocol}, bit_per_s)),
        world(
            {}, &world_of_1999,
            [this](const ThimbleHalf&) -> Result<std::unique_ptr<coupling::WorldCoupling>> {
              halves.push_back(std::make_unique<WorldDouble>());
              return std::make_unique<on_table::Half>(*halves.back());
            },
            on_table::seeded_random(7), bit_per_s) {}

  // A servo of 1 kHz; the line is looked at each 100 us.
  void run(int ms) {
    for (int i = 0; i < 10 * ms; ++i) {
      now = now + microseconds(100);
      if (i % 10 == 0) {
        sample.sampled_at = now;
        ++sample.sequence;
        sample.hand.x = 1e-6 * static_cast<double>(sample.sequence);
        arm->offer(sample);
      }
      step();
    }
  }
  void step() {
    world.on_bytes(there.take(now), now);
    arm->on_bytes(back.take(now), now);
    for (coupling::ConstraintSet reply; arm->take_reply(now, reply);) {
      ++replies;
      if (halves.empty()) continue;  // those of 1999 tell no time, and one wall of each axis
      oldest = std::max(oldest, now - reply.sampled_at);
      planes_are_good = planes_are_good && reply.planes.size() == 6;
      pressure = reply.has_pressure ? std::optional(reply.pressure) : std::nullopt;
    }
    for (SerialFrame frame; arm->poll(now, frame);) there.put(frame.view(), now);
    for (SerialFrame frame; world.poll(now, frame);) back.put(frame.view(), now);
    most_held = std::max({most_held, there.held(), back.held()});
    const auto due = arm->next_due();
    EXPECT_TRUE(!due || *due >= now) << "would be polled in vain";
  }
  [[nodiscard]] const WorldDouble& touched() const {
    return halves.empty() ? world_of_1999 : *halves.back();
  }

  Wire there;
  Wire back;
  WorldDouble world_of_1999;
  std::vector<std::unique_ptr<WorldDouble>> halves;
  std::unique_ptr<LineArmEnd> arm;
  LineWorldEnd world;
  coupling::HandSample sample;
  MonotonicTime now{milliseconds(1000)};
  int replies{0};
  Duration oldest{};
  bool planes_are_good{true};
  std::optional<Force3> pressure;  // of the newest reply
  std::size_t most_held{0};
};

// A frame at the line, the world's turn, a frame back, and as long again until it was free.
Duration longest_trip(std::uint32_t bit_per_s, std::size_t there, std::size_t back) {
  return Duration(10'000'000'000 / bit_per_s * static_cast<Duration::rep>(2 * (there + back))) +
         milliseconds(3);
}

TEST(SerialLine, CarriesBothProtocolsAtEveryRateAsFastAsTheLineAllows) {
  for (const std::uint32_t rate : {38'400U, 115'200U, 1'000'000U, 3'000'000U}) {
    for (const Protocol protocol : {Protocol::Thesis, Protocol::Thimble}) {
      SCOPED_TRACE(std::to_string(rate) + (protocol == Protocol::Thesis ? ", 1999" : ", ours"));
      Line line(protocol, rate);
      line.run(1000);
      ASSERT_TRUE(line.arm->quality().is_up);
      EXPECT_EQ(line.halves.size(), protocol == Protocol::Thesis ? 0U : 1U);
      const int before = line.replies;
      line.oldest = {};
      line.run(2000);
      // What one answer needs of the slower direction, or the servo's rate.
      const double frame = protocol == Protocol::Thesis ? 20 : 400;
      EXPECT_GT(line.replies - before, std::min(0.9 * 2000, 2 * 0.9 * rate / 10 / frame));
      EXPECT_LE(line.oldest, longest_trip(rate, 160, 400)) << "no answer waits behind another";
      EXPECT_TRUE(line.planes_are_good);
      EXPECT_LE(line.most_held, protocol == Protocol::Thesis ? 20U : 400U) << "one frame at a time";
      EXPECT_EQ(line.arm->status().counters.receive_errors, 0U);
    }
  }
}

TEST(SerialLine, CarriesAPressureByOurOwnDatagrams) {
  Line line(Protocol::Thimble, 115'200);
  line.run(1000);
  ASSERT_EQ(line.halves.size(), 1U);
  EXPECT_FALSE(line.pressure);
  line.halves[0]->pressure = Force3{0.5, -2, 0};
  line.run(500);
  EXPECT_EQ(line.pressure, (Force3{0.5, -2, 0}));
}

TEST(SerialLine, LockStepWaitsForItsAnswer) {
  Line line(Protocol::Thimble, 115'200, 0, SendMode::LockStep);
  line.run(2000);
  const LinkCounters counters = line.arm->status().counters;
  EXPECT_GT(line.replies, 20);
  EXPECT_LE(counters.sent, static_cast<std::uint64_t>(line.replies) + 5);  // and the hellos
}

TEST(SerialLine, ALineThatSpoilsBytesIsCountedAndFeltNoWorse) {
  for (const Protocol protocol : {Protocol::Thesis, Protocol::Thimble}) {
    Line line(protocol, 460'800, 0.001);
    line.run(5000);
    EXPECT_TRUE(line.arm->quality().is_up);
    EXPECT_TRUE(line.planes_are_good);
    EXPECT_GT(line.arm->status().counters.receive_errors, 0U);
    EXPECT_GT(line.world.status().counters.receive_errors, 0U);
    for (const auto& told : line.touched().samples) {
      ASSERT_LE(told.hand.x, line.sample.hand.x);
      ASSERT_EQ(told.hand.y, 0);
    }
  }
}

TEST(SerialLine, GarbageInBetweenCostsAFrameAndNoSession) {
  std::mt19937 random(5);
  Line line(Protocol::Thimble, 1'000'000);
  line.run(500);
  for (int burst = 0; burst < 20; ++burst) {
    std::vector<std::byte> noise(random() % 300);
    for (std::byte& byte : noise) byte = std::byte(random() & 0xFFU);
    line.there.put(noise, line.now);
    line.back.put(noise, line.now);
    line.run(100);
  }
  EXPECT_TRUE(line.arm->quality().is_up);
  EXPECT_EQ(line.arm->status().counters.sessions_opened, 1U);
  EXPECT_TRUE(line.planes_are_good);
}

TEST(SerialLine, AnArmThatRestartedTakesItsPlaceAtOnce) {
  Line line(Protocol::Thimble, 115'200);
  line.run(1000);
  line.arm = make_line_arm_end({.protocol = Protocol::Thimble}, 115'200);
  const int before = line.replies;
  line.run(600);
  EXPECT_GT(line.replies, before);
  EXPECT_EQ(line.halves.size(), 2U);
  EXPECT_EQ(line.halves.front()->closed, 1U);
}

TEST(SerialLine, WithAKeyNobodyElseIsHeard) {
  WorldDouble world_of_1999;
  LineWorldEnd world({.key = on_table::key_of(1)}, &world_of_1999, {}, on_table::seeded_random(1),
                     115'200);
  auto arm = make_line_arm_end({}, 115'200);
  arm->offer({.sequence = 1});
  SerialFrame frame;
  ASSERT_TRUE(arm->poll({}, frame));
  world.on_bytes(frame.view(), {});
  EXPECT_FALSE(world.poll({}, frame));
  EXPECT_EQ(world.status().counters.rejected(RejectReason::WrongVersion), 1U);
  EXPECT_EQ(world_of_1999.opened, 0U);
}

}  // namespace
}  // namespace thimble::link
