#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>
#include <vector>

#include "drivers/cambus/usb_frame.hpp"
#include "sim/export/acm_on_usb.hpp"
#include "sim/export/usbip_session.hpp"
#include "sim/model/arm/register_arm_models.hpp"
#include "sim/model/arm/text_arm_model.hpp"
#include "sim/model/cam/cam_usb_model.hpp"
#include "sim/model/falcon/falcon_arm_model.hpp"
#include "sim/model/falcon/falcon_parameters.hpp"
#include "tests/unit/export/export_bench.hpp"
#include "tests/unit/export/usbip_host.hpp"

namespace thimble::sim {
namespace {

using Bytes = UsbipHost::Bytes;

constexpr int kRounds = 16'000;  // two seconds
constexpr Duration kRound{125'000};
constexpr std::uint8_t kNowhere = 0x8f;

// Which rounds are looked at: all of them, or those that next_needed() wants. In slices the model
// goes on between them, too, at random times.
enum class Rounds { Every, Needed, NeededInSlices };

using Setup = std::array<std::uint8_t, 8>;

// Before that round, once.
struct Opening {
  int round{0};
  std::vector<Setup> setups;
  Bytes request;
};

// What a host says to a device: `opening` first, and from its last round on by chance, the same for
// the same seed.
struct Words {
  std::uint8_t in{0};
  std::uint8_t out{0};
  std::vector<Bytes> requests;  // of a driver: written whole
  std::vector<Opening> opening;
  unsigned rounds_between{16};
  // A host's reads: their size, and how many rounds lie before the next one in the mean.
  std::uint32_t read_bytes{128};
  unsigned rounds_to_read{1};
  bool asks_in_vain{false};  // now and then, besides
};

// A device on the far end of USB/IP, and a host that reads two at a time. As UsbipBus it hears what
// the host says at once, and looks in a round only if that is one that matters.
class Bus {
 public:
  Bus(plugin::SimUsbModel& model, UsbPersona persona, Words words)
      : model_(&model), persona_(std::move(persona)), words_(std::move(words)) {
    session_.set_available(true);
    EXPECT_TRUE(session_.take(UsbipHost::import()));
    session_.outbox().clear();
  }

  // A line for each answer: in which round, and what.
  std::vector<std::string> run(Rounds rounds) {
    std::mt19937 dice(5);
    std::mt19937 slices(6);
    MonotonicTime needed{};
    for (round_ = 1; round_ <= kRounds; ++round_) {
      speak(dice);
      needed = std::min(needed, session_.next_needed(bench_.clock.now()));
      // Its clock is set by the first look.
      if (rounds == Rounds::NeededInSlices && looked_at_ > 0) {
        model_->advance(bench_.clock.now() + Duration(slices() % kRound.count()));
      }
      bench_.clock.run_for(kRound);
      if (rounds != Rounds::Every && bench_.clock.now() < needed) {
        session_.leave_round_out();
        continue;
      }
      ++looked_at_;
      model_->advance(bench_.clock.now());
      session_.serve(bench_.clock.now());
      take_answers();
      needed = session_.next_needed(bench_.clock.now());
    }
    return std::move(trace_);
  }
  [[nodiscard]] int looked_at() const { return looked_at_; }
  [[nodiscard]] std::size_t data_bytes() const { return data_bytes_; }

 private:
  void say(const Bytes& bytes) { EXPECT_TRUE(session_.take(bytes)); }
  // The same dice are thrown in every round, whatever is looked at.
  void speak(std::mt19937& dice) {
    for (const Opening& opening : words_.opening) {
      if (opening.round != round_) continue;
      for (const Setup& setup : opening.setups) say(host_.control(setup));
      if (!opening.request.empty()) say(host_.write(words_.out, opening.request));
    }
    const bool is_open = words_.opening.empty() || words_.opening.back().round < round_;
    const bool writes = dice() % words_.rounds_between == 0 && is_open;
    const auto which = dice() % words_.requests.size();
    const bool reads = dice() % words_.rounds_to_read == 0;
    if (writes) say(host_.write(words_.out, words_.requests[which]));
    const auto in_vain = dice() % 40;
    if (words_.asks_in_vain && in_vain < 2) {
      say(in_vain == 0 ? host_.read(words_.in, 0) : host_.read(kNowhere, words_.read_bytes));
      in_vain_.insert(host_.seqnum);
    }
    for (; reads && to_read_ > 0; --to_read_) {
      say(host_.read(words_.in, words_.read_bytes));
      reads_.insert(host_.seqnum);
    }
  }
  void take_answers() {
    while (!session_.outbox().empty()) {
      const auto seqnum = UsbipHost::get(session_.outbox(), 4);
      const bool is_read = reads_.contains(seqnum);
      const auto reply =
          UsbipHost::take_reply(session_.outbox(), is_read || in_vain_.contains(seqnum));
      ASSERT_TRUE(reply);
      std::string line = std::to_string(round_) + " " + std::to_string(reply->seqnum) + " " +
                         std::to_string(reply->status) + " ";
      line.append(reply->data.begin(), reply->data.end());
      trace_.push_back(line);
      data_bytes_ += reply->data.size();
      to_read_ += is_read ? 1 : 0;
    }
  }

  ExportBench bench_;
  plugin::SimUsbModel* model_;
  UsbPersona persona_;
  UsbipSession session_{*model_, persona_, 8, bench_.surroundings()};
  UsbipHost host_;
  Words words_;
  std::set<std::uint32_t> reads_;
  std::set<std::uint32_t> in_vain_;
  int to_read_{2};
  int round_{0};
  int looked_at_{0};
  std::size_t data_bytes_{0};
  std::vector<std::string> trace_;
};

Bytes bytes(const std::string& text) { return {text.begin(), text.end()}; }

// The bridge's requests that are needed; of an FTDI chip, ftdi_sio.h of Linux.
Setup latency_ms(std::uint8_t ms) { return {0x40, 9, ms, 0, 0, 0, 0, 0}; }
Setup baud_divisor(std::uint16_t divisor) {
  return {0x40, 3, static_cast<std::uint8_t>(divisor), static_cast<std::uint8_t>(divisor >> 8U)};
}
Setup modem_lines(std::uint8_t levels, std::uint8_t meant) { return {0x40, 1, levels, meant}; }
constexpr Setup kEightDataBits{0x40, 4, 8, 0, 0, 0, 0, 0};
constexpr std::uint16_t k9600Baud = 0x4138;
constexpr std::uint16_t k142857Baud = 21;
constexpr std::uint16_t k1500000Baud = 2;
const Bytes kQuestion{0x0a, 0x43, 0x0d};

Words falcon_words() {
  return {0x81,
          0x02,
          {bytes("<AAAAAAAAAAAAAA>"), bytes("<DCBAPPPPAAABAA>"), bytes("<A>"),
           bytes(std::string(100, '<'))},
          {{1, {latency_ms(1), baud_divisor(k1500000Baud), kEightDataBits}, {}}}};
}

Bus falcon_bus(FalconArmModel& model, Words words) {
  return {model, {model.describe(), {}}, std::move(words)};
}

// What looking in every round makes of it, which the others have to make, too, and in how many
// rounds they looked.
struct Trial {
  std::vector<std::string> trace;
  int looked_at{0};
  std::size_t data_bytes{0};
};

Trial try_out(Bus bus, Rounds rounds) {
  Trial trial{bus.run(rounds), bus.looked_at(), bus.data_bytes()};
  return trial;
}

// `trial`: with a model of its own for each. Returns that with the rounds that are needed.
template <class MakeTrial>
Trial compare(const MakeTrial& trial) {
  const Trial every = trial(Rounds::Every);
  Trial needed = trial(Rounds::Needed);
  EXPECT_EQ(every.looked_at, kRounds);
  EXPECT_EQ(needed.trace, every.trace);
  EXPECT_EQ(trial(Rounds::NeededInSlices).trace, every.trace);
  return needed;
}

Trial compare_falcons(const Words& words) {
  return compare([&](Rounds rounds) {
    FalconArmModel model(falcon_parameters());
    model.load_firmware();
    return try_out(falcon_bus(model, words), rounds);
  });
}

struct BootTrial {
  Trial trial;
  FalconProcessorCounters counters;
};
BootTrial compare_boot_loaders(const Words& words) {
  BootTrial of;
  of.trial = compare([&](Rounds rounds) {
    FalconArmModel model(falcon_parameters());
    Trial trial = try_out(falcon_bus(model, words), rounds);
    of.counters = model.processor().counters();
    return trial;
  });
  return of;
}

Bus text_bus(AcmOnUsb& device, unsigned rounds_to_read) {
  return {device,
          device.persona(device.describe()),
          {.in = AcmOnUsb::kIn,
           .out = AcmOnUsb::kOut,
           .requests = {bytes("[10,20,30]"), bytes("[1,2"), bytes(",3]\n"),
                        bytes(std::string(60, 'x'))},
           .opening = {},
           .rounds_to_read = rounds_to_read}};
}

Bus board_bus(cam::CamUsbModel& model, unsigned rounds_to_read) {
  using cambus::usb::Kind;
  const auto ask = [](Kind kind, std::uint16_t number, std::uint16_t words) {
    return cambus::usb_request({kind, {}, number, words, 0}, {});
  };
  // By chance in order, or refused. What is read is its page, on which its beat goes on.
  return {model,
          {model.describe(), {}},
          {.in = cambus::usb::kReplies,
           .out = cambus::usb::kRequests,
           .requests = {ask(Kind::Begin, 1, 0), ask(Kind::Read, 2, 64), ask(Kind::Read, 3, 1000),
                        bytes("?")},
           .opening = {},
           .rounds_to_read = rounds_to_read}};
}

TEST(LeftOutRounds, ChangeNothingOfAFalcon) {
  const Trial needed = compare_falcons(falcon_words());
  EXPECT_GT(needed.data_bytes, 1000U);
  EXPECT_LT(needed.looked_at, kRounds * 3 / 8);
}

// A packet waits longer than its bytes take, or is full before, or nobody asks for it for long.
TEST(LeftOutRounds, ChangeNothingOfAFalconThatIsReadSeldomOrLate) {
  for (const std::uint8_t latency : {std::uint8_t{2}, std::uint8_t{16}}) {
    for (const unsigned rounds_to_read : {5U, 60U}) {
      Words words = falcon_words();
      words.opening[0].setups[0] = latency_ms(latency);
      words.rounds_to_read = rounds_to_read;
      const Trial needed = compare_falcons(words);
      EXPECT_GT(needed.data_bytes, 1000U);
      EXPECT_LT(needed.looked_at, kRounds * 5 / 16) << int{latency} << ", " << rounds_to_read;
    }
  }
}

// In its monitor: what is said at 9600 baud takes a millisecond a byte, and more of it than a
// packet holds may come back at once.
TEST(LeftOutRounds, ChangeNothingOfABootLoader) {
  const Words words{
      0x81,
      0x02,
      {kQuestion, {0x0a, 0x43}, {0x0d}, Bytes(63, 0x0a)},
      {{1, {latency_ms(16), baud_divisor(k9600Baud), kEightDataBits, modem_lines(0, 3)}, {}},
       {2, {modem_lines(1, 1)}, {}}},
      256};
  const BootTrial of = compare_boot_loaders(words);
  EXPECT_GT(of.counters.questions, 10U);
  EXPECT_LT(of.trial.looked_at, kRounds * 5 / 16);
}

// Its echoes fill packets before the latency timer runs out.
TEST(LeftOutRounds, ChangeNothingOfAnUpload) {
  Bytes head{0xaa, 0x08};
  head.resize(22);                                    // reserved words and the entry point
  head.insert(head.end(), {0xff, 0xff, 0, 0, 0, 0});  // one block, longer than all that comes
  const Words words{
      0x81,
      0x02,
      {Bytes(64, 0x33), Bytes(62, 0x44), Bytes(1, 0x55), Bytes(130, 0x66)},
      {{1, {latency_ms(16), baud_divisor(k9600Baud), kEightDataBits, modem_lines(0, 3)}, {}},
       {2, {modem_lines(1, 1)}, {}},
       {200, {}, kQuestion},
       {400, {modem_lines(0, 1), baud_divisor(k142857Baud)}, {}},
       {410, {}, {0x41}},
       {500, {}, head}},
      48};
  const BootTrial of = compare_boot_loaders(words);
  EXPECT_EQ(of.counters.uploads, 1U);
  EXPECT_EQ(of.counters.garbage_bytes + of.counters.ignored_bytes, 0U);
  EXPECT_GT(of.trial.data_bytes, 10'000U);
  EXPECT_LT(of.trial.looked_at, kRounds * 13 / 16);
}

// A host that asks for nothing, or where nothing is, is answered in the next round whatever the
// device has.
TEST(LeftOutRounds, DoNotPutOffAReadThatWaitsForNothing) {
  Words words = falcon_words();
  words.opening[0].setups[0] = latency_ms(16);
  words.rounds_between = 500;
  words.asks_in_vain = true;
  const Trial needed = compare_falcons(words);
  EXPECT_GT(needed.trace.size(), 900U);
  EXPECT_LT(needed.looked_at, kRounds / 4);
}

TEST(LeftOutRounds, ChangeNothingOfAnArmWithTheTextProtocol) {
  for (const unsigned rounds_to_read : {1U, 30U}) {
    const Trial needed = compare([&](Rounds rounds) {
      TextArmModel model(phantom_vintage_parameters(), {.full_scale_a = 3});
      AcmOnUsb device(model);
      return try_out(text_bus(device, rounds_to_read), rounds);
    });
    EXPECT_GT(needed.data_bytes, 1000U);
    EXPECT_LT(needed.looked_at, kRounds / 2);
  }
}

TEST(LeftOutRounds, ChangeNothingOfABoardOnUsb) {
  const cam::BoardOptions options{.shape = {{1, 1, 1}, 6}, .window_bytes = 0x20000};
  for (const unsigned rounds_to_read : {1U, 30U}) {
    const Trial needed = compare([&](Rounds rounds) {
      cam::CamUsbModel model(options);
      Trial trial = try_out(board_bus(model, rounds_to_read), rounds);
      EXPECT_GT(model.counters().carried_out, 50U);
      EXPECT_GT(model.counters().out_of_order, 100U);
      return trial;
    });
    EXPECT_LT(needed.looked_at, kRounds / 2);
  }
}

}  // namespace
}  // namespace thimble::sim
