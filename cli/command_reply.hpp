#pragma once

#include <string>
#include <string_view>

namespace thimble::cli {

// What the daemon answers to a command that has come true (docs/api.md), made harmless.
struct CommandReply {
  std::string arm;
  std::string lease;
  std::string state;
  std::string instruction;
};

// Total: what is missing is empty.
[[nodiscard]] CommandReply parse_command_reply(std::string_view json);
// What came of `verb` ("activate", "deactivate" or "clear-fault"), for a person: no line break.
[[nodiscard]] std::string render_reply(std::string_view verb, const CommandReply& reply);

}  // namespace thimble::cli
