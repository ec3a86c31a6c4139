#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "hal/bus/memory_window.hpp"

namespace thimble::test {

// One implementation of bus::MemoryWindow together with the board's end of its memory, which is
// looked at byte by byte.
class MemoryRig {
 public:
  using Bytes = std::vector<std::uint8_t>;
  static constexpr std::size_t kBytes = 4096;

  virtual ~MemoryRig() = default;
  virtual bus::MemoryWindow& window() = 0;  // of kBytes
  virtual Bytes board_sees() = 0;           // all of it
  virtual void board_puts(std::size_t offset, const Bytes& bytes) = 0;
  virtual void unplug() = 0;
};

// How the suite makes a fresh rig for every test.
struct MemoryRigFactory {
  std::string name;
  std::unique_ptr<MemoryRig> (*make)();
  friend void PrintTo(const MemoryRigFactory& factory, std::ostream* out) { *out << factory.name; }
};

}  // namespace thimble::test
