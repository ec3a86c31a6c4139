#include "hal/bus/hid_report_descriptor.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace thimble::bus {
namespace {

// Prefix of an item without its two bits of size: HID 1.11, sections 6.2.2.4 and 6.2.2.7.
constexpr std::uint8_t kInput = 0x80;
constexpr std::uint8_t kOutput = 0x90;
constexpr std::uint8_t kReportSize = 0x74;
constexpr std::uint8_t kReportId = 0x84;
constexpr std::uint8_t kReportCount = 0x94;
constexpr std::uint8_t kPush = 0xA4;
constexpr std::uint8_t kPop = 0xB4;
constexpr std::uint8_t kLongItem = 0xFE;
constexpr std::size_t kLongHeaderBytes = 3;  // prefix, size, tag
constexpr std::size_t kIds = 256;
constexpr std::size_t kMaxDepth = 16;
constexpr std::uint64_t kMaxBits = std::uint64_t{1} << 16;

struct Globals {
  std::uint64_t size_bits{0};
  std::uint64_t count{0};
  std::size_t id{0};
};

struct Reader {
  Globals now;
  std::vector<Globals> pushed;
  std::array<std::uint64_t, kIds> input_bits{};
  std::array<std::uint64_t, kIds> output_bits{};
  bool has_ids{false};
};

std::uint8_t byte_at(std::string_view bytes, std::size_t i) {
  return static_cast<std::uint8_t>(bytes[i]);
}

std::uint64_t value_of(std::string_view data) {
  std::uint64_t value = 0;
  for (std::size_t i = data.size(); i > 0; --i) value = value << 8U | byte_at(data, i - 1);
  return value;
}

bool add(std::array<std::uint64_t, kIds>& bits, const Globals& now) {
  if (now.size_bits > kMaxBits || now.count > kMaxBits) return false;
  bits[now.id] += now.size_bits * now.count;
  return bits[now.id] <= kMaxBits;
}

bool pop(Reader& reader) {
  if (reader.pushed.empty()) return false;
  reader.now = reader.pushed.back();
  reader.pushed.pop_back();
  return true;
}

// False when no device may say so.
bool take(Reader& reader, std::uint8_t item, std::uint64_t value) {
  switch (item) {
    case kInput:
      return add(reader.input_bits, reader.now);
    case kOutput:
      return add(reader.output_bits, reader.now);
    case kReportSize:
      reader.now.size_bits = value;
      return true;
    case kReportCount:
      reader.now.count = value;
      return true;
    case kReportId:
      reader.now.id = static_cast<std::size_t>(value % kIds);
      reader.has_ids = true;
      return value > 0 && value < kIds;
    case kPush:
      reader.pushed.push_back(reader.now);
      return reader.pushed.size() <= kMaxDepth;
    case kPop:
      return pop(reader);
    default:
      return true;  // what a field means, not how long it is
  }
}

std::size_t longest(const std::array<std::uint64_t, kIds>& bits, bool has_ids) {
  const std::uint64_t most = *std::max_element(bits.begin(), bits.end());
  if (most == 0) return 0;
  return static_cast<std::size_t>((most + 7) / 8) + (has_ids ? 1 : 0);
}

// A field of `count` bytes; `item` says which way.
void append_bytes(std::vector<std::uint8_t>& bytes, std::uint8_t item, std::size_t count) {
  if (count == 0) return;
  constexpr std::uint8_t kUsage = 0x09;
  constexpr std::uint8_t kVariable = 0x02;  // data, variable, absolute
  const auto low = static_cast<std::uint8_t>(count & 0xFFU);
  const auto high = static_cast<std::uint8_t>(count >> 8U & 0xFFU);
  const std::array<std::uint8_t, 7> field{
      kReportCount | 2U, low, high, kUsage, 1, static_cast<std::uint8_t>(item | 1U), kVariable};
  bytes.insert(bytes.end(), field.begin(), field.end());
}

// Up to the first field.
std::vector<std::uint8_t> plain_beginning() {
  return {0x06,
          0x00,
          0xFF,  // usage page: vendor-defined
          0x09,
          0x01,  // usage
          0xA1,
          0x01,  // collection: application
          0x15,
          0x00,  // logical minimum
          0x26,
          0xFF,
          0x00,  // logical maximum
          kReportSize | 1U,
          0x08};  // fields of one byte
}

constexpr std::uint8_t kEndOfCollection = 0xC0;

}  // namespace

std::vector<std::uint8_t> plain_report_descriptor(const HidReportLengths& lengths) {
  std::vector<std::uint8_t> bytes = plain_beginning();
  append_bytes(bytes, kInput, lengths.input_bytes);
  append_bytes(bytes, kOutput, lengths.output_bytes);
  bytes.push_back(kEndOfCollection);
  return bytes;
}

std::vector<std::uint8_t> plain_report_descriptor(std::span<const HidNumberedReport> reports) {
  std::vector<std::uint8_t> bytes = plain_beginning();
  for (const HidNumberedReport& report : reports) {
    bytes.push_back(kReportId | 1U);
    bytes.push_back(report.number);
    append_bytes(bytes, report.is_output ? kOutput : kInput, report.bytes);
  }
  bytes.push_back(kEndOfCollection);
  return bytes;
}

std::optional<HidReportLengths> parse_report_descriptor(std::string_view bytes) {
  Reader reader;
  while (!bytes.empty()) {
    const std::uint8_t prefix = byte_at(bytes, 0);
    const bool is_long = prefix == kLongItem;
    if (is_long && bytes.size() < kLongHeaderBytes) return std::nullopt;
    const std::size_t header = is_long ? kLongHeaderBytes : 1;
    const std::size_t short_size = (prefix & 3U) == 3 ? 4 : prefix & 3U;
    const std::size_t size = is_long ? byte_at(bytes, 1) : short_size;
    if (bytes.size() < header + size) return std::nullopt;
    const std::uint64_t value = is_long ? 0 : value_of(bytes.substr(header, size));
    const auto item = static_cast<std::uint8_t>(prefix & 0xFCU);
    if (!is_long && !take(reader, item, value)) return std::nullopt;
    bytes.remove_prefix(header + size);
  }
  return HidReportLengths{longest(reader.input_bits, reader.has_ids),
                          longest(reader.output_bits, reader.has_ids), reader.has_ids};
}

}  // namespace thimble::bus
