#include "cli/file_text.hpp"

#include <algorithm>
#include <fstream>

#include "hal/linux/replace_file.hpp"

namespace thimble::cli {

Result<std::string> read_at_most(const std::string& file, std::size_t bytes) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return fail(Errc::NotFound, "cannot open it");
  std::string text;
  std::string block(std::size_t{1} << 16, '\0');
  while (text.size() < bytes && stream) {
    const std::size_t wanted = std::min(block.size(), bytes - text.size());
    stream.read(block.data(), static_cast<std::streamsize>(wanted));
    text.append(block, 0, static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) return fail(Errc::System, "cannot read it");
  return text;
}

Result<void> write_whole(const std::string& file, const std::string& content) {
  const Result<void> done = linux::replace_file(file, content);
  if (done) return {};
  return fail(done.error().code, "cannot be written: " + done.error().message);
}

}  // namespace thimble::cli
