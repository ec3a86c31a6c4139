#include "drivers/cambus/step_list_check.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace thimble::cambus {
namespace {

tl::unexpected<Error> malformed(std::string message) {
  return fail(Errc::Malformed, std::move(message));
}

Result<void> check_opcode(const Descriptor& step) {
  if ((step.opcode & ~wire::kOpcodeMask) != 0) {
    return malformed("opcode " + hex(step.opcode) + " has bits that mean nothing");
  }
  if (step.has(wire::kReset) && !step.is_delay()) {
    return malformed("the reset line can only be driven during a delay");
  }
  if (step.has(wire::kByteMode) && !step.is_read()) {
    return malformed("byte mode is for reads only");
  }
  return {};
}

Result<void> check_delay(const Descriptor& step) {
  if (step.length >= 1 && step.length <= wire::kMaxDelayClocks) return {};
  return malformed("a delay of " + std::to_string(step.length) + " clocks is not within 1 and " +
                   std::to_string(wire::kMaxDelayClocks));
}

Result<void> check_length(Register target, std::uint32_t length, const ListLimits& limits) {
  std::uint32_t least = facts_of(target).bits;
  std::uint32_t most = least;
  if (target == Register::Event) least = 1;
  if (target == Register::LutIo) most = kTableEntries;
  if (target == Register::ScanIo) most = limits.module_sites;
  least = std::max(least, 1U);
  if (length >= least && length <= most) return {};
  const std::string allowed =
      least == most ? std::to_string(most) : std::to_string(least) + " to " + std::to_string(most);
  return malformed(std::string(facts_of(target).name) + " takes " + allowed + " words, not " +
                   std::to_string(length));
}

Result<void> check_codes(const RegisterWords& words) {
  const RegisterFacts& facts = facts_of(words.number());
  const auto all = words.words();
  const bool are_alike = std::all_of(all.begin(), all.end(),
                                     [](auto word) { return word == 0 || word == kAllLayers; });
  const int layers = are_alike ? 1 : kLayers;
  for (const Field& of : facts.fields) {
    if (of.codes == Codes::Any) continue;
    for (int layer = 0; layer < layers; ++layer) {
      const std::uint32_t value = words.get(of, layer);
      if (means_something(of.codes, value)) continue;
      return malformed(std::string(facts.name) + ": " + std::string(of.name) + " " +
                       std::to_string(value) + " means nothing");
    }
  }
  return {};
}

// Follows one list. Each step is looked at once, but for what depends on how it was come to: those
// of a loop are passed a second time.
class Walk {
 public:
  Walk(const WindowView& window, const ListLimits& limits)
      : window_(window),
        limits_(limits),
        cells_(wire::buffer_end(window.bytes.size()) / wire::kBufferAlignment),
        numbers_(cells_.size()) {}

  Result<ListSummary> run(std::uint32_t head);

 private:
  // Of 16 bytes of the window: what the list does with them.
  enum Use : std::uint8_t { Step = 1, ReadInto = 2, RunData = 4 };
  enum class Next { Follow, Done };

  Result<Next> visit(std::uint32_t at);
  Result<void> check_first_time(const Descriptor& step, std::uint32_t at);
  Result<void> check_transfer(const Descriptor& step);
  Result<void> check_buffer(const Descriptor& step);
  Result<void> check_data(const Descriptor& step);
  Result<void> check_run(const Descriptor& step);
  Result<void> check_order(const Descriptor& step);
  Result<Next> end_of_loop(std::uint32_t at);
  std::size_t cell_of(std::uint32_t offset) const {
    return (offset - window_.base) / wire::kBufferAlignment;
  }
  bool is_used(std::uint32_t offset, std::uint64_t size, std::uint8_t how) const;
  void use(std::uint32_t offset, std::uint64_t size, Use how);

