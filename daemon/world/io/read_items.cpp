#include "daemon/world/io/read_items.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

namespace thimble::world {

Result<void> read_items(ByteStream& bytes, ItemType type, NumberSink& sink) {
  constexpr std::uint64_t kItems = 8192;
  const std::uint64_t total = sink.items_left();
  const auto most = static_cast<std::size_t>(std::min(total, kItems));
  std::vector<std::byte> raw(most * type.bytes);
  std::vector<double> values(most);
  while (sink.items_left() > 0) {
    const auto count = static_cast<std::size_t>(std::min(sink.items_left(), kItems));
    const auto wanted = std::span(raw).first(count * type.bytes);
    const auto got = bytes.read(wanted);
    if (!got) return tl::unexpected(got.error());
    if (*got != wanted.size()) {
      const std::uint64_t before = (total - sink.items_left()) * type.bytes;
      return fail(Errc::Malformed, "data: ends after " + std::to_string(before + *got) +
                                       " bytes, its numbers take " +
                                       std::to_string(total * type.bytes));
    }
    decode_items(wanted, type, std::span(values).first(count));
    if (auto put = sink.put(std::span(values).first(count)); !put) return put;
  }
  return {};
}

}  // namespace thimble::world
