#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/model/cam/cam_registers.hpp"

namespace thimble::sim::cam {

// Bits of the interrupt flags (docs/cambus.md, register 26).
inline constexpr std::size_t kGlueContention = 2;
inline constexpr std::size_t kRegisterLength = 7;
inline constexpr std::size_t kUnknownRegister = 8;

// One module: 16 chips with their registers, their DRAM, two lookup tables and event counters.
// What a scan does with them is in cam_scan.hpp. Written from docs/cambus.md, sections 1 and 2.
// Thread: one at a time.
class CamModule {
 public:
  // `is_marked`: the one whose id is 1 after a reset.
  CamModule(int log2_sites, bool is_marked);

  // A frame on the bus, in all layers. Writing the run register does what its flags say before a
  // scan (docs/cambus.md, section 1); the scan itself is the machine's.
  void write(cambus::Register number, std::span<const std::uint16_t> words);
  [[nodiscard]] std::vector<std::uint16_t> read(cambus::Register number, std::uint32_t length);
  // Sets a flag of register 26 in all layers, as who finds such a thing does.
  void flag(std::size_t interrupt);
  // Of a register that does not exist.
  void note_unknown_register();

  // From the interface: everything but DRAM, offset, interrupt flags and DRAM count.
  void reset();

  // Whether the select register, as written last, means this module. `glue_and`: bit n is the AND
  // of what layer n senses on its glue pins.
  [[nodiscard]] bool is_selected(std::uint16_t glue_and) const noexcept;
  // Some enabled interrupt is flagged.
  [[nodiscard]] bool has_interrupt() const noexcept;

  CamRegisters registers;
  std::vector<std::uint16_t> dram;  // by physical address; bit n is layer n's
  std::array<std::vector<std::uint16_t>, 2> tables;
  std::array<std::uint32_t, cambus::kLayers> event_counters{};

  [[nodiscard]] const std::vector<std::uint16_t>& active_table() const noexcept {
    return tables[active_table_];
  }
  [[nodiscard]] std::size_t active_bank() const noexcept { return active_table_; }
  // How often a table was written, so that who keeps something made of it knows.
  [[nodiscard]] std::uint64_t table_writes(std::size_t bank) const noexcept {
    return table_writes_[bank];
  }
  void store(std::size_t layer, std::uint32_t address, bool bit);

 private:
  void write_register(cambus::Register number, std::span<const std::uint16_t> words,
                      std::uint16_t writable);
  void write_table(std::span<const std::uint16_t> words);
  [[nodiscard]] std::vector<std::uint16_t> read_table(std::uint32_t length);
  // Of some layers; each does what its own register says.
  void begin_run(std::uint16_t layers);
  void copy_counts(std::uint16_t layers);
  void kick(std::uint16_t layers);

  bool is_marked_;
  std::size_t active_table_{0};
  std::array<std::uint64_t, 2> table_writes_{};
};

// Arithmetic on 24 bits that the cuts divide into numbers of their own.
struct CutSum {
  std::uint32_t value{0};
  std::uint32_t borrows{0};  // bit n: bit n had to borrow from what is above it
};
[[nodiscard]] CutSum subtract(std::uint32_t a, std::uint32_t b, std::uint32_t cuts) noexcept;
[[nodiscard]] std::uint32_t add(std::uint32_t a, std::uint32_t b, std::uint32_t cuts) noexcept;

}  // namespace thimble::sim::cam
