#include "cli/file_text.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "hal/linux/descriptor.hpp"
#include "hal/linux/replace_file.hpp"

namespace thimble::cli {

std::string refuse_empty_name(const std::string& text) {
  return text.empty() ? "expected a name, found \"\"" : "";
}

Result<std::string> read_at_most(const std::string& file, std::size_t bytes) {
  const auto word = [] { return std::string(": ") + std::strerror(errno); };
  const linux::Descriptor source(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (source.get() < 0) {
    const Errc code = errno == ENOENT ? Errc::NotFound : Errc::System;
    return fail(code, "cannot open it" + word());
  }
  std::string text;
  std::string block(std::size_t{1} << 16, '\0');
  while (text.size() < bytes) {
    const std::size_t wanted = std::min(block.size(), bytes - text.size());
    const ssize_t got = ::read(source.get(), block.data(), wanted);
    if (got == 0) break;
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(Errc::System, "cannot read it" + word());
    text.append(block, 0, static_cast<std::size_t>(got));
  }
  return text;
}

Result<void> write_whole(const std::string& file, const std::string& content) {
  const Result<void> done = linux::replace_file(file, content);
  if (done) return {};
  return fail(done.error().code, "cannot be written: " + done.error().message);
}

}  // namespace thimble::cli
