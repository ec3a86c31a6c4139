// The simulated window, bare and in a slot without faults, under its contract suite.
#include "sim/bus/sim_memory_window.hpp"
#include "sim/fault/faulty_memory_window.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/memory_window_contract.hpp"

namespace thimble::test {
namespace {

class SimMemoryRig final : public MemoryRig {
 public:
  explicit SimMemoryRig(bool is_in_slot) {
    window_ = std::make_unique<sim::SimMemoryWindow>(memory_);
    if (is_in_slot) {
      window_ =
          std::make_unique<sim::FaultyMemoryWindow>(std::move(window_), clock_, sim::FaultPlan{});
    }
  }
  bus::MemoryWindow& window() override { return *window_; }
  Bytes board_sees() override {
    Bytes bytes;
    for (std::uint32_t offset = 0; offset < kBytes; offset += 4) {
      const std::uint32_t word = memory_->words().load(offset);
      for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(word >> (8 * i)));
    }
    return bytes;
  }
  void board_puts(std::size_t offset, const Bytes& bytes) override {
    for (std::size_t i = 0; i < bytes.size(); i += 4) {
      std::uint32_t word = 0;
      for (std::size_t k = 0; k < 4; ++k) word |= std::uint32_t{bytes[i + k]} << (8 * k);
      memory_->words().store(static_cast<std::uint32_t>(offset + i), word);
    }
  }
  void unplug() override { memory_->unplug(); }

 private:
  sim::VirtualClock clock_;
  std::shared_ptr<sim::SimMemory> memory_ = std::make_shared<sim::SimMemory>(kBytes);
  std::unique_ptr<bus::MemoryWindow> window_;
};

template <bool kIsInSlot>
std::unique_ptr<MemoryRig> make() {
  return std::make_unique<SimMemoryRig>(kIsInSlot);
}

INSTANTIATE_TEST_SUITE_P(Bus, MemoryWindowContract,
                         testing::Values(MemoryRigFactory{"SimMemoryWindow", &make<false>},
                                         MemoryRigFactory{"FaultyMemoryWindow", &make<true>}),
                         memory_rig_name);

}  // namespace
}  // namespace thimble::test
