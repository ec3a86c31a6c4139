#include "drivers/falcon/boot_sequence.hpp"

#include <algorithm>

namespace thimble::falcon {
namespace {

struct Setting {
  std::uint8_t request;
  std::uint16_t value;
};

constexpr std::array<Setting, 9> kAskSettings{{
    {wire::kRequestReset, wire::kPurgeRx},
    {wire::kRequestReset, wire::kPurgeTx},
    {wire::kRequestLatencyTimer, wire::kLatencyBoot_ms},
    {wire::kRequestBaudDivisor, wire::kDivisor9600},
    {wire::kRequestLineFormat, wire::kLine8n1},
    {wire::kRequestFlowControl, wire::kFlowOff},
    {wire::kRequestModemLines, wire::kRtsLow},
    {wire::kRequestModemLines, wire::kDtrLow},
    {wire::kRequestModemLines, wire::kDtrHigh},
}};
constexpr std::array<Setting, 2> kMarkSettings{{
    {wire::kRequestModemLines, wire::kDtrLow},
    {wire::kRequestBaudDivisor, wire::kDivisorUpload},
}};
constexpr std::array<Setting, 4> kRunSettings{{
    {wire::kRequestLatencyTimer, wire::kLatencyRun_ms},
    {wire::kRequestBaudDivisor, wire::kDivisorRun},
    {wire::kRequestReset, wire::kPurgeRx},
    {wire::kRequestReset, wire::kPurgeTx},
}};

// What a stage sets in the bridge before it says anything.
std::span<const Setting> settings_of(BootStage stage) noexcept {
  switch (stage) {
    case BootStage::Detecting:
    case BootStage::Starting:
      return kRunSettings;
    case BootStage::Asking:
      return kAskSettings;
    case BootStage::Marking:
      return kMarkSettings;
    default:
      return {};
  }
}

// A command that moves nothing. The flags are there to be known again: what comes back unchanged is
// an echo, as a boot-loader's in the middle of an upload, and no answer of a firmware.
constexpr RunCommand kKnock{.is_homing = true, .lights = {.is_red = true}};
constexpr unsigned kKnockFlags = wire::kHomingOn | wire::kLedRed;

bool is_echo_of_knock(const RunReport& report) noexcept {
  return report.encoder_counts == std::array<std::int16_t, 3>{} && report.homed == 0 &&
         report.buttons == kKnockFlags;
}

BootOrder order_of(std::span<const std::uint8_t> bytes) noexcept {
  BootOrder order;
  order.kind = BootOrder::Kind::Packet;
  order.size = std::min(bytes.size(), order.bytes.size());
  std::copy_n(bytes.begin(), order.size, order.bytes.begin());
  return order;
}

}  // namespace

void BootSequence::on_packet(std::span<const std::uint8_t> serial, MonotonicTime at) noexcept {
  now_ = std::max(now_, at);
  if (is_request_open_ && !request_deadline_) request_deadline_ = now_ + kRequestPatience;
  for (const std::uint8_t byte : serial) on_byte(byte);
}

void BootSequence::restart() noexcept {
  const MonotonicTime now = now_;
  *this = BootSequence(image_);
  now_ = knock_at_ = now;
}

void BootSequence::find_again() noexcept {
  restart();
  requests_done_ = settings_of(stage_).size();
  is_search_ = true;
}

// While the bridge is being set, what comes is from before.
void BootSequence::on_byte(std::uint8_t byte) noexcept {
  if (is_being_set()) return;
  if (wants_to_talk_) {
    // More echo than there was to echo: the two ends are not at the same place.
    if (stage_ == BootStage::Uploading) fail_upload(BootTrouble::EchoWrong);
    return;
  }
  switch (stage_) {
    case BootStage::Asking:
      return on_boot_answer(byte);
    case BootStage::Marking:
      // A late answer to an earlier question may come before it.
      if (byte == wire::kUploadMark) enter(BootStage::Uploading);
      return;
    case BootStage::Uploading:
      return on_echo(byte);
    case BootStage::Detecting:
    case BootStage::Starting:
      return on_run_byte(byte);
    case BootStage::Running:
    case BootStage::Resting:
      return;
  }
}

// Whatever comes before the answer is passed over: a byte of zero was seen on some hosts.
void BootSequence::on_boot_answer(std::uint8_t byte) noexcept {
  if (byte != wire::kBootAnswer[matched_bytes_]) matched_bytes_ = 0;
  if (byte == wire::kBootAnswer[matched_bytes_]) ++matched_bytes_;
  if (matched_bytes_ == wire::kBootAnswer.size()) enter(BootStage::Marking);
}

void BootSequence::on_echo(std::uint8_t byte) noexcept {
  if (byte != image_[sent_bytes_ + echoed_bytes_]) return fail_upload(BootTrouble::EchoWrong);
  ++echoed_bytes_;
  if (echoed_bytes_ < chunk_bytes()) return;
  sent_bytes_ += echoed_bytes_;
  echoed_bytes_ = 0;
  wants_to_talk_ = true;
  if (sent_bytes_ == image_.size()) enter(BootStage::Starting);
}

void BootSequence::on_run_byte(std::uint8_t byte) noexcept {
  const auto report = parser_.take(byte);
  if (!report || is_echo_of_knock(*report)) return;
  trouble_ = BootTrouble::None;
  enter(BootStage::Running);
}

void BootSequence::on_request_end(bus::UsbOutcome outcome) noexcept {
  if (!is_request_open_) return;
  is_request_open_ = false;
  if (outcome != bus::UsbOutcome::Done) return rest(BootTrouble::RequestRefused);
  ++requests_done_;
}

bool BootSequence::is_being_set() const noexcept {
  return is_request_open_ || requests_done_ < settings_of(stage_).size();
}

BootOrder BootSequence::next() noexcept {
  if (is_running()) return {};
  if (is_first_ && is_being_set() && now_ >= knock_at_) {
    knock_at_ = now_ + kPatience;
    return order_of(encode_run_command(kKnock));
  }
  if (is_request_open_) return {};
  const std::span<const Setting> settings = settings_of(stage_);
  if (requests_done_ < settings.size()) {
    BootOrder order;
    order.kind = BootOrder::Kind::Request;
    order.request.request_type = wire::kRequestType;
    order.request.request = settings[requests_done_].request;
    order.request.value = settings[requests_done_].value;
    is_request_open_ = true;
    request_deadline_.reset();
    return order;
  }
  if (!wants_to_talk_ && now_ >= deadline_) on_silence();
  if (!wants_to_talk_ || is_being_set()) return {};
  wants_to_talk_ = false;
  deadline_ = now_ + patience();
  return talk();
}

BootOrder BootSequence::talk() const noexcept {
  switch (stage_) {
    case BootStage::Asking:
      return order_of(wire::kBootQuestion);
    case BootStage::Marking:
      return order_of(std::span(&wire::kUploadMark, 1));
    case BootStage::Uploading:
      return order_of(image_.subspan(sent_bytes_, chunk_bytes()));
    case BootStage::Detecting:
    case BootStage::Starting:
      return order_of(encode_run_command(kKnock));
    case BootStage::Running:
    case BootStage::Resting:
      return {};
  }
  return {};
}

Duration BootSequence::patience() const noexcept {
  const bool is_echo = stage_ == BootStage::Marking || stage_ == BootStage::Uploading;
  return is_echo ? kEchoPatience : kPatience;
}

int BootSequence::detect_rounds() const noexcept {
  return is_search_ ? static_cast<int>(kSearch / kPatience) : wire::kDetectRounds;
}

std::size_t BootSequence::chunk_bytes() const noexcept {
  return std::min(wire::kUploadChunkBytes, image_.size() - sent_bytes_);
}

void BootSequence::enter(BootStage stage) noexcept {
  stage_ = stage;
  is_search_ = false;
  is_first_ = false;
  requests_done_ = 0;
  wants_to_talk_ = stage != BootStage::Resting;
  repetitions_ = 0;
  matched_bytes_ = 0;
  parser_.forget();
  if (stage == BootStage::Uploading) {
    sent_bytes_ = 0;
    echoed_bytes_ = 0;
  }
}

// What was said last had no answer in time.
void BootSequence::on_silence() noexcept {
  ++repetitions_;
  matched_bytes_ = 0;
  parser_.forget();
  switch (stage_) {
    case BootStage::Detecting:
      if (repetitions_ < detect_rounds()) break;
      return image_.empty() ? rest(BootTrouble::NoImage) : enter(BootStage::Asking);
    case BootStage::Asking:
      if (repetitions_ < wire::kBootQuestions) break;
      return rest(BootTrouble::NoLoader);
    case BootStage::Starting:
      if (repetitions_ < wire::kDetectRounds) break;
      return fail_upload(BootTrouble::NotStarted);
    case BootStage::Marking:
    case BootStage::Uploading:
      return fail_upload(BootTrouble::EchoMissing);
    case BootStage::Resting:
      uploads_ = 0;
      return enter(BootStage::Detecting);
    case BootStage::Running:
      return;
  }
  wants_to_talk_ = true;
}

void BootSequence::fail_upload(BootTrouble trouble) noexcept {
  ++uploads_;
  if (uploads_ >= wire::kUploads) return rest(trouble);
  trouble_ = trouble;
  enter(BootStage::Asking);
}

void BootSequence::rest(BootTrouble trouble) noexcept {
  trouble_ = trouble;
  enter(BootStage::Resting);
  deadline_ = now_ + kRest;
}

}  // namespace thimble::falcon
