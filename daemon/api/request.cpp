#include "daemon/api/request.hpp"

#include <algorithm>
#include <array>
#include <boost/json.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "daemon/api/edits.hpp"
#include "daemon/api/json_text.hpp"
#include "daemon/api/request_body.hpp"

namespace thimble::api {
namespace {

constexpr std::string_view kArms = "/v1/arms/";
constexpr std::string_view kWorlds = "/v1/worlds/";
constexpr std::size_t kMaxNameBytes = 32;

struct Verb {
  std::string_view folder;
  std::string_view word;
  ActionKind kind;
  PieceVerb piece_verb{};
  HandVerb hand_verb{};
};
constexpr std::array<Verb, 15> kVerbs{{
    {kArms, "activate", ActionKind::Activate},
    {kArms, "deactivate", ActionKind::Deactivate},
    {kArms, "clear-fault", ActionKind::ClearFault},
    {kArms, "steady-force", ActionKind::SteadyForce},
    {kArms, "impedance", ActionKind::SetImpedance},
    {kArms, "free", ActionKind::AskWorld, {}, HandVerb::Free},
    {kArms, "reset", ActionKind::AskWorld, {}, HandVerb::Reset},
    {kWorlds, "edits", ActionKind::EditWorld},
    {kWorlds, "state", ActionKind::SaveWorld},
    {kWorlds, "cells", ActionKind::ReadCells},
    {kWorlds, "select", ActionKind::ActOnPieces, PieceVerb::Select},
    {kWorlds, "drop", ActionKind::ActOnPieces, PieceVerb::Drop},
    {kWorlds, "delete", ActionKind::ActOnPieces, PieceVerb::Delete},
    {kWorlds, "free", ActionKind::ActOnPieces, PieceVerb::Free},
    {kWorlds, "reset", ActionKind::ActOnPieces, PieceVerb::Reset},
}};

bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= kMaxNameBytes &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
         });
}

std::optional<Action> parse_target(std::string_view target) {
  if (target == "/v1/status") return Action{ActionKind::Status, ""};
  const std::string_view folder = target.starts_with(kArms) ? kArms : kWorlds;
  if (!target.starts_with(folder)) return std::nullopt;
  target.remove_prefix(folder.size());
  const std::size_t slash = target.find('/');
  if (slash == std::string_view::npos || !is_name(target.substr(0, slash))) return std::nullopt;
  const std::string_view word = target.substr(slash + 1);
  const auto* verb = std::find_if(kVerbs.begin(), kVerbs.end(), [&](const Verb& candidate) {
    return candidate.folder == folder && candidate.word == word;
  });
  if (verb == kVerbs.end()) return std::nullopt;
  Action action{verb->kind, std::string(target.substr(0, slash))};
  action.piece_verb = verb->piece_verb;
  action.hand_verb = verb->hand_verb;
  return action;
}

// Which fault is meant; nothing where the body leaves it open.
tl::expected<std::optional<std::uint32_t>, RequestError> read_fault(
    const boost::json::value& document) {
  const boost::json::object* parameters = document.if_object();
  const boost::json::value* said =
      parameters == nullptr ? nullptr : parameters->if_contains("fault");
  if (parameters == nullptr || parameters->size() != (said == nullptr ? 0U : 1U)) {
    return malformed("this takes no body, or one such as {\"fault\": 3}");
  }
  if (said == nullptr) return std::nullopt;
  const std::int64_t* number = said->if_int64();
  if (number == nullptr || *number < 1 || *number > std::numeric_limits<std::uint32_t>::max()) {
    return malformed("fault: expected the number that the status gives the fault, from 1");
  }
  return static_cast<std::uint32_t>(*number);
}

// The one member of the body, a number; nothing where it is not so.
std::optional<double> read_only_number(const boost::json::value& document, std::string_view key) {
  const boost::json::object* parameters = document.if_object();
  const boost::json::value* said = parameters == nullptr ? nullptr : parameters->if_contains(key);
  if (said == nullptr || parameters->size() != 1) return std::nullopt;
  boost::system::error_code wrong;
  const double number = said->to_number<double>(wrong);
  if (wrong) return std::nullopt;
  return number;
}

// How strong; nothing where it shall end.
tl::expected<std::optional<double>, RequestError> read_steady(const boost::json::value& document) {
  const boost::json::object* parameters = document.if_object();
  if (parameters != nullptr && parameters->empty()) return std::nullopt;
  const auto up_newton = read_only_number(document, "up_newton");
  if (up_newton && std::abs(*up_newton) <= kMostSteady_newton) return up_newton;
  return malformed("this takes no body, or one such as {\"up_newton\": -2.5}, from -8 to 8");
}

