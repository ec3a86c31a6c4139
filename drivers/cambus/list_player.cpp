#include "drivers/cambus/list_player.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace thimble::cambus {
namespace {

using page::Interrupt;

bool is_ready(const BoardStatus& status) {
  return status.is_waiting() && !status.has_exception() && !status.is_halted();
}

std::string where(const BoardStatus& status) {
  return "at " + hex(status.current()) + ", behind " + hex(status.previous());
}

}  // namespace

ListPlayer::ListPlayer(BoardPort& port, const ListLimits& limits)
    : port_(&port), video_(video_timing(port.facts().clock_hz)), limits_(limits) {
  limits_.has_sync = video_.has_value();
}

Result<void> ListPlayer::start(StepList list, Duration at_most, MonotonicTime now) {
  if (is_playing()) return fail(Errc::Busy, "the board still plays the list before");
  const auto summary = check_step_list(list.view(), list.head, limits_);
  if (!summary) {
    ++counters_.refused;
    return tl::unexpected(summary.error());
  }
  if (port_->why_gone() != Gone::No) return tl::unexpected(lost_board());
  list.bytes.resize(wire::buffer_end(list.bytes.size()));
  if (std::uint64_t{list.base} + list.bytes.size() > port_->facts().window_bytes) {
    ++counters_.refused;
    return fail(Errc::TooLarge, "a list of " + std::to_string(list.bytes.size()) + " bytes at " +
                                    hex(list.base) + " does not fit the board's window of " +
                                    std::to_string(port_->facts().window_bytes));
  }
  list_ = std::move(list);
  soft_at_most_ =
      summary->loops ? std::numeric_limits<std::uint64_t>::max() : std::uint64_t{summary->steps};
  until_ = now + at_most;
  phase_ = needs_reset_ ? Phase::Clearing : Phase::Putting;
  ++counters_.started;
  return {};
}

Result<bool> ListPlayer::poll(MonotonicTime now) {
  port_->begin_turn();
  if (!is_playing()) return true;
  // A board that takes no time to take a doorbell costs none.
  for (auto before = Phase::Idle; before != phase_;) {
    before = phase_;
    auto is_over = look(now);
    if (!is_over || *is_over) return is_over;
  }
  if (now < until_) return false;
  if (interrupted_) return stop(*interrupted_);
  ++counters_.timed_out;
  const std::string what = phase_ == Phase::Playing
                               ? "the list is not over: the board is " + where(seen_)
                               : "the board does not take a list";
  return stop({Errc::Timeout, what});
}

Result<bool> ListPlayer::look(MonotonicTime now) {
  // Over USB the port goes on only while it is polled, even if what it says is of no use now.
  IoStatus status = phase_ == Phase::Putting ? put() : IoStatus::Ok;
  if (status != IoStatus::Disconnected) status = port_->poll(now, seen_);
  if (status == IoStatus::Disconnected) return stop(lost_board());
  return status == IoStatus::Ok ? go_on(seen_) : Result<bool>(false);
}

// Where the port has no room now, it is tried again with the next poll.
IoStatus ListPlayer::put() {
  const IoStatus done = port_->put(list_.base, list_.bytes);
  if (done != IoStatus::Ok) return done;
  list_.bytes = {};
  phase_ = Phase::Giving;
  return done;
}

Result<bool> ListPlayer::go_on(const BoardStatus& status) {
  switch (phase_) {
    case Phase::Idle:
      return true;
    case Phase::Clearing:
      needs_set_up_ = true;
      return ring_reset();
    case Phase::Resetting:
      return after_reset(status);
    case Phase::Putting:
      return false;
    case Phase::Giving:
      return give(status);
    case Phase::Playing:
      return while_it_plays(status);
    case Phase::Naming:
      return name_flags();
  }
  return false;
}

// The board takes the control word first: the reset stops the counters that the lengths start.
Result<bool> ListPlayer::ring_reset() {
  Registers registers{0, page::kResetInterface};
  if (!video_) return ring(registers, page::kControl, Phase::Resetting);
  registers[2] = video_->scan_length();
  registers[3] = video_->blank_length();
  return ring(registers, page::kControl | page::kScanLength | page::kBlankLength, Phase::Resetting);
}

// What waits for its steps to be over is taken later than it is acknowledged.
Result<bool> ListPlayer::after_reset(const BoardStatus& status) {
  if (!port_->is_taken(status) || !is_ready(status)) return false;
  needs_reset_ = false;
  before_ = status;
  phase_ = Phase::Putting;
  return false;
}

Result<bool> ListPlayer::give(const BoardStatus& status) {
  if (const auto what = nonsense(status, 0)) return strange(*what);
  // The list relies on what was set up before, which somebody else has undone.
  if (!is_ready(status)) return strange("has stopped while it had nothing to do");
  before_ = status;
  return ring({list_.head}, page::kNextList, Phase::Playing);
}

// Where the doorbell is not free yet, it is tried again with the next poll.
Result<bool> ListPlayer::ring(const Registers& registers, std::uint32_t meant, Phase next) {
  const IoStatus rung = port_->ring(registers, meant);
  if (rung == IoStatus::Disconnected) return stop(lost_board());
  if (rung == IoStatus::Ok) phase_ = next;
  return false;
}

