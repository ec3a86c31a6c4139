#include "daemon/world/io/text_lines.hpp"

#include <algorithm>

namespace thimble::world {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

}  // namespace

Result<bool> TextLines::take_line() {
  line_.clear();
  bool is_any = false;
  for (;;) {
    const auto ahead = text_.peek();
    if (!ahead) return tl::unexpected(ahead.error());
    if (ahead->empty()) return is_any;
    is_any = true;
    const auto* const end =
        std::find(ahead->data(), ahead->data() + ahead->size(), std::byte{'\n'});
    const auto count = static_cast<std::size_t>(end - ahead->data());
    const bool is_whole = count < ahead->size();
    if (line_.size() + count > kMaxLineBytes) {
      return fail(Errc::Malformed,
                  place() + ": longer than " + std::to_string(kMaxLineBytes) + " bytes");
    }
    line_.append(reinterpret_cast<const char*>(ahead->data()), count);
    text_.take(is_whole ? count + 1 : count);
    if (is_whole) return true;
  }
}

Result<bool> TextLines::next() {
  ++number_;
  words_.clear();
  auto taken = take_line();
  if (!taken || !*taken) return taken;
  std::string_view rest = line_;
  for (;;) {
    const std::size_t start = rest.find_first_not_of(kBlanks);
    if (start == std::string_view::npos) return true;
    rest.remove_prefix(start);
    const std::size_t end = std::min(rest.find_first_of(kBlanks), rest.size());
    words_.push_back(rest.substr(0, end));
    rest.remove_prefix(end);
  }
}

}  // namespace thimble::world
