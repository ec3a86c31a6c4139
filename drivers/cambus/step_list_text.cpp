#include "drivers/cambus/step_list_text.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

namespace thimble::cambus {
namespace {

constexpr std::size_t kOffsetColumns = 10;
// Larger numbers are addresses and amounts: easier to read in hexadecimal.
constexpr std::uint32_t kLargestDecimal = 255;

std::string number_text(std::uint32_t value) {
  return value > kLargestDecimal ? hex(value) : std::to_string(value);
}

std::string fields_text(const RegisterWords& words, int layer) {
  std::string text;
  for (const Field& of : facts_of(words.number()).fields) {
    const std::uint32_t value = words.get(of, layer);
    if (value == 0) continue;
    text += (text.empty() ? "" : " ") + std::string(of.name) + " " + number_text(value);
  }
  return text.empty() ? "0" : text;
}

// The layers that say the same, in runs: "layers 0-3 …; layers 4-15 …".
std::string layers_text(const RegisterWords& words) {
  std::string text;
  for (int first = 0; first < kLayers;) {
    std::string here = fields_text(words, first);
    int end = first + 1;
    while (end < kLayers && fields_text(words, end) == here) ++end;
    if (first == 0 && end == kLayers) return here;
    text += text.empty() ? "" : "; ";
    text += end - first == 1 ? "layer " + std::to_string(first)
                             : "layers " + std::to_string(first) + "-" + std::to_string(end - 1);
    text += " " + here;
    first = end;
  }
  return text;
}

std::string words_text(const Descriptor& step) {
  const bool is_bytes = step.is_read() && step.has(wire::kByteMode);
  return std::to_string(step.length) + (is_bytes ? " bytes" : " words");
}

std::string transfer_text(const WindowView& window, const Descriptor& step) {
  const auto target = step.target();
  std::string text = step.is_read() ? "read " : "write ";
  text += target ? std::string(facts_of(*target).name)
                 : "register " + std::to_string(step.opcode & wire::kRegisterMask);
  if (step.has(wire::kWait)) text += ", wait";
  if (step.is_read()) return text + ", " + words_text(step) + " to " + hex(step.buffer);
  const auto words = register_words(window, step);
  const bool is_whole = words && step.length == words->words().size();
  if (is_whole) return text + ": " + layers_text(*words);
  const std::string where = step.is_immediate() ? " of " : " from ";
  return text + ", " + words_text(step) + where + hex(step.buffer);
}

std::string delay_text(const Descriptor& step) {
  std::string text = step.has(wire::kReset) ? "reset, " : "delay ";
  text += std::to_string(step.length) + " clocks";
  return step.has(wire::kWait) ? text + ", wait" : text;
}

std::string step_text(const WindowView& window, const Descriptor& step) {
  std::string text = step.is_delay() ? delay_text(step) : transfer_text(window, step);
  if (step.has(wire::kInterrupt)) text += "; interrupt";
  if (step.has(wire::kJump)) text += "; jump";
  if (step.has(wire::kStop)) text += "; stop";
  const std::uint32_t known =
      step.is_read() ? wire::kOpcodeMask : wire::kOpcodeMask & ~wire::kByteMode;
  const std::uint32_t unknown = step.opcode & ~known;
  if (unknown != 0) text += "; unknown bits " + hex(unknown);
  return text;
}

std::string line(std::uint32_t at, const std::string& text) {
  std::string offset = hex(at);
  offset.resize(std::max(offset.size() + 2, kOffsetColumns), ' ');
  return offset + text + "\n";
}

}  // namespace

std::string disassemble(const WindowView& window, std::uint32_t head, std::size_t most_bytes) {
  std::string text;
  std::vector<bool> is_seen(window.bytes.size() / wire::kDescriptorBytes + 1);
  for (std::uint32_t at = head;;) {
    const auto step = descriptor_at(window, at);
    if (!step) return text + line(at, "(no descriptor can lie here)");
    const std::size_t cell = (at - window.base) / wire::kDescriptorBytes;
    if (is_seen[cell]) return text + line(at, "(again, from above)");
    is_seen[cell] = true;
    const std::string told = line(at, step_text(window, *step));
    if (text.size() + told.size() > most_bytes) {
      return text + line(at, "(this and what follows would be a text of more than " +
                                 std::to_string(most_bytes) + " bytes)");
    }
    text += told;
    if (step->has(wire::kStop)) return text;
    at = step->link;
  }
}

}  // namespace thimble::cambus
