#include "cli/cam/pattern.hpp"
#include "cli/cam/run.hpp"
#include "sim/model/cam/rules/random_sites.hpp"

namespace thimble::cam {
namespace {

using sim::cam::SiteSpace;
using Sites = std::vector<std::uint16_t>;

// In the middle of the space.
Result<void> put_pattern(const Rule& rule, const SiteSpace& space, const Pattern& pattern,
                         Sites& sites) {
  const auto cells = sim::cam::cells_of(rule, space);
  std::array<std::size_t, 3> first{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (pattern.size[axis] > cells[axis]) {
      return fail(Errc::InvalidArgument, "the pattern is larger than the space");
    }
    first[axis] = (cells[axis] - pattern.size[axis]) / 2;
  }
  for (std::size_t i = 0; i < pattern.cells.size(); ++i) {
    if (!pattern.cells[i]) continue;
    const std::size_t row = i / pattern.size[0];
    sim::cam::set_cell(rule, space, sites,
                       {first[0] + i % pattern.size[0], first[1] + row % pattern.size[1],
                        first[2] + row / pattern.size[1]});
  }
  return {};
}

}  // namespace

Result<Sites> first_sites(const Rule& rule, const SiteSpace& space, const RunOptions& options) {
  const bool has_pattern = !options.pattern.empty();
  Sites sites =
      sim::cam::random_sites(rule, space, {.seed = options.seed, .is_for_pattern = has_pattern});
  if (!has_pattern) return sites;
  const auto pattern = read_pattern(options.pattern);
  if (!pattern) return tl::unexpected(pattern.error());
  if (const auto put = put_pattern(rule, space, *pattern, sites); !put) {
    return tl::unexpected(put.error().in(options.pattern));
  }
  return sites;
}

}  // namespace thimble::cam
