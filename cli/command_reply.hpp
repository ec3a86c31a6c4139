#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "daemon/api/status.hpp"
#include "hal/base/result.hpp"

namespace thimble::cli {

// What the daemon answers to a command that has come true (docs/api.md), made harmless.
struct CommandReply {
  std::string arm;
  std::string lease;
  std::uint64_t lease_number{0};  // 0: no client's
  std::string state;
  std::string instruction;
};

// The answer to a command for `arm`. Total; Malformed when a member is missing or no text, or when
// it tells of another arm: nobody may take that for a command that has come true.
[[nodiscard]] Result<CommandReply> parse_command_reply(std::string_view json, std::string_view arm);
// Likewise of an edit of `world`: how many cells have changed.
[[nodiscard]] Result<std::uint64_t> parse_changed_cells(std::string_view json,
                                                        std::string_view world);
// Likewise of what was done to the pieces of `world`, or why it was not.
struct PieceReply {
  std::string outcome;
  bool is_done{false};
};
[[nodiscard]] Result<PieceReply> parse_piece_reply(std::string_view json, std::string_view world);
// Likewise of a saved state that `world` was given: Malformed unless it tells of that world.
[[nodiscard]] Result<void> check_loaded_state(std::string_view json, std::string_view world);
// Whether `body`, which is no JSON, is a state such as a world takes back; Malformed, in the name
// of `world`. Of which world it is it does not say, and nobody checks. Total.
[[nodiscard]] Result<void> check_saved_state(std::string_view body, std::string_view world);
// Whether the lease that `reply` tells of still stands, as a client's.
[[nodiscard]] bool still_stands(const CommandReply& reply, const api::Status& status);
// What came of `verb` ("activate", "deactivate", "clear-fault", "impedance", "free" or "reset"),
// for a person: no line break.
[[nodiscard]] std::string render_reply(std::string_view verb, const CommandReply& reply);

}  // namespace thimble::cli
