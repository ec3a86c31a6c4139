#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "drivers/cambus/list_player.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "hal/bus/memory_window.hpp"

namespace {

using thimble::IoStatus;

// A window whose every word is the next one of the input; after its end nobody answers.
class SaidWords final : public thimble::bus::MemoryWindow {
 public:
  static constexpr std::size_t kBytes = 0x2000;

  explicit SaidWords(std::span<const std::uint8_t> said) : said_(said) {}
  [[nodiscard]] std::size_t bytes() const noexcept override { return kBytes; }
  IoStatus read(std::uint32_t offset, std::uint32_t& out) noexcept override {
    return read_block(offset, {&out, 1});
  }
  IoStatus write(std::uint32_t offset, std::uint32_t word) noexcept override {
    return write_block(offset, {&word, 1});
  }
  IoStatus read_block(std::uint32_t offset, std::span<std::uint32_t> out) noexcept override {
    if (!thimble::bus::lies_within(kBytes, offset, out.size())) std::abort();
    for (std::uint32_t& word : out) word = next();
    return IoStatus::Ok;
  }
  IoStatus write_block(std::uint32_t offset,
                       std::span<const std::uint32_t> words) noexcept override {
    if (!thimble::bus::lies_within(kBytes, offset, words.size())) std::abort();
    return IoStatus::Ok;
  }
  void barrier() noexcept override {}

 private:
  std::uint32_t next() noexcept {
    if (said_.size() < 4) return thimble::bus::kNobodyAnswers;
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 4; ++i) word |= std::uint32_t{said_[i]} << (8 * i);
    said_ = said_.subspan(4);
    return word;
  }

  std::span<const std::uint8_t> said_;
};

}  // namespace

// Whatever a board says, nothing outside its window is touched, and no list outlasts its patience.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace cambus = thimble::cambus;
  constexpr auto kPatience = std::chrono::milliseconds(20);
  thimble::MonotonicTime now{};
  auto port = cambus::PciPort::open(std::make_unique<SaidWords>(std::span(data, size)), now);
  if (!port) return 0;
  cambus::ListPlayer player(**port, {});
  for (int i = 0; i < 8; ++i) {
    cambus::StepListBuilder builder;
    const cambus::ReadSlot slot = builder.read(cambus::Register::Event, 25);
    if (!player.start(builder.finish(), kPatience, now)) continue;
    const auto start = now;
    auto is_over = player.poll(now);
    while (is_over && !*is_over) {
      if (now - start > kPatience) std::abort();
      now = now + std::chrono::milliseconds(1);
      is_over = player.poll(now);
    }
    if (player.is_playing()) std::abort();
    const auto words = player.words_of(slot, now);
    if (words && words->size() != slot.words) std::abort();
  }
  return 0;
}
