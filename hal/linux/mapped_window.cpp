#include "hal/linux/mapped_window.hpp"

#include <sys/mman.h>
#include <sys/stat.h>

#include <cerrno>

#include "hal/linux/system_error.hpp"

namespace thimble::linux {

MappedWindow::MappedWindow(void* memory, std::size_t bytes) noexcept
    : mapping_{{static_cast<std::byte*>(memory), bytes}},
      words_({static_cast<std::uint32_t*>(memory), bytes / sizeof(std::uint32_t)}) {}

MappedWindow::~MappedWindow() {
  static_cast<void>(::munmap(mapping_.memory.data(), mapping_.memory.size()));
}

// The size of a `resourceN` is that of its BAR.
Result<std::unique_ptr<MappedWindow>> MappedWindow::map(const Descriptor& node,
                                                        const std::string& name) {
  struct stat facts {};
  if (::fstat(node.get(), &facts) != 0) return tl::unexpected(system_error(name, errno));
  const auto bytes = static_cast<std::size_t>(facts.st_size);
  if (bytes == 0 || bytes % sizeof(std::uint32_t) != 0) {
    return fail(Errc::InvalidArgument, name + ": a window of " + std::to_string(bytes) +
                                           " bytes, which are no words of 32 bits");
  }
  if (bytes > kMaxWindowBytes) {
    return fail(Errc::TooLarge, name + ": a window of " + std::to_string(bytes >> 20) +
                                    " MiB is larger than " + std::to_string(kMaxWindowBytes >> 20));
  }
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, node.get(), 0);
  if (memory == MAP_FAILED) {
    return tl::unexpected(system_error(name + " cannot be mapped", errno));
  }
  return std::unique_ptr<MappedWindow>(new MappedWindow(memory, bytes));
}

IoStatus MappedWindow::check(std::uint32_t offset, std::size_t words) const noexcept {
  if (mapping_.is_gone.load()) return IoStatus::Disconnected;
  return bus::lies_within(bytes(), offset, words) ? IoStatus::Ok : IoStatus::ProtocolError;
}

IoStatus MappedWindow::read(std::uint32_t offset, std::uint32_t& out) noexcept {
  return read_block(offset, {&out, 1});
}

IoStatus MappedWindow::write(std::uint32_t offset, std::uint32_t word) noexcept {
  return write_block(offset, {&word, 1});
}

IoStatus MappedWindow::read_block(std::uint32_t offset, std::span<std::uint32_t> out) noexcept {
  const IoStatus status = check(offset, out.size());
  if (status != IoStatus::Ok) return status;
  const BusErrorGuard guard(mapping_);
  for (std::uint32_t& word : out) {
    const std::uint32_t loaded = words_.load(offset);
    if (mapping_.is_gone.load()) return IoStatus::Disconnected;
    word = loaded;
    offset += sizeof(word);
  }
  return status;
}

IoStatus MappedWindow::write_block(std::uint32_t offset,
                                   std::span<const std::uint32_t> words) noexcept {
  const IoStatus status = check(offset, words.size());
  if (status != IoStatus::Ok) return status;
  const BusErrorGuard guard(mapping_);
  for (const std::uint32_t word : words) {
    words_.store(offset, word);
    offset += sizeof(word);
  }
  return mapping_.is_gone.load() ? IoStatus::Disconnected : status;
}

}  // namespace thimble::linux
