#include "cli/command_reply.hpp"

#include "cli/status_document.hpp"
#include "cli/text.hpp"

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

}  // namespace

CommandReply parse_command_reply(std::string_view json) {
  return {plain(parse_member(json, "arm")), plain(parse_member(json, "lease")),
          plain(parse_member(json, "state")), plain(parse_member(json, "instruction"))};
}

std::string render_reply(std::string_view verb, const CommandReply& reply) {
  if (verb == "activate") return render_activation(reply);
  if (verb == "clear-fault") {
    return "arm " + reply.arm + ": the fault is cleared, the arm is " + reply.state +
           next_step(reply);
  }
  return "arm " + reply.arm + ": " + std::string(verb) + " done";
}

}  // namespace thimble::cli
