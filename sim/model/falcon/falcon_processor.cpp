#include "sim/model/falcon/falcon_processor.hpp"

namespace thimble::sim {
namespace {

// Of arms.md 1.3 and 1.4, read here anew and not from the driver's facts.
constexpr std::array<std::uint8_t, 3> kQuestion{0x0a, 0x43, 0x0d};
constexpr std::array<std::uint8_t, 4> kAnswer{0x0a, 0x44, 0x2c, 0x0d};
constexpr std::uint8_t kMark = 0x41;
constexpr double kMonitor_baud = 9600;
constexpr double kLoad_baud = 3e6 / 21;
constexpr double kRun_baud = 1.5e6;

}  // namespace

void FalconProcessor::power_up() noexcept {
  state_ = State::Deaf;
  is_dtr_high_ = false;
  is_rts_high_ = false;
  sender_.forget_all();
}

void FalconProcessor::start_firmware() noexcept {
  state_ = State::Starting;
  ready_at_ = {};
}

double FalconProcessor::listens_at_baud() const noexcept {
  if (state_ == State::Monitor) return kMonitor_baud;
  return state_ == State::Running ? kRun_baud : kLoad_baud;
}

void FalconProcessor::reset(MonotonicTime t) noexcept {
  ++counters_.resets;
  state_ = State::Monitor;
  has_answered_ = false;
  question_bytes_ = 0;
  ready_at_ = t + kListensAfter;
  sender_.forget_all();
  sender_.set_speed(kMonitor_baud);
}

void FalconProcessor::set_lines(MonotonicTime t, bool is_dtr_high, bool is_rts_high) noexcept {
  const bool rises = is_dtr_high && !is_dtr_high_;
  const bool falls = !is_dtr_high && is_dtr_high_;
  is_dtr_high_ = is_dtr_high;
  is_rts_high_ = is_rts_high;
  if (rises) return reset(t);
  if (falls && state_ == State::Monitor) state_ = has_answered_ ? State::BootRom : State::Deaf;
}

void FalconProcessor::receive(MonotonicTime t, SerialByte byte, const CrankCounts& now) noexcept {
  if (state_ == State::Starting && t >= ready_at_) begin_to_run(now);
  const ReceivedByte received = receive_at(byte, listens_at_baud());
  if (!received.has_stop_bit) {
    ++counters_.garbage_bytes;
    question_bytes_ = 0;
    return;
  }
  switch (state_) {
    case State::Monitor:
      return hear_question(t, received.value);
    case State::BootRom:
    case State::Loading:
      return load(t, received.value);
    case State::Running:
      for (const std::uint8_t out : firmware_.take(received.value, now)) sender_.push(t, out);
      return;
    case State::Deaf:
    case State::Stuck:
    case State::Starting:
      ++counters_.ignored_bytes;
      return;
  }
}

void FalconProcessor::hear_question(MonotonicTime t, std::uint8_t byte) noexcept {
  if (t < ready_at_ || is_rts_high_) {
    ++counters_.ignored_bytes;
    return;
  }
  // None of its bytes occurs twice, so a wrong one can only be the first of a new question.
  if (byte != kQuestion[question_bytes_]) question_bytes_ = 0;
  if (byte == kQuestion[question_bytes_]) ++question_bytes_;
  if (question_bytes_ < kQuestion.size()) return;
  question_bytes_ = 0;
  ++counters_.questions;
  if (faults_.deaf_questions > 0) {
    --faults_.deaf_questions;
    return;
  }
  has_answered_ = true;
  for (const std::uint8_t out : kAnswer) sender_.push(t, out);
}

void FalconProcessor::load(MonotonicTime t, std::uint8_t byte) noexcept {
  sender_.set_speed(kLoad_baud);
  if (state_ == State::BootRom) {
    if (byte != kMark) {
      ++counters_.ignored_bytes;
      return;
    }
    ++counters_.uploads;
    stream_ = {};
    state_ = State::Loading;
    sender_.push(t, byte);
    return;
  }
  stream_.take(byte);
  if (stream_.state() == BootStream::State::Refused) {
    state_ = State::Stuck;
    return;
  }
  if (faults_.lost_echo == stream_.bytes() - 1) {
    faults_.lost_echo.reset();
  } else {
    sender_.push(t, byte);
  }
  if (stream_.state() != BootStream::State::Complete) return;
  state_ = State::Starting;
  ready_at_ = t + kRunsAfter;
}

void FalconProcessor::begin_to_run(const CrankCounts& now) noexcept {
  ++counters_.starts;
  state_ = State::Running;
  sender_.forget_all();
  sender_.set_speed(kRun_baud);
  firmware_.start(now);
}

// The monitor's answer is a byte longer than its question, of which two bytes may have been heard;
// the firmware's as long as a request, of which one may lack a byte and one reply may be held back.
// All else echoes a byte at most.
std::size_t FalconProcessor::most_to_arrive(std::size_t heard) const noexcept {
  std::size_t answers = heard;
  if (state_ == State::Monitor) answers = (heard + 2) / kQuestion.size() * kAnswer.size();
  // It may begin to run before they are heard.
  if (state_ == State::Starting || state_ == State::Running) {
    answers = firmware_.most_reply_bytes(heard);
  }
  return sender_.under_way() + answers;
}

std::array<int, 3> FalconProcessor::motor_counts() const noexcept {
  return state_ == State::Running ? firmware_.motor_counts() : std::array<int, 3>{};
}

}  // namespace thimble::sim
