#include "sim/model/cam/step_interface.hpp"

#include <vector>

#include "drivers/cambus/cambus_wire.hpp"

namespace thimble::sim::cam {

namespace wire = cambus::wire;

namespace {

// All sites of the largest module.
constexpr std::uint32_t kMostWords = 1U << 24;

bool has(std::uint32_t opcode, std::uint32_t flag) { return (opcode & flag) == flag; }

}  // namespace

void StepInterface::write_next_list(std::uint32_t offset) {
  next_ = offset & ~(wire::kDescriptorBytes - 1U);
  is_pending_ = true;
  if (state_ == State::Waiting) start_pending();
}

void StepInterface::clear_exception() {
  if (state_ != State::Halted) return;
  state_ = State::Waiting;
  error_.reset();
  if (is_pending_) start_pending();
}

void StepInterface::reset() {
  machine_.reset();
  state_ = State::Waiting;
  is_pending_ = false;
  error_.reset();
  interrupts_ = {};
}

void StepInterface::start_pending() {
  state_ = State::Executing;
  current_ = next_;
  is_pending_ = false;
  raise(Interrupt::NewList);
}

bool StepInterface::run(std::uint64_t most_steps) {
  for (std::uint64_t i = 0; i < most_steps; ++i) {
    if (!step()) return true;
  }
  return state_ != State::Executing;
}

bool StepInterface::lies_within(std::uint32_t offset, std::uint64_t bytes) const noexcept {
  const bool is_aligned = offset % wire::kBufferAlignment == 0 && offset >= wire::kReservedBytes;
  return is_aligned && offset <= window_.bytes() && bytes <= window_.bytes() - offset;
}

std::uint16_t StepInterface::half(std::uint32_t offset) const noexcept {
  const std::uint32_t word = window_.load(offset & ~3U);
  return static_cast<std::uint16_t>((offset & 2U) != 0 ? word >> 16 : word);
}

// Nobody else writes to the buffer of a read.
void StepInterface::put_byte(std::uint32_t offset, std::uint8_t value) noexcept {
  const unsigned shift = 8 * (offset & 3U);
  const std::uint32_t others = window_.load(offset & ~3U) & ~(0xffU << shift);
  window_.store(offset & ~3U, others | std::uint32_t{value} << shift);
}

bool StepInterface::step() {
  if (state_ != State::Executing) return false;
  if (!lies_within(current_, wire::kDescriptorBytes)) return halt(Interrupt::Bus);
  const Step step{
      window_.load(current_ + wire::kOpcodeByte), window_.load(current_ + wire::kBufferByte),
      window_.load(current_ + wire::kLengthByte), window_.load(current_ + wire::kLinkByte)};
  if (!play(step)) return false;
  if (has(step.opcode, wire::kInterrupt)) raise(Interrupt::Soft);
  go_on(step);
  return state_ == State::Executing;
}

bool StepInterface::play(const Step& step) {
  if (has(step.opcode, wire::kWait)) {
    if (machine_.hangs()) return halt(Interrupt::Timeout);
    machine_.wait_for_status();
  }
  if (!has(step.opcode, wire::kDelay)) return move(step);
  if (has(step.opcode, wire::kReset)) machine_.reset();
  machine_.spend(step.length);
  return true;
}

bool StepInterface::move(const Step& step) {
  const bool is_done = has(step.opcode, wire::kRead) ? fetch(step) : send(step);
  if (!is_done) return false;
  return machine_.has_interrupt() ? halt(Interrupt::Machine) : true;
}

bool StepInterface::send(const Step& step) {
  const bool is_immediate = has(step.opcode, wire::kImmediate);
  const std::uint64_t bytes = 2 * std::uint64_t{step.length};
  if (!is_immediate && !lies_within(step.buffer, bytes)) return halt(Interrupt::Bus);
  if (step.length > kMostWords) return halt(Interrupt::Bus);
  std::vector<std::uint16_t> words(step.length);
  for (std::uint32_t k = 0; k < step.length; ++k) {
    words[k] = is_immediate ? static_cast<std::uint16_t>(step.buffer >> (16 * (k % 2)))
                            : half(step.buffer + 2 * k);
  }
  machine_.write(step.opcode & wire::kRegisterMask, words);
  return true;
}

bool StepInterface::fetch(const Step& step) {
  const bool is_bytes = has(step.opcode, wire::kByteMode);
  if (!lies_within(step.buffer, std::uint64_t{step.length} * (is_bytes ? 1 : 2))) {
    return halt(Interrupt::Bus);
  }
  const auto words = machine_.read(step.opcode & wire::kRegisterMask, step.length);
  if (!words) return halt(Interrupt::Timeout);
  for (std::uint32_t k = 0; k < step.length; ++k) {
    const std::uint16_t word_k = (*words)[k];
    if (is_bytes) {
      put_byte(step.buffer + k, static_cast<std::uint8_t>(word_k));
    } else {
      put_byte(step.buffer + 2 * k, static_cast<std::uint8_t>(word_k));
      put_byte(step.buffer + 2 * k + 1, static_cast<std::uint8_t>(word_k >> 8));
    }
  }
  return true;
}

void StepInterface::go_on(const Step& step) {
  previous_ = current_;
  const bool may_jump = has(step.opcode, wire::kStop) || has(step.opcode, wire::kJump);
  if (may_jump && is_pending_) return start_pending();
  if (has(step.opcode, wire::kStop)) {
    state_ = State::Waiting;
  } else {
    current_ = step.link;
  }
}

bool StepInterface::halt(Interrupt why) {
  raise(why);
  error_ = why;
  state_ = State::Halted;
  return false;
}

}  // namespace thimble::sim::cam
