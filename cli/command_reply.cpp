#include "cli/command_reply.hpp"

#include <algorithm>

#include "cli/status_document.hpp"
#include "cli/text.hpp"
#include "daemon/world/cam/automaton_file.hpp"

namespace thimble::cli {
namespace {

std::string next_step(const CommandReply& reply) {
  return reply.instruction.empty() ? "" : ": " + reply.instruction;
}

std::string render_activation(const CommandReply& reply) {
  const bool is_active = reply.state == "active";
  std::string line = "arm " + reply.arm;
  if (reply.lease == "client") {
    line += is_active ? " is active while this runs" : " is held while this runs";
  } else {
    line += (is_active ? " is kept active by the " : " is held by the ") + reply.lease;
  }
  if (is_active) return line;
  return line + ", but not active yet (" + reply.state + ")" + next_step(reply);
}

tl::unexpected<Error> not_the_daemons(const std::string& missed) {
  return fail(Errc::Malformed, "the answer is not the daemon's: it does not tell of " + missed);
}

}  // namespace

Result<CommandReply> parse_command_reply(std::string_view json, std::string_view arm) {
  const auto name = parse_member(json, "arm");
  const auto lease = parse_member(json, "lease");
  const auto lease_number = parse_count(json, "lease_number");
  const auto state = parse_member(json, "state");
  const auto instruction = parse_member(json, "instruction");
  if (name != arm || !lease || !lease_number || !state || !instruction) {
    return not_the_daemons("arm " + plain(arm) + " with its lease and state");
  }
  return CommandReply{plain(*name), plain(*lease), *lease_number, plain(*state),
                      plain(*instruction)};
}

Result<std::uint64_t> parse_changed_cells(std::string_view json, std::string_view world) {
  const auto changed = parse_count(json, "changed_cells");
  if (parse_member(json, "world") != world || !changed) {
    return not_the_daemons("the changed cells of world " + plain(world));
  }
  return *changed;
}

Result<PieceReply> parse_piece_reply(std::string_view json, std::string_view world) {
  const auto outcome = parse_member(json, "outcome");
  const auto is_done = parse_flag(json, "is_done");
  if (parse_member(json, "world") != world || !outcome || !is_done) {
    return not_the_daemons("what was done to the pieces of world " + plain(world));
  }
  return PieceReply{plain(*outcome), *is_done};
}

Result<void> check_loaded_state(std::string_view json, std::string_view world) {
  if (parse_member(json, "world") != world || !parse_count(json, "steps")) {
    return not_the_daemons("the steps of world " + plain(world));
  }
  return {};
}

Result<void> check_saved_state(std::string_view body, std::string_view world) {
  if (!world::cam::parse_state(body)) return not_the_daemons("the state of world " + plain(world));
  return {};
}

bool still_stands(const CommandReply& reply, const api::Status& status) {
  return std::any_of(status.arms.begin(), status.arms.end(), [&](const api::ArmStatus& arm) {
    return arm.name == reply.arm && arm.lease == "client" && arm.lease_number == reply.lease_number;
  });
}

std::string render_reply(std::string_view verb, const CommandReply& reply) {
  if (verb == "activate") return render_activation(reply);
  if (verb == "clear-fault") {
    return "arm " + reply.arm + ": the fault is cleared, the arm is " + reply.state +
           next_step(reply);
  }
  if (verb == "free") return "arm " + reply.arm + ": its world was asked to switch free motion";
  if (verb == "reset") return "arm " + reply.arm + ": its world was asked for a reset";
  return "arm " + reply.arm + ": " + std::string(verb) + " done";
}

}  // namespace thimble::cli
