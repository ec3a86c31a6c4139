#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <random>
#include <string>

#include "drivers/cambus/board.hpp"
#include "drivers/cambus/cambus_page_wire.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "drivers/cambus/usb_port.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/model/cam/usb_frames.hpp"
#include "tests/contract/cam_board_oracle.hpp"
#include "tests/support/usb_cam_board.hpp"

// Programs that are given up while they are on their way.
namespace thimble::cambus {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kPacket = usb::kFullSpeedPacketBytes;

// Claims a window of 4 GB, takes 40 ms for each write and does none: never silent, never done.
class SlowBoard final : public bus::UsbDevice {
 public:
  explicit SlowBoard(const Clock& clock) : clock_(clock) {
    words_[page::kMagic] = page::kMagicValue;
    words_[page::kVersion] = page::kVersionValue;
    words_[page::kWindowOffset] = page::kPageBytes;
    words_[page::kWindowBytes] = 0xffff0000;
    words_[page::kShape] = 0x010101 | 18U << 24;
    words_[page::kClockHz] = 25'000'000;
    words_[page::kIncarnation] = 1;
    words_[page::kRead] = page::kIsWaiting;
  }
  IoStatus read(std::uint8_t /*endpoint*/, bus::UsbPacket& out) noexcept override {
    if (replies_.transfers() == 0) answer_one();
    const auto size = replies_.next(out.bytes);
    if (!size) return IoStatus::NoData;
    out.size = *size;
    out.sequence = ++in_;
    out.arrived_at = clock_.now();
    return IoStatus::Ok;
  }
  IoStatus submit(std::uint8_t /*endpoint*/,
                  std::span<const std::uint8_t> packet) noexcept override {
    if (!requests_.take(packet)) return IoStatus::Ok;
    auto request = sim::cam::parse_usb_request(requests_.transfer());
    if (!request) return IoStatus::Ok;
    if (request->kind == usb::Kind::Begin) {
      waiting_.clear();
      replies_.add(sim::cam::make_usb_reply(*request, usb::Status::Done, {}));
    } else {
      waiting_.push_back(*std::move(request));
    }
    return IoStatus::Ok;
  }
  IoStatus start_control(const bus::UsbControlRequest& /*request*/) noexcept override {
    return IoStatus::Ok;
  }
  IoStatus read_control(bus::UsbControlReply& /*out*/) noexcept override {
    return IoStatus::NoData;
  }
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t /*endpoint*/) const noexcept override {
    return {};
  }

 private:
  void answer_one() {
    if (waiting_.empty() || clock_.now() < next_) return;
    const sim::cam::UsbRequest request = std::move(waiting_.front());
    waiting_.pop_front();
    std::vector<std::uint32_t> payload;
    if (request.kind == usb::Kind::Read) {
      ++words_[page::kBeat];
      for (std::uint32_t i = 0; i < request.words; ++i) {
        payload.push_back(words_[request.offset + 4 * i]);
      }
    } else {
      next_ = clock_.now() + milliseconds(40);
    }
    replies_.add(sim::cam::make_usb_reply(request, usb::Status::Done, payload));
  }

  const Clock& clock_;
  std::map<std::uint32_t, std::uint32_t> words_;
  sim::cam::PacketCollector requests_{kPacket};
  sim::cam::PacketFeeder replies_{kPacket};
  std::deque<sim::cam::UsbRequest> waiting_;
  MonotonicTime next_{};
  std::uint64_t in_{0};
};

// Until it fails or says something.
Result<CamAnswer> play(Board& board, const CamSteps& steps, sim::VirtualClock& clock,
                       Duration at_most) {
  const auto started = board.start(steps, at_most, clock.now());
  if (!started) return tl::unexpected(started.error());
  while (true) {
    auto answer = board.poll(clock.now());
    if (!answer) return tl::unexpected(answer.error());
    if (*answer) return **std::move(answer);
    clock.run_for(microseconds(500));
  }
}

