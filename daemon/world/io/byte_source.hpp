#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "hal/base/result.hpp"

namespace thimble::world {

// Bytes, read once from front to back.
//
// Thread: one. Not RT. Errors: System when the operating system refuses, and what the kind of
// stream adds; the stream is then spent.
class ByteStream {
 public:
  virtual ~ByteStream() = default;
  // Fills `out` as far as there are bytes; fewer only at the end.
  [[nodiscard]] virtual Result<std::size_t> read(std::span<std::byte> out) = 0;
};

// Bytes of known number.
class ByteSource : public ByteStream {
 public:
  // Of all of them, read or not.
  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
};

// Bytes in memory, which must outlive it.
class MemorySource final : public ByteSource {
 public:
  explicit MemorySource(std::span<const std::byte> bytes) : size_(bytes.size()), rest_(bytes) {}
  [[nodiscard]] std::uint64_t size() const noexcept override { return size_; }
  [[nodiscard]] Result<std::size_t> read(std::span<std::byte> out) override;

 private:
  std::uint64_t size_;
  std::span<const std::byte> rest_;
};

// A regular file. NotFound, Permission, or InvalidArgument for anything that is not one (directory,
// FIFO, device: neither opened for data nor waited for). Messages do not repeat the path.
[[nodiscard]] Result<std::unique_ptr<ByteSource>> open_file(const std::string& path);
// The same of a file in `folder` or in a folder below it, as `name` says from there. No symbolic
// link is followed below `folder` and no ".." taken, so that it is in the folder and nowhere else:
// InvalidArgument.
[[nodiscard]] Result<std::unique_ptr<ByteSource>> open_file_below(const std::string& folder,
                                                                  const std::string& name);

}  // namespace thimble::world
