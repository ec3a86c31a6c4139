#include "drivers/cambus/step_list_builder.hpp"

#include <cstddef>
#include <utility>

#include "drivers/cambus/little_endian.hpp"
#include "hal/base/check.hpp"

namespace thimble::cambus {
namespace {

// Whether two words by turns say it all.
bool repeats(std::span<const std::uint16_t> words) {
  for (std::size_t k = 2; k < words.size(); ++k) {
    if (words[k] != words[k - 2]) return false;
  }
  return true;
}

// MIT's software never moves show-scan, which says whose scans are waited for.
std::uint32_t wait_flag(Register number) {
  return facts_of(number).waits || number == Register::ShowScan ? wire::kWait : 0;
}

}  // namespace

StepListBuilder::StepListBuilder(std::uint32_t base) : base_(base) {
  THIMBLE_CHECK(base >= wire::kReservedBytes && base % wire::kBufferAlignment == 0);
}

void StepListBuilder::write(const RegisterWords& words) {
  write_port(words.number(), words.words());
}

void StepListBuilder::write_port(Register port, std::span<const std::uint16_t> words) {
  THIMBLE_CHECK(!words.empty());
  const auto length = static_cast<std::uint32_t>(words.size());
  const std::uint32_t opcode = static_cast<std::uint32_t>(port) | wait_flag(port);
  if (repeats(words)) {
    begin_step(opcode | wire::kImmediate, length);
    const std::uint32_t second = words.size() > 1 ? words[1] : words[0];
    store_word(last_step_ + wire::kBufferByte, words[0] | second << 16);
  } else {
    begin_step(opcode, length);
    add_buffer(2 * length);
    const std::size_t buffer = last_step_ + wire::kDescriptorBytes;
    for (std::size_t k = 0; k < words.size(); ++k) {
      bytes_[buffer + 2 * k] = static_cast<std::uint8_t>(words[k]);
      bytes_[buffer + 2 * k + 1] = static_cast<std::uint8_t>(words[k] >> 8);
    }
  }
  if (port == Register::ScanIo) delay(kLongestFlush_clocks);
}

ReadSlot StepListBuilder::read(Register number, std::uint32_t words) {
  THIMBLE_CHECK(words > 0);
  begin_step(static_cast<std::uint32_t>(number) | wire::kRead | wait_flag(number), words);
  add_buffer(2 * words);
  return {window_offset(last_step_ + wire::kDescriptorBytes), words};
}

void StepListBuilder::delay(std::uint32_t clocks) {
  THIMBLE_CHECK(clocks > 0);
  begin_step(wire::kDelay, clocks);
}

void StepListBuilder::reset(std::uint32_t clocks) {
  THIMBLE_CHECK(clocks > 0);
  begin_step(wire::kDelay | wire::kReset, clocks);
}

void StepListBuilder::raise_interrupt() { flag_last(wire::kInterrupt); }

StepList StepListBuilder::finish() {
  if (bytes_.empty()) delay(1);
  flag_last(wire::kStop);
  StepList list{base_, base_, std::move(bytes_)};
  bytes_.clear();
  last_step_ = 0;
  return list;
}

void StepListBuilder::flag_last(std::uint32_t flag) {
  THIMBLE_CHECK(!bytes_.empty());
  // No flag reaches below the second byte of an opcode.
  bytes_[last_step_ + 1] = static_cast<std::uint8_t>(bytes_[last_step_ + 1] | flag >> 8);
}

void StepListBuilder::store_word(std::size_t place, std::uint32_t value) {
  store32(std::span(bytes_).subspan(place), value);
}

std::uint32_t StepListBuilder::window_offset(std::size_t place) const {
  return base_ + static_cast<std::uint32_t>(place);
}

void StepListBuilder::begin_step(std::uint32_t opcode, std::uint32_t length) {
  const std::size_t here = bytes_.size();
  if (here > 0) {
    store_word(last_step_ + wire::kLinkByte, window_offset(here));
  }
  bytes_.resize(here + wire::kDescriptorBytes, 0);
  store_word(here + wire::kOpcodeByte, opcode);
  store_word(here + wire::kLengthByte, length);
  last_step_ = here;
}

void StepListBuilder::add_buffer(std::uint32_t bytes) {
  const std::size_t here = bytes_.size();
  store_word(last_step_ + wire::kBufferByte, window_offset(here));
  bytes_.resize(here + wire::buffer_end(bytes), 0);
}

}  // namespace thimble::cambus
