#include "sim/model/cam/board_page.hpp"

#include <algorithm>

namespace thimble::sim::cam {
namespace {

namespace page = cambus::page;
using State = StepInterface::State;
using Interrupt = StepInterface::Interrupt;

constexpr std::uint32_t kWordBytes = 4;
constexpr std::int64_t kBeatEvery_ms = page::kBeatAtLeastEvery_ms / 2;
// Of the control register: exceptions.
constexpr std::uint32_t kExceptionMask = 3;
constexpr unsigned kDisableExceptionsShift = 5;
constexpr unsigned kEnableExceptionsShift = 13;

std::uint32_t flag_if(bool is_set, std::uint32_t flag) { return is_set ? flag : 0; }

bus::SharedWords window_of(bus::SharedWords memory, std::size_t bytes) {
  return memory.from(page::kPageBytes, bytes);
}

}  // namespace

BoardPage::BoardPage(const BoardOptions& options, bus::SharedWords memory, MonotonicTime now)
    : memory_(memory),
      machine_(options.shape, options.scanning),
      interface_(machine_, window_of(memory, options.window_bytes)),
      start_(now),
      clock_hz_(options.clock_hz),
      is_paced_(options.is_paced),
      thread_clock_(options.thread_clock) {
  show_identity(options);
  look();
  show(now);
  memory_.store(page::kMagic, page::kMagicValue);  // last: whoever sees it may believe the rest
}

void BoardPage::show_identity(const BoardOptions& options) {
  std::uint32_t shape = static_cast<std::uint32_t>(options.shape.log2_sites) << 24;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    shape |= static_cast<std::uint32_t>(options.shape.modules[axis]) << (8 * axis);
  }
  memory_.store(page::kVersion, page::kVersionValue);
  memory_.store(page::kWindowOffset, page::kPageBytes);
  memory_.store(page::kWindowBytes, static_cast<std::uint32_t>(options.window_bytes));
  memory_.store(page::kShape, shape);
  memory_.store(page::kClockHz, options.clock_hz);
  memory_.store(page::kIncarnation, options.incarnation);
}

std::uint64_t BoardPage::clocks_at(MonotonicTime now) const noexcept {
  constexpr std::uint64_t kNanosecond_per_s = 1'000'000'000;
  const auto since = static_cast<std::uint64_t>((now - start_).count());
  return since / kNanosecond_per_s * clock_hz_ +
         since % kNanosecond_per_s * clock_hz_ / kNanosecond_per_s;
}

void BoardPage::serve(MonotonicTime now) {
  const std::uint64_t clocks = clocks_at(now);
  catch_up(clocks);
  if (memory_.load(page::kDoorbell) != acknowledged_) {
    take_doorbell(clocks);
    catch_up(clocks);
  }
  show(now);
}

// Between steps the machine's clock is not ahead of the time.
void BoardPage::catch_up(std::uint64_t clocks) {
  for (int i = 0; i < kMostSteps; ++i) {
    if (is_paced_ && machine_.now_clocks() > clocks) return;
    if (has_next_list_) interface_.write_next_list(next_list_);
    has_next_list_ = false;
    look();
    if (interface_.state() != State::Executing) break;
    if (!may_go_on()) return;
    static_cast<void>(interface_.step());
  }
  const bool is_idle = interface_.state() != State::Executing;
  if (is_idle && machine_.now_clocks() < clocks) machine_.spend(clocks - machine_.now_clocks());
  if (is_idle) look();
  if (is_idle) working_since_.reset();
}

bool BoardPage::may_go_on() {
  if (thread_clock_ == nullptr) return true;
  const MonotonicTime now = thread_clock_->now();
  if (now < rests_until_) return false;
  if (!working_since_) working_since_ = now;
  if (now - *working_since_ < kMostAtOnce) return true;
  working_since_.reset();
  rests_until_ = now + kRest;
  return false;
}

// All that are meant, the list last.
void BoardPage::take_doorbell(std::uint64_t clocks) {
  const std::uint32_t meant = memory_.load(page::kMeant);
  if ((meant & page::kControl) != 0) {
    control(memory_.load(page::kWritten + kWordBytes), clocks);
  }
  take_display_lengths(meant);
  if ((meant & page::kNextList) != 0) {
    has_next_list_ = true;
    next_list_ = memory_.load(page::kWritten) & page::kListPointer;
  }
  acknowledged_ = memory_.load(page::kDoorbell);
  ++counters_.doorbells;
}