tl::expected<double, RequestError> read_impedance(const boost::json::value& document) {
  const auto b = read_only_number(document, "newton_s_per_m");
  if (b && *b >= kLeastImpedance_newton_s_per_m && *b <= kMostImpedance_newton_s_per_m) return *b;
  return malformed("this takes a body such as {\"newton_s_per_m\": 10}, from 0.1 to 40");
}

// `action` with what the body says to it.
tl::expected<Action, RequestError> read_parameters(Action action,
                                                   const boost::json::value& document) {
  if (action.kind == ActionKind::EditWorld) {
    auto edits = parse_edits(document);
    if (!edits) return tl::unexpected(std::move(edits.error()));
    action.edits = *std::move(edits);
    return action;
  }
  if (action.kind == ActionKind::ClearFault) {
    const auto fault = read_fault(document);
    if (!fault) return tl::unexpected(fault.error());
    action.fault = *fault;
    return action;
  }
  if (action.kind == ActionKind::SteadyForce) {
    const auto up_newton = read_steady(document);
    if (!up_newton) return tl::unexpected(up_newton.error());
    action.up_newton = *up_newton;
    return action;
  }
  if (action.kind == ActionKind::SetImpedance) {
    const auto b = read_impedance(document);
    if (!b) return tl::unexpected(b.error());
    action.newton_s_per_m = *b;
    return action;
  }
  // Nothing else takes parameters yet; refusing them now leaves their meaning free.
  const boost::json::object* parameters = document.if_object();
  if (parameters == nullptr || !parameters->empty()) {
    return malformed("this takes no body");
  }
  return action;
}

// What a method does with what the target names; nothing where it does not go with it.
std::string_view allowed_methods(ActionKind kind) {
  if (kind == ActionKind::Status || kind == ActionKind::ReadCells) return "GET";
  return kind == ActionKind::SaveWorld ? "GET, PUT" : "POST";
}

unsigned http_status_of(Errc code) {
  switch (code) {
    case Errc::InvalidArgument:
    case Errc::Malformed:
      return 400;
    case Errc::Permission:
      return 403;
    case Errc::NotFound:
      return 404;
    case Errc::Busy:
    case Errc::NotMine:
    case Errc::Disconnected:
      return 409;
    case Errc::TooLarge:
      return 413;
    case Errc::Unsupported:
      return 501;
    case Errc::Timeout:
      return 504;
    case Errc::System:
      return 500;
  }
  return 500;
}

}  // namespace

tl::unexpected<RequestError> malformed(std::string message) {
  return tl::unexpected(RequestError{400, "malformed", std::move(message), ""});
}

bool may_bring_state(std::string_view target) {
  const auto action = parse_target(target);
  return action && action->kind == ActionKind::SaveWorld;
}

tl::expected<Action, RequestError> parse_request(std::string_view method, std::string_view target,
                                                 std::string_view body) {
  auto action = parse_target(target);
  if (!action) {
    return tl::unexpected(RequestError{404, "not-found",
                                       "there is only /v1/status, /v1/arms/NAME/activate, "
                                       "deactivate, clear-fault, steady-force, impedance, free and "
                                       "reset, and "
                                       "/v1/worlds/NAME/edits, state, cells, select, "
                                       "drop, delete, free and reset",
                                       ""});
  }
  const std::string_view allowed = allowed_methods(action->kind);
  if (action->kind == ActionKind::SaveWorld && method == "PUT") {
    action->kind = ActionKind::LoadWorld;
    action->state = body;
    return *std::move(action);
  }
  if (method != allowed.substr(0, allowed.find(','))) {
    return tl::unexpected(RequestError{405, "method-not-allowed",
                                       "this takes " + std::string(allowed) + " only",
                                       std::string(allowed)});
  }
  // Every body goes through here, so that no key is said twice in any of them.
  const auto document = parse_body(body.empty() ? "{}" : body);
  if (!document) return tl::unexpected(document.error());
  return read_parameters(*std::move(action), *document);
}

RequestError to_request_error(const Error& error) {
  std::string code(to_string(error.code));
  std::replace(code.begin(), code.end(), ' ', '-');
  return {http_status_of(error.code), std::move(code), error.message, ""};
}

std::string to_json(const RequestError& error) {
  return to_text(boost::json::object{
      {"error", boost::json::object{{"code", error.code}, {"message", error.message}}}});
}

}  // namespace thimble::api