Result<bool> ListPlayer::while_it_plays(const BoardStatus& status) {
  if (const auto what = nonsense(status, 1)) return strange(*what);
  if (auto why = ended_by(status)) {
    const bool can_ask = why->code == Errc::System && !interrupted_;
    return can_ask ? ask_for_flags(*std::move(why)) : stop(*why);
  }
  if (status.has_exception() || status.is_halted()) return strange("has stopped without a reason");
  const bool has_begun = port_->is_taken(status) && since(status, Interrupt::NewList) > 0;
  if (!has_begun || !status.is_waiting() || status.is_list_pending()) return false;
  if (interrupted_) {
    phase_ = Phase::Naming;
    return false;
  }
  phase_ = Phase::Idle;
  before_ = status;
  needs_set_up_ = false;
  ++counters_.done;
  return true;
}

// What the selected modules answer is ORed, so that none has to be known by its number.
Result<bool> ListPlayer::ask_for_flags(Error why) {
  interrupted_ = std::move(why);
  StepListBuilder builder;
  builder.write(default_words(Register::Select));
  flags_ = builder.read(Register::IntFlags, static_cast<std::uint32_t>(kMachineInterrupts));
  list_ = builder.finish();
  soft_at_most_ = 0;
  phase_ = Phase::Clearing;
  return false;
}

Result<bool> ListPlayer::name_flags() {
  std::array<std::uint8_t, wire::buffer_end(2 * kMachineInterrupts)> bytes{};
  const IoStatus status = port_->get(flags_.offset, bytes);
  if (status == IoStatus::NoData) return false;
  if (status != IoStatus::Ok) return stop(*interrupted_);
  std::string names;
  for (std::uint32_t bit = 0; bit < kMachineInterrupts; ++bit) {
    if (buffer_word({0, bytes}, 0, bit) == 0) continue;
    ++counters_.flags[bit];
    names += (names.empty() ? ": " : ", ");
    names += field::kInterrupts<Register::IntFlags>[bit].name;
  }
  interrupted_->message += names.empty() ? ": none of its flags is set" : names;
  return stop(*interrupted_);
}

std::optional<Error> ListPlayer::ended_by(const BoardStatus& status) {
  if (since(status, Interrupt::Machine) > 0) {
    ++counters_.machine_interrupts;
    return Error{Errc::System, "the machine interrupted the list " + where(status)};
  }
  if (since(status, Interrupt::Bus) > 0) {
    ++counters_.bus_faults;
    return Error{Errc::Malformed, "the board could not read its list " + where(status)};
  }
  if (since(status, Interrupt::Timeout) > 0) {
    ++counters_.module_timeouts;
    return Error{Errc::Timeout, "no module answered the list " + where(status)};
  }
  return std::nullopt;
}

std::optional<std::string> ListPlayer::nonsense(const BoardStatus& status,
                                                std::uint32_t lists) const {
  const std::uint64_t errors = std::uint64_t{since(status, Interrupt::Machine)} +
                               since(status, Interrupt::Bus) + since(status, Interrupt::Timeout);
  const std::uint32_t begun = since(status, Interrupt::NewList);
  if (begun > lists) {
    return "has begun " + std::to_string(begun) + " lists and was given " + std::to_string(lists);
  }
  if (errors > lists) {
    return "has raised " + std::to_string(errors) + " errors in " + std::to_string(lists) +
           " lists";
  }
  const std::uint32_t soft = since(status, Interrupt::Soft);
  const std::uint64_t soft_at_most = lists == 0 ? 0 : soft_at_most_;
  if (soft > soft_at_most) {
    return "has raised " + std::to_string(soft) + " soft interrupts, at most " +
           std::to_string(soft_at_most) + " were asked for";
  }
  return std::nullopt;
}

std::uint32_t ListPlayer::since(const BoardStatus& status, Interrupt which) const noexcept {
  return status.count(which) - before_->count(which);
}

Result<std::vector<std::uint16_t>> ListPlayer::words_of(const ReadSlot& slot, MonotonicTime now) {
  const std::uint64_t size = wire::buffer_end(2 * std::uint64_t{slot.words});
  if (size > port_->facts().window_bytes) {
    return fail(Errc::InvalidArgument,
                "no board has a buffer of " + std::to_string(size) + " bytes");
  }
  std::vector<std::uint8_t> bytes(size);
  IoStatus status = port_->get(slot.offset, bytes);
  if (status == IoStatus::NoData) return fail(Errc::Busy, "what the list read is on its way");
  if (status == IoStatus::Ok) status = port_->confirm(now);
  if (status == IoStatus::Disconnected) return tl::unexpected(lost_board());
  if (status != IoStatus::Ok) {
    return fail(Errc::InvalidArgument, "no buffer lies at " + hex(slot.offset));
  }
  std::vector<std::uint16_t> words(slot.words);
  for (std::uint32_t k = 0; k < slot.words; ++k) words[k] = buffer_word({0, bytes}, 0, k);
  return words;
}

Error ListPlayer::lost_board() const {
  return {Errc::Disconnected, "the board " + std::string(to_string(port_->why_gone()))};
}

tl::unexpected<Error> ListPlayer::strange(const std::string& what) {
  ++counters_.strange;
  return stop({Errc::Malformed, "the board says what cannot be: it " + what});
}

tl::unexpected<Error> ListPlayer::stop(Error why) {
  if (interrupted_) why = *std::exchange(interrupted_, std::nullopt);  // that came first
  phase_ = Phase::Idle;
  list_ = {};
  port_->drop_unsent();
  before_.reset();
  needs_reset_ = true;
  needs_set_up_ = true;
  return tl::unexpected<Error>(std::move(why));
}

}  // namespace thimble::cambus
