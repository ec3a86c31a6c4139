#include "daemon/link/line_world_end.hpp"

#include "daemon/link/earliest.hpp"

namespace thimble::link {

LineWorldEnd::LineWorldEnd(const ThimbleWorldEnd::Settings& settings,
                           coupling::WorldCoupling* of_1999,
                           const ThimbleWorldEnd::MakeHalf& make_half, const RandomBytes& random,
                           std::uint32_t bit_per_s)
    : pace_(bit_per_s) {
  if (of_1999 != nullptr && !settings.key) {
    thesis_.emplace(ThesisWorldEnd::Settings{settings.impairment, {}}, *of_1999);
  }
  if (make_half) thimble_.emplace(settings, make_half, random);
}

void LineWorldEnd::on_bytes(std::span<const std::byte> bytes, MonotonicTime now) {
  deframer_.on_read(now);
  for (const std::byte byte : bytes) {
    if (const auto datagram = deframer_.push(byte)) on_datagram(*datagram, now);
  }
  counters_.receive_errors = deframer_.counters().damaged;
}

void LineWorldEnd::on_datagram(std::span<const std::byte> datagram, MonotonicTime now) {
  if (is_thimble_datagram(datagram) && thimble_) {
    thimble_->on_datagram({}, datagram, now);
  } else if (thesis_) {
    thesis_->on_datagram({}, datagram, now);
  } else {
    ++counters_.received;
    counters_.reject(RejectReason::WrongVersion);
  }
  serve(now);
}

void LineWorldEnd::serve(MonotonicTime now) {
  if (thesis_) {
    for (ThesisWorldEnd::Reply reply; thesis_->poll(now, reply);) keep(reply.bytes);
  }
  if (thimble_) {
    for (ThimbleWorldEnd::Reply reply; thimble_->poll(now, reply);) keep(reply.datagram.view());
  }
}

void LineWorldEnd::keep(std::span<const std::byte> datagram) {
  if (has_newest_) ++counters_.withheld;
  newest_ = frame(datagram);
  has_newest_ = true;
}

bool LineWorldEnd::poll(MonotonicTime now, SerialFrame& out) {
  serve(now);
  if (!has_newest_ || now < pace_.free_at()) return false;
  out = newest_;
  has_newest_ = false;
  pace_.on_sent(out.size, now);
  return true;
}

std::optional<MonotonicTime> LineWorldEnd::next_due() const {
  std::optional<MonotonicTime> due;
  if (thesis_) take_earlier(due, thesis_->next_due());
  if (thimble_) take_earlier(due, thimble_->next_due());
  if (has_newest_) take_earlier(due, pace_.free_at());
  return due;
}

LinkStatus LineWorldEnd::status() const {
  LinkStatus status = thesis_ ? thesis_->status() : LinkStatus();
  status.counters = sum(status.counters, counters_);
  if (!thimble_) return status;
  status.counters = sum(status.counters, thimble_->total());
  status.is_up = status.is_up || !thimble_->sessions().empty();
  if (status.last_error.empty()) status.last_error = thimble_->refusal();
  return status;
}

std::vector<LinkStatus> LineWorldEnd::sessions() const {
  return thimble_ ? thimble_->sessions() : std::vector<LinkStatus>();
}

}  // namespace thimble::link