  WindowView window_;
  ListLimits limits_;
  std::vector<std::uint8_t> cells_;
  std::vector<std::uint32_t> numbers_;  // by cell: of the step that lies there; 0 for none yet
  ListSummary summary_;
  std::uint32_t loop_start_{0};
  bool is_in_loop_{false};   // the second time through
  bool has_way_out_{false};  // within the loop
  bool may_scan_{true};      // what ran before is not known
  bool must_flush_{false};
};

Result<ListSummary> Walk::run(std::uint32_t head) {
  std::uint32_t at = head;
  while (true) {
    const auto step = descriptor_at(window_, at);
    if (!step) {
      return malformed("step " + std::to_string(summary_.steps + 1) + " would be at " + hex(at) +
                       ": no descriptor can lie there");
    }
    std::uint32_t& number = numbers_[cell_of(at)];
    if (number == 0) number = ++summary_.steps;
    const auto next = visit(at);
    if (!next) {
      return tl::unexpected(next.error().in("step " + std::to_string(number) + " at " + hex(at)));
    }
    if (*next == Next::Done) return summary_;
    at = step->link;
  }
}

Result<Walk::Next> Walk::visit(std::uint32_t at) {
  const Descriptor step = *descriptor_at(window_, at);
  if (is_used(at, wire::kDescriptorBytes, Step)) {
    if (is_in_loop_ && at == loop_start_) return end_of_loop(at);
    if (!is_in_loop_) {
      is_in_loop_ = true;
      loop_start_ = at;
    }
  } else if (auto checked = check_first_time(step, at); !checked) {
    return tl::unexpected(checked.error());
  }
  if (auto checked = check_order(step); !checked) return tl::unexpected(checked.error());
  if (is_in_loop_ && step.has(wire::kJump)) has_way_out_ = true;
  return step.has(wire::kStop) ? Next::Done : Next::Follow;
}

Result<Walk::Next> Walk::end_of_loop(std::uint32_t at) {
  if (!has_way_out_) {
    return malformed("the list comes back to " + hex(at) + " and nothing lets it out");
  }
  summary_.loops = true;
  return Next::Done;
}

Result<void> Walk::check_first_time(const Descriptor& step, std::uint32_t at) {
  if (is_used(at, wire::kDescriptorBytes, ReadInto)) {
    return malformed("an earlier step reads into this descriptor");
  }
  use(at, wire::kDescriptorBytes, Step);
  return check_opcode(step).and_then(
      [&] { return step.is_delay() ? check_delay(step) : check_transfer(step); });
}

Result<void> Walk::check_transfer(const Descriptor& step) {
  const auto target = step.target();
  if (!target) {
    return malformed("register " + std::to_string(step.opcode & wire::kRegisterMask) +
                     " does not exist");
  }
  if (auto checked = check_length(*target, step.length, limits_); !checked) return checked;
  summary_.words += step.length;
  if (summary_.words > wire::kMaxListWords) {
    return fail(Errc::TooLarge,
                "the list moves more than " + std::to_string(wire::kMaxListWords) + " words");
  }
  if (step.is_read()) ++summary_.reads;
  return check_buffer(step).and_then([&] { return check_data(step); });
}

Result<void> Walk::check_buffer(const Descriptor& step) {
  if (step.is_immediate()) return {};
  const std::uint64_t size = step.buffer_bytes();
  if (!holds(window_, step.buffer, size)) {
    return malformed("its buffer of " + std::to_string(size) + " bytes at " + hex(step.buffer) +
                     " is not within the window, or not at a multiple of 16");
  }
  if (!step.is_read()) return {};
  if (is_used(step.buffer, size, Step | RunData)) {
    return malformed("it reads into the list itself");
  }
  use(step.buffer, size, ReadInto);
  return {};
}

Result<void> Walk::check_data(const Descriptor& step) {
  if (step.is_read()) return {};
  const Register target = *step.target();
  if (target == Register::Run) return check_run(step);
  if (!step.is_immediate() && is_used(step.buffer, step.buffer_bytes(), ReadInto)) return {};
  const auto words = register_words(window_, step);
  return words ? check_codes(*words) : Result<void>{};  // a port takes any words
}

Result<void> Walk::check_run(const Descriptor& step) {
  ++summary_.runs;
  if (!step.is_immediate()) {
    if (is_used(step.buffer, step.buffer_bytes(), ReadInto)) {
      return malformed("what it runs is only known when the list has read it");
    }
    use(step.buffer, step.buffer_bytes(), RunData);
  }
  const auto words = register_words(window_, step);
  for (int layer = 0; layer < kLayers && !limits_.has_sync; ++layer) {
    const std::uint32_t sync = words->get(field::kSync, layer);
    if (sync == kSyncFrame || sync == kSyncLine) {
      return malformed("a synchronised scan would never end: no sync pulses run");
    }
  }
  return {};
}

// What depends on the steps before.
Result<void> Walk::check_order(const Descriptor& step) {
  const bool is_flush = step.is_delay() && step.length >= kLongestFlush_clocks;
  const bool is_write = !step.is_delay() && !step.is_read();
  const bool must_flush_next = is_write && step.target() == Register::ScanIo;
  // Where the host's next list may begin, nobody knows that it begins with a delay.
  const bool leaves = step.has(wire::kStop) || step.has(wire::kJump);
  if ((must_flush_ && !is_flush) || (must_flush_next && leaves)) {
    return malformed("a write to scan-io needs a delay of " + std::to_string(kLongestFlush_clocks) +
                     " clocks or more behind it");
  }
  must_flush_ = must_flush_next;
  if (step.has(wire::kWait) || step.has(wire::kReset)) may_scan_ = false;
  if (step.is_delay()) return {};
  const RegisterFacts& facts = facts_of(*step.target());
  if (facts.waits && may_scan_) {
    return malformed(std::string(facts.name) +
                     " has to wait for the end of the scan, and does not");
  }
  if (is_write && facts.number == Register::ShowScan && may_scan_) {
    return malformed("show-scan moves while a scan may run: who waits for its end would not");
  }
  if (is_write && facts.number == Register::Run) {
    const auto words = register_words(window_, step);
    may_scan_ = words->words()[0] != 0 || words->words()[1] != 0;  // the bits of sync
  }
  return {};
}

bool Walk::is_used(std::uint32_t offset, std::uint64_t size, std::uint8_t how) const {
  const std::size_t first = cell_of(offset);
  const std::size_t cells = static_cast<std::size_t>(size / wire::kBufferAlignment);
  return std::any_of(cells_.begin() + static_cast<std::ptrdiff_t>(first),
                     cells_.begin() + static_cast<std::ptrdiff_t>(first + cells),
                     [&](std::uint8_t cell) { return (cell & how) != 0; });
}

void Walk::use(std::uint32_t offset, std::uint64_t size, Use how) {
  const std::size_t first = cell_of(offset);
  const std::size_t cells = static_cast<std::size_t>(size / wire::kBufferAlignment);
  for (std::size_t i = first; i < first + cells; ++i) {
    cells_[i] = static_cast<std::uint8_t>(cells_[i] | how);
  }
}

}  // namespace

Result<ListSummary> check_step_list(const WindowView& window, std::uint32_t head,
                                    const ListLimits& limits) {
  if (window.base % wire::kBufferAlignment != 0) {
    return malformed("the window does not begin at a multiple of 16");
  }
  return Walk(window, limits).run(head);
}

}  // namespace thimble::cambus
