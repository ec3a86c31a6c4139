#include "hal/plugin/loaded_object.hpp"

#include <algorithm>
#include <utility>

namespace thimble::plugin {
namespace {

struct Search {
  std::uintptr_t dynamic_section;  // tells one object from all others
  std::vector<Segment> found;
};

// Called for every object; not 0 ends the search.
int look_at(dl_phdr_info* object, std::size_t, void* context) {
  auto& search = *static_cast<Search*>(context);
  const ElfW(Phdr)* headers = object->dlpi_phdr;
  const ElfW(Phdr)* end = headers + object->dlpi_phnum;
  const bool is_it = std::any_of(headers, end, [&](const ElfW(Phdr) & header) {
    return header.p_type == PT_DYNAMIC &&
           object->dlpi_addr + header.p_vaddr == search.dynamic_section;
  });
  if (!is_it) return 0;
  for (const auto* header = headers; header != end; ++header) {
    if (header->p_type != PT_LOAD) continue;
    search.found.push_back({object->dlpi_addr + header->p_vaddr, header->p_memsz,
                            (header->p_flags & PF_R) != 0, (header->p_flags & PF_X) != 0});
  }
  return 1;
}

}  // namespace

bool is_in(const std::vector<Segment>& segments, const void* start, std::size_t bytes,
           Access access) {
  const auto first = reinterpret_cast<std::uintptr_t>(start);
  return bytes > 0 && std::any_of(segments.begin(), segments.end(), [&](const Segment& segment) {
           const bool is_allowed =
               access == Access::Execute ? segment.is_executable : segment.is_readable;
           return is_allowed && first >= segment.start && bytes <= segment.bytes &&
                  first - segment.start <= segment.bytes - bytes;
         });
}

std::vector<Segment> segments_of(const link_map& object) {
  Search search{reinterpret_cast<std::uintptr_t>(object.l_ld), {}};
  dl_iterate_phdr(&look_at, &search);
  return std::move(search.found);
}

}  // namespace thimble::plugin
