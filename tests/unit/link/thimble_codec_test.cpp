// lint: long-file one list of cases for each kind of datagram
#include "daemon/link/thimble_codec.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "golden_datagrams.hpp"

namespace thimble::link {
namespace {

using std::chrono::nanoseconds;
using testing::counted_from;
using testing::golden;

constexpr std::uint64_t kSession = 0x0123456789ABCDEF;
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

MonotonicTime at(std::int64_t ns) { return {nanoseconds(ns)}; }

template <class Message>
std::vector<std::byte> content_of(const Message& message) {
  std::array<std::byte, kMaxThimbleContent> out{};
  const Decoded<std::size_t> size = encode(message, out);
  EXPECT_TRUE(size.has_value());
  return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(size.value_or(0))};
}

template <class Message>
std::vector<std::byte> datagram_of(const ThimbleHeader& header, const Message& message) {
  std::array<std::byte, kThimbleHeaderSize> begin{};
  encode_header(header, begin);
  std::vector<std::byte> out(begin.begin(), begin.end());
  const std::vector<std::byte> content = content_of(message);
  out.insert(out.end(), content.begin(), content.end());
  return out;
}

// Both ways: the message gives the bytes, and the bytes give a message that gives them again.
template <class Message>
void expect_golden(const std::string& name, const ThimbleHeader& header, const Message& message) {
  SCOPED_TRACE(name);
  const std::vector<std::byte>& bytes = golden().at(name);
  EXPECT_EQ(datagram_of(header, message), bytes);
  const Decoded<ThimbleHeader> read = decode_header(bytes);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(*read, header);
  Message again;
  ASSERT_TRUE(decode(std::span(bytes).subspan(kThimbleHeaderSize), again).has_value());
  EXPECT_EQ(datagram_of(header, again), bytes);
}

template <class Message>
std::optional<RejectReason> refused(const std::vector<std::byte>& content) {
  Message out;
  const Decoded<void> done = decode(content, out);
  return done ? std::nullopt : std::optional(done.error());
}

ThimbleSample least_sample() {
  ThimbleSample m;
  m.timing = {at(1'000'000'000), at(2'000'000'000), at(900'000'000)};
  m.sample = {.sequence = 77, .sampled_at = at(999'000'000), .hand = {0.0155, -0.25, 1e-300}};
  m.sample.buttons = 0b101;
  m.sample.applied_reply = 41;
  m.sample.restart = 3;
  return m;
}

ThimbleSample full_sample() {
  ThimbleSample m = least_sample();
  m.sample.velocity = {0.2, -0.1, 0.05};
  m.sample.tool = {{800}, {5}};
  m.sample.waves = {{1, 2, -3}, {0.5, 0.25, 0.125}};
  m.sample.impulse = {-0.001, 0.002, 0};
  m.sample.presses = {1, 0, 255, 0, 0, 0, 0, 7};
  m.sample.has_presses = true;
  m.sample.energy_joule = 0.0001;
  m.sample.epoch = 9;
  m.sample.has_ghost = true;
  m.sample.ghost = {0.0151, -0.25, 0};
  m.sample.applied_before = 0b101;
  m.sample.pull = {-0.75, 0, 1.5};
  m.sample.actions = {3, 255};
  m.sample.has_actions = true;
  return m;
}

ThimbleConstraints least_constraints() {
  ThimbleConstraints m;
  m.timing = {at(2'500'000'000), at(1'000'000'000), at(2'400'000'000)};
  m.request = 12;
  m.set.sequence = 42;
  m.set.answers = 77;
  m.set.sampled_at = at(999'000'000);
  m.set.session = 6;
  return m;
}

ThimbleConstraints full_constraints() {
  ThimbleConstraints m = least_constraints();
  m.set.planes.push_back(
      {.normal = {1, 0, 0}, .offset_m = 0.015, .surface = {{800}, {-1}, 0.5, 310.15}});
  m.set.planes.push_back({.normal = {0, 0.6, -0.8}, .offset_m = -0.02});
  m.set.ghost = {0.0149, 0, 0.01};
  m.set.has_ghost = true;
  m.set.is_embedded = true;
  m.set.far = {{-1.5, 0, 0.25}, {0.015, 0, 0.01}, {0, 0.001, 0}, {{4, 5, 6}, {1, 1.5, 2}}, true};
  m.set.far.is_arm = true;
  m.set.far.tool = {{400}, {5}};
  m.set.has_far = true;
  m.set.map.epoch = 9;
  m.set.pressure = {0, 0.75, 0};
  m.set.has_pressure = true;
  m.set.energy_joule = 0.002;
  m.set.has_near = true;
  m.set.is_astray = true;
  world::NearCells& near = m.set.near;
  near.lattice = {.cells = {64, 32, 1}, .half_cell_m = 0.000703125};
  near.middle = {33, 31, 0};
  near.known = {{-31, -31, 0}, {31, 31, 0}};
  near.is_plane = true;
  near.boxes.push_back({{-31, 0, 2}, {-1, 0, 31}});
  near.boxes.push_back({{0, 1, 0}, {0, 1, 0}});
  m.set.has_map = true;
  m.set.map.lattice = near.lattice;
  m.set.map.ghost_cell = near.middle;
  m.set.map.is_plane = true;
  world::OccupancyBlock block{.at = {4, 3, -1}, .version = 70'000};
  for (unsigned z = 0; z < block.slices.size(); ++z) block.slices[z] = std::uint64_t{1} << (3 * z);
  m.set.map.blocks.push_back(block);
  return m;
}

ThimbleConstraints with_a_cell() {
  ThimbleConstraints m = least_constraints();
  m.set.ghost = {0.0149, 0, 0.01};
  m.set.has_ghost = true;
  m.set.ghost_cell = {33, 31, -1};
  m.set.has_ghost_cell = true;
  return m;
}

ThimbleHello join() {
  return {.timing = {at(1), {}, {}},
          .arm_nonce = counted_from(0),
          .world_nonce = counted_from(64),
          .half = {ShortName::of("buffer-zone"), 1, 1, 0.03}};
}

ThimbleWelcome welcome() {
  return {.timing = {at(4), at(3), at(3)},
          .arm_nonce = counted_from(0),
          .world = ShortName::of("box"),
          .cells = {64, 32, 16},
          .cell_m = 0.00140625,
          .epoch = 9};
}

TEST(ThimbleCodec, MatchesTheBytesWrittenWithoutIt) {
  ASSERT_EQ(golden().size(), 12U);
  ThimbleHello hello = join();
  expect_golden("join", {ThimbleKind::Hello, false, 0, 2}, hello);
  hello.world_nonce = {};
  hello.half = {.scheme = ShortName::of("ghost-point")};
  expect_golden("hello", {ThimbleKind::Hello, false, 0, 1}, hello);
  expect_golden("challenge", {ThimbleKind::Challenge, false, 0, 1},
                ThimbleChallenge{{at(2), at(1), at(2)}, counted_from(0), counted_from(64)});
  expect_golden("welcome", {ThimbleKind::Welcome, false, kSession, 1}, welcome());
  expect_golden(
      "refusal", {ThimbleKind::Refusal, false, 0, 3},
      ThimbleRefusal{{at(4), at(3), at(3)}, counted_from(0), ThimbleRefusalReason::Scheme});
  expect_golden("refusal_by_an_arm", {ThimbleKind::Refusal, false, 0, 4},
                ThimbleRefusal{{at(4), at(3), at(3)},
                               counted_from(0),
                               ThimbleRefusalReason::Arm,
                               ShortName::of("wave")});
  expect_golden("sample_least", {ThimbleKind::Sample, false, kSession, 12}, least_sample());
  expect_golden("sample_full", {ThimbleKind::Sample, false, kSession, 13}, full_sample());
  expect_golden("constraints_least", {ThimbleKind::Constraints, false, kSession, 2},
                least_constraints());
  expect_golden("constraints_full", {ThimbleKind::Constraints, false, kSession, 3},
                full_constraints());
  expect_golden("constraints_cell", {ThimbleKind::Constraints, false, kSession, 4}, with_a_cell());
  expect_golden("idle", {ThimbleKind::Idle, false, kSession, 5},
                ThimbleIdle{{at(7), at(6), at(6)}, 14});
}

TEST(ThimbleCodec, GivesBackEveryFieldOfASample) {
  ThimbleSample out;
  ASSERT_TRUE(decode(content_of(full_sample()), out).has_value());
  const ThimbleSample in = full_sample();
  EXPECT_EQ(out.timing, in.timing);
  EXPECT_EQ(out.sample.sequence, 77U);
  EXPECT_EQ(out.sample.sampled_at, in.sample.sampled_at);
  EXPECT_EQ(out.sample.hand, in.sample.hand);
  EXPECT_EQ(out.sample.velocity, in.sample.velocity);
  EXPECT_EQ(out.sample.buttons, 5U);
  EXPECT_EQ(out.sample.applied_reply, 41U);
  EXPECT_EQ(out.sample.restart, 3U);
  EXPECT_EQ(out.sample.tool, in.sample.tool);
  EXPECT_EQ(out.sample.waves, in.sample.waves);
  EXPECT_EQ(out.sample.impulse, in.sample.impulse);
  EXPECT_TRUE(out.sample.has_presses);
  EXPECT_EQ(out.sample.presses, in.sample.presses);
  EXPECT_EQ(out.sample.energy_joule, in.sample.energy_joule);
  EXPECT_EQ(out.sample.epoch, 9U);
  EXPECT_TRUE(out.sample.has_ghost);
  EXPECT_EQ(out.sample.ghost, in.sample.ghost);
  EXPECT_EQ(out.sample.applied_before, 0b101U);
  EXPECT_EQ(out.sample.pull, in.sample.pull);
  EXPECT_TRUE(out.sample.has_actions);
  EXPECT_EQ(out.sample.actions, in.sample.actions);
}

TEST(ThimbleCodec, GivesBackEveryFieldOfConstraints) {
  ThimbleConstraints out;
  ASSERT_TRUE(decode(content_of(full_constraints()), out).has_value());
  const ThimbleConstraints in = full_constraints();
  EXPECT_EQ(out.timing, in.timing);
  EXPECT_EQ(out.request, 12U);
  EXPECT_EQ(out.set.sequence, 42U);
  EXPECT_EQ(out.set.answers, 77U);
  EXPECT_EQ(out.set.sampled_at, in.set.sampled_at);
  EXPECT_EQ(out.set.session, 6U);
  EXPECT_EQ(out.set.planes, in.set.planes);
  EXPECT_TRUE(out.set.has_ghost);
  EXPECT_EQ(out.set.ghost, in.set.ghost);
  EXPECT_TRUE(out.set.has_ghost_cell);
  EXPECT_EQ(out.set.ghost_cell, in.set.map.ghost_cell);
  EXPECT_TRUE(out.set.is_embedded);
  EXPECT_TRUE(out.set.has_far);
  EXPECT_EQ(out.set.far.force, in.set.far.force);
  EXPECT_EQ(out.set.far.slave, in.set.far.slave);
  EXPECT_EQ(out.set.far.velocity, in.set.far.velocity);
  EXPECT_EQ(out.set.far.waves, in.set.far.waves);
  EXPECT_TRUE(out.set.far.is_pressing);
  EXPECT_TRUE(out.set.far.is_arm);
  EXPECT_EQ(out.set.far.tool, in.set.far.tool);
  EXPECT_EQ(out.set.map.epoch, 9U);
  EXPECT_TRUE(out.set.has_pressure);
  EXPECT_EQ(out.set.pressure, in.set.pressure);
  EXPECT_EQ(out.set.energy_joule, in.set.energy_joule);
  EXPECT_TRUE(out.set.is_astray);
  ASSERT_TRUE(out.set.has_near);
  EXPECT_EQ(out.set.near.lattice, in.set.near.lattice);
  EXPECT_EQ(out.set.near.middle, in.set.near.middle);
  EXPECT_EQ(out.set.near.boxes, in.set.near.boxes);
  EXPECT_EQ(out.set.near.known, in.set.near.known);
  EXPECT_TRUE(out.set.near.is_plane);
  ASSERT_TRUE(out.set.has_map);
  EXPECT_EQ(out.set.map.lattice, in.set.map.lattice);
  EXPECT_EQ(out.set.map.ghost_cell, in.set.map.ghost_cell);
  EXPECT_TRUE(out.set.map.is_plane);
  EXPECT_EQ(out.set.map.blocks, in.set.map.blocks);
}

// What `content` says is the same whatever the message held before.
template <class Message>
void expect_nothing_is_left_of(const Message& before, const std::vector<std::byte>& content) {
  Message fresh;
  Message used = before;
  ASSERT_TRUE(decode(content, fresh).has_value());
  ASSERT_TRUE(decode(content, used).has_value());
  EXPECT_EQ(content_of(fresh), content);
  EXPECT_EQ(content_of(used), content);
}

TEST(ThimbleCodec, KeepsNothingOfTheMessageThatStoodThereBefore) {
  expect_nothing_is_left_of(full_sample(), content_of(least_sample()));
  expect_nothing_is_left_of(least_sample(), content_of(full_sample()));
  for (const ThimbleConstraints& next : {least_constraints(), with_a_cell(), full_constraints()}) {
    expect_nothing_is_left_of(full_constraints(), content_of(next));
    ThimbleConstraints with_plane = next;  // whose surface says nothing
    with_plane.set.planes.clear();
    with_plane.set.planes.push_back({.normal = {0, 0, 1}, .offset_m = 0.1});
    expect_nothing_is_left_of(full_constraints(), content_of(with_plane));
  }
  ThimbleConstraints far = least_constraints();
  far.set.has_far = true;
  ThimbleConstraints used = full_constraints();
  ASSERT_TRUE(decode(content_of(far), used).has_value());
  EXPECT_FALSE(used.set.far.is_arm);
  EXPECT_EQ(used.set.far.tool, coupling::ToolProperties());
  EXPECT_EQ(used.set.map.epoch, 0U);
  EXPECT_EQ(used.set.energy_joule, -1);
  const ThimbleRefusal by_an_arm{
      {}, counted_from(0), ThimbleRefusalReason::Arm, ShortName::of("wave")};
  ThimbleRefusal plain = by_an_arm;
  plain.reason = ThimbleRefusalReason::Busy;
  plain.scheme = {};
  ThimbleRefusal refusal = by_an_arm;
  ASSERT_TRUE(decode(content_of(plain), refusal).has_value());
  EXPECT_EQ(refusal, plain);
}

TEST(ThimbleCodec, RefusesEveryContentThatEndsEarlyOrGoesOn) {
  for (const auto& [name, bytes] : golden()) {
    SCOPED_TRACE(name);
    const auto reason = [kind = decode_header(bytes)->kind](const std::vector<std::byte>& content) {
      switch (kind) {
        case ThimbleKind::Hello:
          return refused<ThimbleHello>(content);
        case ThimbleKind::Challenge:
          return refused<ThimbleChallenge>(content);
        case ThimbleKind::Welcome:
          return refused<ThimbleWelcome>(content);
        case ThimbleKind::Refusal:
          return refused<ThimbleRefusal>(content);
        case ThimbleKind::Sample:
          return refused<ThimbleSample>(content);
        case ThimbleKind::Constraints:
          return refused<ThimbleConstraints>(content);
        case ThimbleKind::Idle:
          break;
      }
      return refused<ThimbleIdle>(content);
    };
    std::vector<std::byte> content(bytes.begin() + kThimbleHeaderSize, bytes.end());
    EXPECT_FALSE(reason(content).has_value());
    for (std::size_t size = 0; size < content.size(); ++size) {
      EXPECT_TRUE(reason({content.begin(), content.begin() + static_cast<long>(size)}).has_value());
    }
    content.push_back({});
    const bool may_go_on = name == "hello" || name == "join" || name == "welcome";
    EXPECT_EQ(reason(content).has_value(), !may_go_on);
  }
}

TEST(ThimbleCodec, LeavesOutFieldsOfALaterVersion) {
  std::vector<std::byte> content = content_of(full_sample());
  const std::size_t mask_at = 24 + 8 + 8 + 4 + 4 + 8 + 24;
  content[mask_at] = std::byte{0x80};
  content.resize(content.size() + 17);
  ThimbleSample out;
  ASSERT_TRUE(decode(content, out).has_value());
  EXPECT_EQ(out.sample.applied_before, 0b101U);
}

// Bit 7 and kind 18 were kept for occupancy that bit 10 of constraints tells.
TEST(ThimbleCodec, RefusesWhatNobodyMayEverSay) {
  std::vector<std::byte> content = content_of(full_sample());
  const std::size_t mask_at = 24 + 8 + 8 + 4 + 4 + 8 + 24;
  content[mask_at + 3] |= std::byte{0x80};
  content.resize(content.size() + 8);
  EXPECT_EQ(refused<ThimbleSample>(content), RejectReason::Malformed);
}

TEST(ThimbleCodec, NoArmIsAtAFarEndThatIsNot) {
  std::vector<std::byte> content = content_of(least_constraints());
  const std::size_t mask_at = 24 + 8 + 8 + 8 + 8 + 4;
  content[mask_at + 2] = std::byte{0x08};
  content.resize(content.size() + 16);
  EXPECT_EQ(refused<ThimbleConstraints>(content), RejectReason::Malformed);
}

TEST(ThimbleCodec, RefusesHeadersOfOthers) {
  const std::vector<std::byte>& good = golden().at("idle");
  const auto reason_with = [&](std::size_t index, unsigned value) {
    std::vector<std::byte> bytes = good;
    bytes[index] = std::byte(value);
    const auto header = decode_header(bytes);
    return header ? std::nullopt : std::optional(header.error());
  };
  EXPECT_EQ(reason_with(0, 'X'), RejectReason::WrongVersion);
  EXPECT_EQ(reason_with(4, 2), RejectReason::WrongVersion);
  EXPECT_EQ(reason_with(5, 0), RejectReason::WrongVersion);
  EXPECT_EQ(reason_with(5, 18), RejectReason::WrongVersion);
  EXPECT_EQ(reason_with(5, 20), RejectReason::WrongVersion);
  EXPECT_EQ(reason_with(6, 1), RejectReason::WrongVersion);
  EXPECT_EQ(reason_with(7, 2), RejectReason::WrongVersion);
  EXPECT_EQ(reason_with(7, 1), std::nullopt);  // sealed
  EXPECT_EQ(decode_header(std::vector<std::byte>(23)).error(), RejectReason::WrongSize);
  EXPECT_EQ(decode_header(std::vector<std::byte>(1201)).error(), RejectReason::WrongSize);
}

TEST(ThimbleCodec, NeverTakesADatagramOf1999ForItsOwn) {
  std::mt19937 random(5);
  for (int i = 0; i < 1000; ++i) {
    std::vector<std::byte> bytes(i % 2 == 0 ? 12 : 13);
    for (std::byte& byte : bytes) byte = std::byte(random() & 0xFFU);
    bytes[0] = std::byte{'T'}, bytes[1] = std::byte{'H'}, bytes[2] = std::byte{'M'};
    bytes[3] = std::byte{'B'};
    EXPECT_FALSE(is_thimble_datagram(bytes));
  }
  EXPECT_TRUE(is_thimble_datagram(golden().at("hello")));
}

template <class Message, class Spoil>
std::optional<RejectReason> spoiled(Message message, const Spoil& spoil) {
  spoil(message);
  std::array<std::byte, kMaxThimbleContent> out{};
  const Decoded<std::size_t> size = encode(message, out);
  return size ? std::nullopt : std::optional(size.error());
}

TEST(ThimbleCodec, SaysNothingOfAHandThatCannotBe) {
  using S = ThimbleSample;
  const auto reason = [](auto spoil) { return spoiled(full_sample(), spoil); };
  EXPECT_EQ(reason([](S& m) { m.sample.hand.y = kNoNumber; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](S& m) { m.sample.velocity.x = kNoNumber; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](S& m) { m.sample.waves.joule[2] = kNoNumber; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](S& m) { m.sample.impulse.z = kNoNumber; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](S& m) { m.sample.tool.stiffness = {kNoNumber}; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](S& m) { m.sample.energy_joule = kNoNumber; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](S& m) { m.sample.ghost.x = kNoNumber; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](S& m) { m.sample.pull.y = kNoNumber; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](S& m) { m.timing.sent_at = at(-1); }), RejectReason::OutOfRange);
  EXPECT_EQ(reason([](S& m) { m.sample.sampled_at = at(kMaxThimbleTime.count() + 1); }),
            RejectReason::OutOfRange);
}

TEST(ThimbleCodec, SaysOfAHandBeyondTheLimitThatItIsThere) {
  ThimbleSample far = least_sample();
  far.sample.hand = {99, -99, 0};
  ThimbleSample out;
  ASSERT_TRUE(decode(content_of(far), out).has_value());
  EXPECT_EQ(out.sample.hand, (Position3{10, -10, 0}));
}

TEST(ThimbleCodec, RefusesConstraintsThatCannotBe) {
  using C = ThimbleConstraints;
  const auto reason = [](auto spoil) { return spoiled(full_constraints(), spoil); };
  EXPECT_EQ(reason([](C& m) {
              m.set.planes[1].normal = {0, 0.6, 0.6};
            }),
            RejectReason::BadDirection);
  EXPECT_EQ(reason([](C& m) { m.set.planes[1].normal = {}; }), RejectReason::BadDirection);
  EXPECT_EQ(reason([](C& m) { m.set.planes[0].normal.x = kNoNumber; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](C& m) { m.set.planes[0].offset_m = -10.1; }), RejectReason::OutOfRange);
  EXPECT_EQ(reason([](C& m) { m.set.planes[0].surface.friction = kNoNumber; }),
            RejectReason::NonFinite);
  EXPECT_EQ(reason([](C& m) { m.set.planes[1].surface.temperature_kelvin = kNoNumber; }),
            RejectReason::NonFinite);
  EXPECT_EQ(reason([](C& m) { m.set.ghost.z = 11; }), RejectReason::OutOfRange);
  EXPECT_EQ(reason([](C& m) { m.set.far.force.z = kNoNumber; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](C& m) { m.set.far.slave.z = -11; }), RejectReason::OutOfRange);
  EXPECT_EQ(reason([](C& m) { m.set.far.tool.damping = {kNoNumber}; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](C& m) { m.set.pressure.x = kNoNumber; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](C& m) { m.set.energy_joule = kNoNumber; }), RejectReason::NonFinite);
  EXPECT_EQ(reason([](C& m) { m.set.near.lattice.half_cell_m = kNoNumber; }),
            RejectReason::NonFinite);
  EXPECT_EQ(reason([](C& m) { m.set.near.lattice.cells[1] = 1U << 31U; }),
            RejectReason::OutOfRange);
  EXPECT_EQ(reason([](C& m) { m.set.map.ghost_cell.x = (1 << 20) + 1; }), RejectReason::OutOfRange);
  EXPECT_EQ(reason([](C& m) { m.set.near.middle.z = -(1 << 20) - 1; }), RejectReason::OutOfRange);
  // What is not said is not looked at.
  EXPECT_EQ(reason([](C& m) { m.set.has_ghost = false, m.set.ghost.z = kNoNumber; }), std::nullopt);
  EXPECT_EQ(reason([](C& m) { m.set.has_far = false, m.set.far.force.z = kNoNumber; }),
            std::nullopt);
  EXPECT_EQ(reason([](C& m) { m.set.has_pressure = false, m.set.pressure.x = kNoNumber; }),
            std::nullopt);
}

TEST(ThimbleCodec, CarriesAPressureToTheLastBitAndNoneWhereNoneIsSaid) {
  std::mt19937_64 random(463);
  std::uniform_real_distribution<double> newton(-1e6, 1e6);
  for (int i = 0; i < 300; ++i) {
    ThimbleConstraints in = i % 2 == 0 ? least_constraints() : full_constraints();
    in.set.has_pressure = i % 3 != 0;
    in.set.pressure = i < 3 ? Force3{} : Force3{newton(random), newton(random), newton(random)};
    ThimbleConstraints out;
    out.set.has_pressure = true;  // of a message before
    out.set.pressure = {1, 2, 3};
    ASSERT_TRUE(decode(content_of(in), out).has_value());
    EXPECT_EQ(out.set.has_pressure, in.set.has_pressure);
    if (in.set.has_pressure) {
      EXPECT_EQ(out.set.pressure, in.set.pressure);
    }
    ThimbleConstraints without = in;
    without.set.has_pressure = false;
    EXPECT_EQ(content_of(in).size() - content_of(without).size(), in.set.has_pressure ? 24U : 0U);
  }
}

TEST(ThimbleCodec, FitsTheLargestMessagesIntoOneDatagram) {
  ThimbleConstraints set = full_constraints();
  while (set.set.planes.push_back({{0, 1, 0}, 0.1, {{1}, {1}, 1, 300}})) {
  }
  while (set.set.near.boxes.push_back({})) {
  }
  while (set.set.map.blocks.push_back({})) {
  }
  for (const bool is_of_a_map : {false, true}) {  // no scheme has both
    set.set.has_map = is_of_a_map;
    set.set.has_near = !is_of_a_map;
    EXPECT_LE(content_of(set).size(), kMaxThimbleContent);
  }
}

TEST(ThimbleCodec, NamesAreLettersAndThenZeros) {
  const auto reason = [](std::string_view name) {
    ThimbleHello hello = join();
    hello.half.scheme = {};
    std::copy(name.begin(), name.end(), hello.half.scheme.letters.begin());
    return spoiled(hello, [](ThimbleHello&) {});
  };
  EXPECT_EQ(reason("wave"), std::nullopt);
  EXPECT_EQ(reason("abcdefghijklmnopqrstuvwxyz-01234"), std::nullopt);
  EXPECT_EQ(reason("Wave"), RejectReason::Malformed);
  EXPECT_EQ(reason(std::string_view("wa\0ve", 5)), RejectReason::Malformed);
  EXPECT_EQ(reason("../x"), RejectReason::Malformed);
  EXPECT_EQ(ShortName::of("abcdefghijklmnopqrstuvwxyz-0123456789").view().size(), 32U);
}

TEST(ThimbleCodec, WhateverIsTakenFromNoiseSaysTheSameWhenSentAgain) {
  std::mt19937 random(6);
  ThimbleConstraints kept;
  int taken = 0;
  for (int i = 0; i < 20000; ++i) {
    std::vector<std::byte> content = content_of(i % 2 == 0 ? full_constraints() : [] {
      ThimbleConstraints shorter = least_constraints();
      shorter.set.planes.push_back({.normal = {0, 0, 1}, .offset_m = 0.1});
      return shorter;
    }());
    for (int change = 0; change < 2; ++change) {
      content[random() % content.size()] ^= std::byte(1U << (random() % 8));
    }
    ThimbleConstraints out;
    const bool is_taken = decode(content, out).has_value();
    ASSERT_EQ(decode(content, kept).has_value(), is_taken);
    if (!is_taken) continue;
    ++taken;
    const std::vector<std::byte> again = content_of(out);
    ASSERT_EQ(content_of(kept), again) << "whatever it held before";
    ThimbleConstraints twice;
    ASSERT_TRUE(decode(again, twice).has_value());
    ASSERT_EQ(content_of(twice), again);
  }
  EXPECT_GT(taken, 5000);
}

}  // namespace
}  // namespace thimble::link
