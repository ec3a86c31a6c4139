#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/api/edits.hpp"
#include "daemon/api/request.hpp"
#include "daemon/world/edit_queue.hpp"
#include "hal/base/check.hpp"

namespace {

using thimble::api::CellEdit;
using thimble::world::Cell;

Cell cell_of(const std::array<std::int32_t, 3>& index) { return {index[0], index[1], index[2]}; }

// What was read is judged by a world, and what it takes comes to its end in the slices that it
// promised.
void apply(const std::vector<CellEdit>& edits) {
  using thimble::world::EditQueue;
  auto grid = thimble::world::VoxelGrid::create({8, 9, 10}, 0.001);
  THIMBLE_CHECK(grid.has_value());
  thimble::world::VoxelWorld world(*std::move(grid), "fuzz");
  EditQueue queue(world);
  std::vector<thimble::world::CellEdit> asked;
  for (const CellEdit& edit : edits) {
    // The kinds of both are in the same order.
    asked.push_back({static_cast<thimble::world::CellEdit::Kind>(edit.kind),
                     cell_of(edit.min),
                     cell_of(edit.max),
                     {edit.center_m[0], edit.center_m[1], edit.center_m[2]},
                     edit.radius_m,
                     edit.cell});
  }
  const bool is_taken = queue.submit(std::move(asked)).has_value();
  THIMBLE_CHECK(is_taken != queue.is_idle());
  for (std::size_t words = 0; words <= edits.size() * 90; words += EditQueue::kSliceWords) {
    queue.step();
  }
  THIMBLE_CHECK(queue.is_idle());
  THIMBLE_CHECK(world.occupied_cells() == world.grid()->count_occupied());
}

}  // namespace

// "METHOD TARGET BODY", split at the first two spaces.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const std::size_t first = input.find(' ');
  const std::string_view method = input.substr(0, first);
  const std::string_view rest = first == std::string_view::npos ? "" : input.substr(first + 1);
  const std::size_t second = rest.find(' ');
  const std::string_view target = rest.substr(0, second);
  const std::string_view body = second == std::string_view::npos ? "" : rest.substr(second + 1);

  using thimble::api::ActionKind;
  const auto result = thimble::api::parse_request(method, target, body);
  if (!result) {
    THIMBLE_CHECK(result.error().http_status >= 400 && result.error().http_status < 500);
    THIMBLE_CHECK(!thimble::api::to_json(result.error()).empty());
    return 0;
  }
  const bool is_status = result->kind == ActionKind::Status;
  THIMBLE_CHECK(method == (is_status ? "GET" : "POST"));
  THIMBLE_CHECK(result->name.empty() == is_status);
  const bool has_edits = result->kind == ActionKind::EditWorld;
  THIMBLE_CHECK(has_edits == !result->edits.empty());
  THIMBLE_CHECK(result->edits.size() <= thimble::api::kMaxEdits);
  if (has_edits) apply(result->edits);
  return 0;
}
