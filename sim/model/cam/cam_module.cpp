#include "sim/model/cam/cam_module.hpp"

#include <algorithm>

namespace thimble::sim::cam {
namespace {

using cambus::Field;
using cambus::Register;
namespace field = cambus::field;

constexpr std::uint16_t kAllLayers = 0xffff;
constexpr std::uint32_t kCounterMask = (1U << cambus::kEventBits) - 1U;

bool has_layer(std::uint16_t layers, std::size_t layer) { return ((layers >> layer) & 1U) != 0; }

// Where a table is read or written: layer n contributes the bit of its own index that its
// permutation names.
class TablePointer {
 public:
  explicit TablePointer(const CamRegisters& registers) {
    index_ = registers.by_layer(field::kLutIndex[0]);
    source_ = registers.by_layer(field::kLutPerm[0]);
    is_plain_ = true;
    for (std::uint32_t layer = 0; layer < cambus::kLayers; ++layer) {
      is_plain_ = is_plain_ && source_[layer] == layer && index_[layer] == index_[0];
    }
  }
  [[nodiscard]] std::size_t entry() const noexcept {
    if (is_plain_) return index_[0];
    std::size_t entry = 0;
    for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
      const std::uint32_t source = source_[layer];
      const bool is_set =
          source < 16 ? ((index_[layer] >> source) & 1U) != 0 : source == cambus::kConstant1;
      if (is_set) entry |= std::size_t{1} << layer;
    }
    return entry;
  }
  // Whether there is another entry: the transfer ends when the index has come round to 0.
  [[nodiscard]] bool advance() noexcept {
    for (std::uint32_t& index : index_) index = (index + 1) & 0xffffU;
    return index_[0] != 0;
  }
  void store(CamRegisters& registers) const noexcept {
    for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
      registers.set(field::kLutIndex[0], layer, index_[layer]);
    }
  }

 private:
  CamRegisters::ByLayer index_{};
  CamRegisters::ByLayer source_{};
  bool is_plain_{false};  // each layer contributes its own bit of the same index
};

}  // namespace

CutSum subtract(std::uint32_t a, std::uint32_t b, std::uint32_t cuts) noexcept {
  CutSum sum;
  std::uint32_t borrow = 0;
  for (int bit = 0; bit < cambus::kAddressBits; ++bit) {
    const std::uint32_t of_a = (a >> bit) & 1U;
    const std::uint32_t of_b = ((b >> bit) & 1U) + borrow;
    sum.value |= ((of_a - of_b) & 1U) << bit;
    borrow = of_b > of_a ? 1 : 0;
    sum.borrows |= borrow << bit;
    if (((cuts >> bit) & 1U) != 0) borrow = 0;
  }
  return sum;
}

std::uint32_t add(std::uint32_t a, std::uint32_t b, std::uint32_t cuts) noexcept {
  std::uint32_t sum = 0;
  std::uint32_t carry = 0;
  for (int bit = 0; bit < cambus::kAddressBits; ++bit) {
    const std::uint32_t here = ((a >> bit) & 1U) + ((b >> bit) & 1U) + carry;
    sum |= (here & 1U) << bit;
    carry = here >> 1;
    if (((cuts >> bit) & 1U) != 0) carry = 0;
  }
  return sum;
}

CamModule::CamModule(int log2_sites, bool is_marked)
    : dram(std::size_t{1} << log2_sites),
      tables{std::vector<std::uint16_t>(cambus::kTableEntries),
             std::vector<std::uint16_t>(cambus::kTableEntries)},
      is_marked_(is_marked) {
  reset();
}

void CamModule::reset() {
  CamRegisters fresh;
  for (const Register kept : {Register::Offset, Register::IntFlags, Register::DramCount}) {
    fresh.planes(kept) = registers.planes(kept);
  }
  registers = fresh;
  registers.planes(Register::ModuleId)[0] = is_marked_ ? 1 : 0;
  event_counters = {};
  active_table_ = 0;
}

bool CamModule::is_selected(std::uint16_t glue_and) const noexcept {
  for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
    const std::uint32_t source = registers.get(field::kSelect[0], layer);
    const std::uint32_t target = registers.get(field::kSelect[1], layer);
    const std::uint32_t module_id = registers.get(field::kModuleId[0], layer);
    const std::uint32_t group_id = registers.get(field::kGroupId[0], layer);
    const std::uint32_t id = source == cambus::kSourceGroupId ? group_id : module_id;
    const std::uint32_t glue = (glue_and >> layer) & 1U;
    if (target == cambus::kTargetZero && id != 0) return false;
    if (target == cambus::kTargetOne && id != 1) return false;
    if (target == cambus::kTargetTableIndex &&
        id != ((TablePointer(registers).entry() >> layer) & 1U)) {
      return false;
    }
    const bool is_by_glue = target == cambus::kTargetSpecial && source == cambus::kSourceModuleId;
    if (is_by_glue && glue != 0) return false;
  }
  return true;
}

bool CamModule::has_interrupt() const noexcept {
  for (std::size_t bit = 0; bit < field::kInterrupts<Register::IntFlags>.size(); ++bit) {
    const std::uint32_t flags = registers.planes(Register::IntFlags)[bit];
    if ((flags & registers.planes(Register::IntEnable)[bit]) != 0) return true;
  }
  const auto& verify = registers.planes(Register::Verify);
  return (verify[1] & verify[2]) != 0;
}

void CamModule::flag(std::size_t interrupt) {
  registers.planes(Register::IntFlags)[interrupt] = kAllLayers;
}

