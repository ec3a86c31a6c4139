#include "daemon/world/io/buffered_source.hpp"

#include <algorithm>

namespace thimble::world {

Result<std::span<const std::byte>> BufferedSource::peek() {
  if (start_ == buffer_.size()) {
    buffer_.resize(kAhead);
    start_ = 0;
    const auto count = inner_.read(buffer_);
    buffer_.resize(count.value_or(0));
    if (!count) return tl::unexpected(count.error());
  }
  return std::span<const std::byte>(buffer_).subspan(start_);
}

void BufferedSource::take(std::size_t count) noexcept {
  start_ += count;
  left_ -= std::min<std::uint64_t>(left_, count);
}

Result<std::size_t> BufferedSource::read(std::span<std::byte> out) {
  const std::size_t known = std::min(out.size(), buffer_.size() - start_);
  std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(start_), known, out.begin());
  take(known);
  if (known == out.size()) return known;
  auto more = inner_.read(out.subspan(known));
  if (!more) return more;
  left_ -= std::min<std::uint64_t>(left_, *more);
  return known + *more;
}

Result<std::uint64_t> BufferedSource::skip(std::uint64_t count) {
  std::uint64_t done = 0;
  while (done < count) {
    const auto ahead = peek();
    if (!ahead) return tl::unexpected(ahead.error());
    if (ahead->empty()) break;
    const auto step =
        static_cast<std::size_t>(std::min<std::uint64_t>(ahead->size(), count - done));
    take(step);
    done += step;
  }
  return done;
}

}  // namespace thimble::world
