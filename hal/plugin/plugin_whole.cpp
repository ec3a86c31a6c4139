#include "hal/plugin/plugin_whole.hpp"

#include <link.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>

namespace thimble::plugin {
namespace {

template <typename T>
[[nodiscard]] bool read_at(std::ifstream& file, std::uint64_t offset, T& out) {
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(reinterpret_cast<char*>(&out), sizeof out);
  return file.good();
}

[[nodiscard]] bool is_object_of_this_machine(const ElfW(Ehdr) & head) noexcept {
  constexpr std::array<unsigned char, SELFMAG> kMagic{ELFMAG0, ELFMAG1, ELFMAG2, ELFMAG3};
  constexpr unsigned char kClass = sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32;
  return std::equal(kMagic.begin(), kMagic.end(), head.e_ident) &&
         head.e_ident[EI_CLASS] == kClass && head.e_phentsize == sizeof(ElfW(Phdr));
}

}  // namespace

Result<void> check_object_is_whole(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return fail(Errc::System, "cannot be opened");
  const auto size = static_cast<std::uint64_t>(file.tellg());
  const Error cut_short{Errc::Malformed, "is cut short: it has fewer bytes than its head says"};
  ElfW(Ehdr) head{};
  if (!read_at(file, 0, head) || !is_object_of_this_machine(head)) return {};
  for (std::uint64_t i = 0; i < head.e_phnum; ++i) {
    ElfW(Phdr) segment{};
    if (head.e_phoff > size || !read_at(file, head.e_phoff + i * sizeof segment, segment)) {
      return tl::unexpected(cut_short);
    }
    const bool is_inside = segment.p_offset <= size && segment.p_filesz <= size - segment.p_offset;
    if (segment.p_type == PT_LOAD && !is_inside) return tl::unexpected(cut_short);
  }
  return {};
}

}  // namespace thimble::plugin
