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
constexpr std::uint32_t kReadBytes = 128;

// Which rounds are looked at: all of them, or those that next_needed() wants. In slices the model
// goes on between them, too, at random times.
enum class Rounds { Every, Needed, NeededInSlices };

// What a host says to a device, before which round; by chance, the same for the same seed.
struct Words {
  std::uint8_t in{0};
  std::uint8_t out{0};
  std::vector<Bytes> requests;  // of a driver: written whole
  std::vector<std::array<std::uint8_t, 8>> setups;
  unsigned rounds_between{16};
};

// A device on the far end of USB/IP, and a host that always has two reads pending.
class Bus {
 public:
  Bus(plugin::SimUsbModel& model, UsbPersona persona, Words words)
      : model_(&model), persona_(std::move(persona)), words_(std::move(words)) {
    session_.set_available(true);
    EXPECT_TRUE(session_.take(UsbipHost::import()));
    session_.outbox().clear();
    for (const auto& setup : words_.setups) say(host_.control(setup));
    for (int i = 0; i < 2; ++i) read();
  }

  // A line for each answer: in which round, and what.
  std::vector<std::string> run(Rounds rounds) {
    std::mt19937 dice(5);
    std::mt19937 slices(6);
    MonotonicTime needed{};
    for (round_ = 1; round_ <= kRounds; ++round_) {
      // Its clock is set by the first look.
      if (rounds == Rounds::NeededInSlices && looked_at_ > 0) {
        model_->advance(bench_.clock.now() + Duration(slices() % kRound.count()));
      }
      bench_.clock.run_for(kRound);
      if (dice() % words_.rounds_between == 0)
        say(host_.write(words_.out, words_.requests[dice() % words_.requests.size()]));
      if (rounds != Rounds::Every && !std::exchange(has_said_, false) &&
          bench_.clock.now() < needed) {
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
  void say(const Bytes& bytes) {
    has_said_ = true;
    EXPECT_TRUE(session_.take(bytes));
  }
  void read() {
    say(host_.read(words_.in, kReadBytes));
    reads_.insert(host_.seqnum);
  }
  void take_answers() {
    int to_read = 0;
    while (!session_.outbox().empty()) {
      const bool is_read = reads_.contains(UsbipHost::get(session_.outbox(), 4));
      const auto reply = UsbipHost::take_reply(session_.outbox(), is_read);
      ASSERT_TRUE(reply);
      std::string line = std::to_string(round_) + " " + std::to_string(reply->seqnum) + " " +
                         std::to_string(reply->status) + " ";
      line.append(reply->data.begin(), reply->data.end());
      trace_.push_back(line);
      data_bytes_ += reply->data.size();
      to_read += is_read ? 1 : 0;
    }
    for (; to_read > 0; --to_read) read();
  }

  ExportBench bench_;
  plugin::SimUsbModel* model_;
  UsbPersona persona_;
  UsbipSession session_{*model_, persona_, 8, bench_.surroundings()};
  UsbipHost host_;
  Words words_;
  std::set<std::uint32_t> reads_;
  bool has_said_{false};
  int round_{0};
  int looked_at_{0};
  std::size_t data_bytes_{0};
  std::vector<std::string> trace_;
};

Bytes bytes(const std::string& text) { return {text.begin(), text.end()}; }

Bus falcon_bus(FalconArmModel& model) {
  model.load_firmware();
  // Latency of 1 ms, 1.5 Mbaud, eight data bits: requests 9, 3 and 4 of the bridge.
  return {
      model,
      {model.describe(), {}},
      {0x81,
       0x02,
       {bytes("<AAAAAAAAAAAAAA>"), bytes("<DCBAPPPPAAABAA>"), bytes("<A>"),
        bytes(std::string(100, '<'))},
       {{0x40, 9, 1, 0, 0, 0, 0, 0}, {0x40, 3, 2, 0, 0, 0, 0, 0}, {0x40, 4, 8, 0, 0, 0, 0, 0}}}};
}

Bus text_bus(AcmOnUsb& device) {
  return {device,
          device.persona(device.describe()),
          {AcmOnUsb::kIn,
           AcmOnUsb::kOut,
           {bytes("[10,20,30]"), bytes("[1,2"), bytes(",3]\n"), bytes(std::string(60, 'x'))},
           {}}};
}

Bus board_bus(cam::CamUsbModel& model) {
  using cambus::usb::Kind;
  const auto ask = [](Kind kind, std::uint16_t number, std::uint16_t words) {
    return cambus::usb_request({kind, {}, number, words, 0}, {});
  };
  // By chance in order, or refused. What is read is its page, on which its beat goes on.
  return {model,
          {model.describe(), {}},
          {cambus::usb::kReplies,
           cambus::usb::kRequests,
           {ask(Kind::Begin, 1, 0), ask(Kind::Read, 2, 64), ask(Kind::Read, 3, 1000), bytes("?")},
           {}}};
}

TEST(LeftOutRounds, ChangeNothingOfAFalcon) {
  FalconArmModel one(falcon_parameters());
  FalconArmModel other(falcon_parameters());
  FalconArmModel third(falcon_parameters());
  Bus every = falcon_bus(one);
  Bus needed = falcon_bus(other);
  Bus sliced = falcon_bus(third);
  const auto expected = every.run(Rounds::Every);
  EXPECT_EQ(needed.run(Rounds::Needed), expected);
  EXPECT_EQ(sliced.run(Rounds::NeededInSlices), expected);
  EXPECT_GT(every.data_bytes(), 1000U);
  EXPECT_EQ(every.looked_at(), kRounds);
  EXPECT_LT(needed.looked_at(), kRounds / 2);
}

// In its monitor: what is said at 9600 baud takes a millisecond a byte, and more of it than a
// packet holds may come back at once.
TEST(LeftOutRounds, ChangeNothingOfABootLoader) {
  const auto bus_of = [](FalconArmModel& model) {
    return Bus(model, {model.describe(), {}},
               {0x81,
                0x02,
                {{0x0a, 0x43, 0x0d}, {0x0a, 0x43}, {0x0d}, Bytes(63, 0x0a)},
                {{0x40, 9, 16, 0, 0, 0, 0, 0},
                 {0x40, 3, 0x38, 0x41, 0, 0, 0, 0},
                 {0x40, 4, 8, 0, 0, 0, 0, 0},
                 {0x40, 1, 0, 3, 0, 0, 0, 0},
                 {0x40, 1, 1, 1, 0, 0, 0, 0}},
                256});
  };
  FalconArmModel one(falcon_parameters());
  FalconArmModel other(falcon_parameters());
  Bus every = bus_of(one);
  Bus needed = bus_of(other);
  EXPECT_EQ(needed.run(Rounds::Needed), every.run(Rounds::Every));
  EXPECT_GT(one.processor().counters().questions, 10U);
  EXPECT_GT(every.data_bytes(), 100U);
}

TEST(LeftOutRounds, ChangeNothingOfAnArmWithTheTextProtocol) {
  TextArmModel one(phantom_vintage_parameters(), {.full_scale_a = 3});
  TextArmModel other(phantom_vintage_parameters(), {.full_scale_a = 3});
  TextArmModel third(phantom_vintage_parameters(), {.full_scale_a = 3});
  AcmOnUsb one_device(one);
  AcmOnUsb other_device(other);
  AcmOnUsb third_device(third);
  Bus every = text_bus(one_device);
  Bus needed = text_bus(other_device);
  Bus sliced = text_bus(third_device);
  const auto expected = every.run(Rounds::Every);
  EXPECT_EQ(needed.run(Rounds::Needed), expected);
  EXPECT_EQ(sliced.run(Rounds::NeededInSlices), expected);
  EXPECT_GT(every.data_bytes(), 1000U);
  EXPECT_LT(needed.looked_at(), kRounds / 2);
}

TEST(LeftOutRounds, ChangeNothingOfABoardOnUsb) {
  const cam::BoardOptions options{.shape = {{1, 1, 1}, 6}, .window_bytes = 0x20000};
  cam::CamUsbModel one(options);
  cam::CamUsbModel other(options);
  cam::CamUsbModel third(options);
  Bus every = board_bus(one);
  Bus needed = board_bus(other);
  Bus sliced = board_bus(third);
  const auto expected = every.run(Rounds::Every);
  EXPECT_EQ(needed.run(Rounds::Needed), expected);
  EXPECT_EQ(sliced.run(Rounds::NeededInSlices), expected);
  EXPECT_GT(one.counters().carried_out, 50U);
  EXPECT_GT(one.counters().out_of_order, 100U);
  EXPECT_LT(needed.looked_at(), kRounds / 2);
}

}  // namespace
}  // namespace thimble::sim