void CamModule::note_unknown_register() { flag(kUnknownRegister); }

void CamModule::write(Register number, std::span<const std::uint16_t> words) {
  if (number == Register::LutIo) return write_table(words);
  // Layers that verify compare and change nothing, but for the register that turns it off.
  const std::uint16_t verifying =
      number == Register::Verify ? std::uint16_t{0} : registers.planes(Register::Verify)[0];
  const auto written = static_cast<std::uint16_t>(~verifying);
  write_register(number, words, written);
  if (number == Register::Kick) kick(written);
  if (number == Register::Run) begin_run(written);
  if (number == Register::Environment) {
    active_table_ = registers.get(field::kEnvironment[7], 0);
  }
  if (number == Register::Event) {
    for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
      if (!has_layer(written, layer)) continue;
      event_counters[layer] = registers.get(field::kEvent[0], layer);
    }
  }
}

void CamModule::write_register(Register number, std::span<const std::uint16_t> words,
                               std::uint16_t writable) {
  CamRegisters::Planes& planes = registers.planes(number);
  const std::size_t bits = cambus::facts_of(number).bits;
  const std::size_t expected =
      number == Register::Event ? registers.get(field::kEventLength, 0) : bits;
  if (words.size() != expected) flag(kRegisterLength);
  if (writable == 0xffff) {  // nothing verifies
    std::copy_n(words.begin(), std::min(words.size(), bits), planes.begin());
    return;
  }
  for (std::size_t k = 0; k < words.size() && k < bits; ++k) {
    const std::uint16_t old = planes[k];
    const auto differs = static_cast<std::uint16_t>((old ^ words[k]) & ~writable);
    std::uint16_t& flags = registers.planes(Register::Verify)[2];
    flags = static_cast<std::uint16_t>(flags | differs);
    planes[k] = static_cast<std::uint16_t>((old & ~writable) | (words[k] & writable));
  }
}

std::vector<std::uint16_t> CamModule::read(Register number, std::uint32_t length) {
  if (number == Register::LutIo) return read_table(length);
  const CamRegisters::Planes& planes = registers.planes(number);
  const std::size_t bits = cambus::facts_of(number).bits;
  const std::size_t expected =
      number == Register::Event ? registers.get(field::kEventLength, 0) : bits;
  if (length < expected) flag(kRegisterLength);
  std::vector<std::uint16_t> words(length);
  for (std::size_t k = 0; k < words.size() && k < bits; ++k) words[k] = planes[k];
  return words;
}

void CamModule::write_table(std::span<const std::uint16_t> words) {
  std::vector<std::uint16_t>& table = tables[1 - active_table_];
  ++table_writes_[1 - active_table_];
  TablePointer index(registers);
  bool has_ended = false;
  for (const std::uint16_t word : words) {
    if (has_ended) flag(kRegisterLength);
    if (has_ended) break;
    table[index.entry()] = word;
    has_ended = !index.advance();
  }
  index.store(registers);
}

std::vector<std::uint16_t> CamModule::read_table(std::uint32_t length) {
  const std::vector<std::uint16_t>& table = tables[1 - active_table_];
  TablePointer index(registers);
  std::vector<std::uint16_t> words(length);
  for (std::uint16_t& word : words) {
    word = table[index.entry()];
    if (!index.advance()) break;
  }
  index.store(registers);
  return words;
}

void CamModule::begin_run(std::uint16_t layers) {
  const CamRegisters::Planes& run = registers.planes(Register::Run);
  const auto told = [&](const Field& of) {
    return static_cast<std::uint16_t>(run[of.first_bit] & layers);
  };
  copy_counts(told(field::kNewCount));
  if (has_layer(told(field::kNewTable), 0)) {
    active_table_ = 1 - active_table_;
    for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
      registers.set(field::kEnvironment[7], layer, static_cast<std::uint32_t>(active_table_));
    }
  }
  kick(told(field::kRepeatKick));
}

void CamModule::copy_counts(std::uint16_t layers) {
  if (layers == 0) return;
  for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
    if (!has_layer(layers, layer)) continue;
    registers.set(field::kEvent[0], layer, event_counters[layer] & kCounterMask);
    event_counters[layer] = 0;
  }
}

void CamModule::kick(std::uint16_t layers) {
  if (layers == 0) return;
  std::uint32_t moving = 0;  // layers
  const Field& amount = field::kKickAmount;
  for (std::size_t bit = 0; bit < amount.bits; ++bit) {
    moving |= registers.planes(Register::Kick)[amount.first_bit + bit];
  }
  for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
    if (!has_layer(static_cast<std::uint16_t>(layers & moving), layer)) continue;
    const std::uint32_t offset = registers.get(field::kOffset[0], layer);
    const std::uint32_t by = registers.get(amount, layer);
    const std::uint32_t cuts = registers.get(field::kCuts, layer);
    registers.set(field::kOffset[0], layer, subtract(offset, by, cuts).value);
  }
}

void CamModule::store(std::size_t layer, std::uint32_t address, bool bit) {
  std::uint16_t& site = dram[address];
  const bool old = ((site >> layer) & 1U) != 0;
  if (old == bit) return;
  site = static_cast<std::uint16_t>(site ^ (1U << layer));
  const Field& half = field::kDramCount[address >= dram.size() / 2 ? 1 : 0];
  const std::uint32_t count = registers.get(half, layer);
  registers.set(half, layer, bit ? count + 1 : count - 1);
}

}  // namespace thimble::sim::cam
