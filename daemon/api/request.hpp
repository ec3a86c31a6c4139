#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/api/commands.hpp"
#include "hal/base/result.hpp"

namespace thimble::api {

enum class ActionKind : std::uint8_t {
  Status,
  Activate,
  Deactivate,
  ClearFault,
  SteadyForce,
  SetImpedance,
  AskWorld,
  EditWorld,
  ActOnPieces,
  SaveWorld,
  LoadWorld,
  ReadCells
};

// What a request asks for.
struct Action {
  ActionKind kind{};
  std::string name;  // of the arm or world: a-z, 0-9 and -; empty for Status
  std::vector<CellEdit> edits{};
  std::optional<std::uint32_t> fault{};  // ClearFault: its number, where one is named
  std::optional<double> up_newton{};     // SteadyForce: nothing ends it
  double newton_s_per_m{0};              // SetImpedance
  PieceVerb piece_verb{};                // ActOnPieces
  HandVerb hand_verb{};                  // AskWorld
  std::string state{};                   // LoadWorld: the bytes of the file
  bool operator==(const Action&) const = default;
};

// Why it is not done, as it goes out.
struct RequestError {
  unsigned http_status{0};
  std::string code;     // "not-found" …
  std::string message;  // a sentence
  std::string allow;    // value of the Allow header of a 405; else empty
  bool operator==(const RequestError&) const = default;
};

// What is refused as it stands: a 400 with the sentence that says why.
[[nodiscard]] tl::unexpected<RequestError> malformed(std::string message);

// Whether a request for `target` may bring a saved state, which is larger than other bodies.
[[nodiscard]] bool may_bring_state(std::string_view target);

// Pure and total: any bytes give an action or an error.
[[nodiscard]] tl::expected<Action, RequestError> parse_request(std::string_view method,
                                                               std::string_view target,
                                                               std::string_view body);

// The answer to a command that the daemon refused.
[[nodiscard]] RequestError to_request_error(const Error& error);
// {"error": {"code": …, "message": …}}
[[nodiscard]] std::string to_json(const RequestError& error);

}  // namespace thimble::api
