#pragma once

#include <memory>
#include <string>

#include "hal/base/result.hpp"
#include "hal/bus/memory_window.hpp"
#include "hal/bus/shared_words.hpp"
#include "hal/linux/bus_error_guard.hpp"
#include "hal/linux/descriptor.hpp"

namespace thimble::linux {

// The largest BAR or file that is mapped. Ours: 64 modules of 2^24 sites are 2 GiB, and no list
// needs them all at once.
inline constexpr std::size_t kMaxWindowBytes = std::size_t{1} << 30;

// A memory BAR of a PCI device through sysfs (`resourceN`, uncached), or a file that two processes
// share (ivshmem).
//
// Thread, RT: as MemoryWindow: a word of PCI that is read takes about a microsecond.
// Ownership: the mapping is its own; the node is closed once it is mapped, which keeps the mapping.
// Errors: as MemoryWindow. A board that was pulled out reads all ones until the kernel takes the
// BAR away; after that, or when the file was cut, Disconnected.
class MappedWindow final : public bus::MemoryWindow {
 public:
  // `node`: opened for reading and writing, by whoever may; `name` stands in messages.
  // Errors: InvalidArgument (empty, or no multiple of 4), TooLarge, Permission, System.
  [[nodiscard]] static Result<std::unique_ptr<MappedWindow>> map(const Descriptor& node,
                                                                 const std::string& name);
  ~MappedWindow() override;
  MappedWindow(const MappedWindow&) = delete;
  MappedWindow& operator=(const MappedWindow&) = delete;

  [[nodiscard]] std::size_t bytes() const noexcept override { return words_.bytes(); }
  IoStatus read(std::uint32_t offset, std::uint32_t& out) noexcept override;
  IoStatus write(std::uint32_t offset, std::uint32_t word) noexcept override;
  IoStatus read_block(std::uint32_t offset, std::span<std::uint32_t> out) noexcept override;
  IoStatus write_block(std::uint32_t offset,
                       std::span<const std::uint32_t> words) noexcept override;
  // An instruction with a lock, which also empties a processor's write-combining buffers.
  void barrier() noexcept override { fence_.fetch_add(1, std::memory_order_seq_cst); }

 private:
  MappedWindow(void* memory, std::size_t bytes) noexcept;
  [[nodiscard]] IoStatus check(std::uint32_t offset, std::size_t words) const noexcept;

  GuardedMapping mapping_;
  bus::SharedWords words_;
  std::atomic<std::uint32_t> fence_{0};
};

}  // namespace thimble::linux
