#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace thimble::cli {

// What `thimble world` was told to do; what was not said is empty.
struct WorldEdit {
  std::string verb;  // "fill", "clear", "box" or "paint"; "save" or "load"
  std::vector<std::int32_t> min;
  std::vector<std::int32_t> max;
  std::vector<double> center_m;
  std::optional<double> radius_m;
  std::optional<std::int32_t> cell;
  std::string file{};  // to save to, or load
};

// Whether it is about a world's whole state, and no edit.
[[nodiscard]] bool is_about_state(const WorldEdit& edit);

// What no world could make of it, with the option named: "--cell does not go with clear", "paint
// needs --radius" …; or nothing. Pure.
[[nodiscard]] std::string find_misfit(const WorldEdit& edit);

// The body of the request (docs/api.md). Cells that are not said are all of `world`; what that
// world cannot take, the daemon refuses with its reason. Pure.
[[nodiscard]] std::string body_of(const WorldEdit& edit,
                                  const std::array<std::uint32_t, 3>& world_cells);

}  // namespace thimble::cli