void BoardPage::control(std::uint32_t word, std::uint64_t clocks) {
  if ((word & page::kResetInterface) != 0) {
    if (is_paced_) machine_.be_at(clocks);
    interface_.reset();
    display_ = {};
    machine_.set_sync(display_);
    has_next_list_ = false;
    enabled_ = 0;
    exceptions_ = 0;
    return;
  }
  enabled_ &= ~(word & page::kInterruptMask);
  enabled_ |= (word >> page::kEnableShift) & page::kInterruptMask;
  exceptions_ &= ~((word >> kDisableExceptionsShift) & kExceptionMask);
  exceptions_ |= (word >> kEnableExceptionsShift) & kExceptionMask;
  if ((word & page::kHalt) != 0) interface_.stop_for_host();
  if ((word & page::kClearException) != 0) interface_.clear_exception();
}

// Whichever is written, the counters begin anew.
void BoardPage::take_display_lengths(std::uint32_t meant) {
  if ((meant & page::kScanLength) != 0) {
    const std::uint32_t scan = memory_.load(page::kWritten + 2 * kWordBytes);
    display_.scan_clocks = scan & page::kLengthMask;
    display_.scan_lines = scan >> page::kLinesShift;
  }
  if ((meant & page::kBlankLength) != 0) {
    const std::uint32_t blank = memory_.load(page::kWritten + 3 * kWordBytes);
    display_.blank_clocks = blank & page::kLengthMask;
    display_.blank_lines = blank >> page::kLinesShift;
  }
  if ((meant & (page::kScanLength | page::kBlankLength)) != 0) machine_.set_sync(display_);
}

// Keeps what a host is to see of this moment.
void BoardPage::look() {
  const auto error = interface_.error();
  shown_.registers = {list_register(), control_register(),
                      interface_.current() | flag_if(error == Interrupt::Bus, page::kHasBusFault),
                      interface_.previous() |
                          flag_if(machine_.has_interrupt(), page::kHasMachineInterrupt) |
                          flag_if(machine_.is_scanning(), page::kIsScanning)};
  for (std::size_t i = 0; i < shown_.raised.size(); ++i) {
    shown_.raised[i] = static_cast<std::uint32_t>(interface_.interrupts(static_cast<Interrupt>(i)));
  }
}

// After a machine interrupt or a time-out the card waits, with an exception; a fault or the host
// halts it.
std::uint32_t BoardPage::list_register() const noexcept {
  const auto error = interface_.error();
  const bool is_ended = error == Interrupt::Machine || error == Interrupt::Timeout;
  const bool is_halted = interface_.state() == State::Halted && !is_ended;
  const bool is_waiting = interface_.state() == State::Waiting || is_ended;
  return (interface_.next() & page::kListPointer) |
         flag_if(interface_.is_list_pending(), page::kIsListPending) |
         flag_if(error.has_value(), page::kHasException) | flag_if(is_waiting, page::kIsWaiting) |
         flag_if(is_halted, page::kIsHalted);
}

std::uint32_t BoardPage::control_register() const noexcept {
  return enabled_ << page::kEnableShift | exceptions_ << kEnableExceptionsShift;
}

void BoardPage::show(MonotonicTime now) {
  const auto since_ms = std::chrono::duration_cast<std::chrono::milliseconds>(now - start_).count();
  memory_.store(page::kBeat, static_cast<std::uint32_t>(since_ms / kBeatEvery_ms));
  StatusWords words{};
  std::copy(shown_.registers.begin(), shown_.registers.end(), words.begin());
  words[0] |= flag_if(has_next_list_, page::kIsListPending);
  words[shown_.registers.size()] = acknowledged_;
  std::copy(shown_.raised.begin(), shown_.raised.end(), words.end() - shown_.raised.size());
  if (words == on_page_) return;  // so that a host that looks twice finds it at rest
  on_page_ = words;
  memory_.store(page::kMoment, ++moment_);
  for (std::uint32_t i = 0; i < words.size(); ++i) {
    memory_.store(page::kRead + kWordBytes * i, words[i]);
  }
  memory_.store(page::kMoment, ++moment_);
}

}  // namespace thimble::sim::cam