TEST(ASlowBoard, IsNotSentWhatWasGivenUp) {
  sim::VirtualClock clock;
  UsbBoardMatch match;
  match.packet_bytes = kPacket;
  const auto sut = test::wait_for_board({std::make_unique<SlowBoard>(clock), match}, clock).value();
  const std::vector<std::uint8_t> list(500'000);
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(sut->put(0, list), IoStatus::Ok) << i;
    EXPECT_EQ(sut->put(0, list), IoStatus::Backlogged)
        << "one at a time, whatever it says it holds";
    for (int turn = 0; turn < 400; ++turn) {
      BoardStatus status;
      clock.run_for(microseconds(500));
      ASSERT_NE(sut->poll(clock.now(), status), IoStatus::Disconnected);
    }
    EXPECT_GT(sut->unwritten_bytes(), list.size() / 2) << "it is that slow";
    sut->drop_unsent();
    EXPECT_GT(sut->unwritten_bytes(), 0U) << "what it may have had stays";
    EXPECT_LE(sut->unwritten_bytes(), UsbPort::kMostLeftBytes);
  }
}

// A board on one way or the other, with nothing of its inside to be seen.
struct Way {
  const char* name;
  bool is_usb;
  bool is_paced;
  friend void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }
};

class AProgramThatIsGivenUp : public testing::TestWithParam<Way> {
 protected:
  static constexpr CamGeometry kSpace{{3, 3, 1}, CamDivision::StripY};

  std::unique_ptr<BoardPort> open() {
    const sim::cam::BoardOptions options{.shape = {{2, 1, 1}, 6},
                                         .window_bytes = std::size_t{1} << 20,
                                         .is_paced = GetParam().is_paced};
    if (GetParam().is_usb) {
      return test::open_usb_port(plug_.emplace(clock_, options), clock_);
    }
    return PciPort::open(slot_.emplace(clock_, options).open_window(), clock_.now()).value();
  }

  std::mt19937 random_{7};
  sim::VirtualClock clock_;
  std::optional<sim::cam::SimCamBoard> slot_;
  std::optional<sim::cam::SimUsbCamBoard> plug_;
};
INSTANTIATE_TEST_SUITE_P(Ways, AProgramThatIsGivenUp,
                         testing::Values(Way{"FreeOverPci", false, false},
                                         Way{"PacedOverPci", false, true},
                                         Way{"FreeOverUsb", true, false},
                                         Way{"PacedOverUsb", true, true}),
                         [](const auto& way) { return std::string(way.param.name); });

// Wherever it was: in the middle of a transfer, with a doorbell that has not left, or while the
// board plays it.
TEST_P(AProgramThatIsGivenUp, DoesNotSpoilTheNext) {
  Board sut(open());
  int given_up = 0;
  for (int i = 0; i < 60; ++i) {
    test::CamBoardOracle oracle(kSpace);
    ASSERT_TRUE(sut.lay_out(kSpace));
    // Short ones, too, whose steps do not lie where those of the next lie.
    const Duration soon = microseconds(random_() % 6'000);
    const bool is_short = random_() % 2 == 0;
    CamSteps left = is_short ? test::random_steps(random_, kSpace) : oracle.first_program(random_);
    left.emplace_back(cam_step::Run{{.is_scan = false, .takes_counts = true}});
    if (!play(sut, left, clock_, soon)) ++given_up;
    oracle = test::CamBoardOracle(kSpace);
    ASSERT_TRUE(sut.lay_out(kSpace));
    const auto first = play(sut, oracle.first_program(random_), clock_, seconds(2));
    ASSERT_TRUE(first) << first.error().message << ' ' << i;
    const CamSteps steps = test::random_steps(random_, kSpace);
    const auto answer = play(sut, steps, clock_, seconds(2));
    ASSERT_TRUE(answer) << answer.error().message << ' ' << i;
    const CamAnswer expected = oracle.play(steps);
    ASSERT_EQ(answer->counts, expected.counts) << i;
    ASSERT_EQ(answer->cells, expected.cells) << i;
  }
  const bool takes_time = GetParam().is_usb || GetParam().is_paced;
  EXPECT_GT(given_up, takes_time ? 15 : -1);
  EXPECT_EQ(plug_ ? plug_->model().counters().malformed : 0, 0U);
}

}  // namespace
}  // namespace thimble::cambus
