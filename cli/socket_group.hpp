#pragma once

#include <sys/types.h>

#include <string>

namespace thimble::cli {

// What to tell a person whom a socket keeps out. Thread: one (it asks the machine's accounts). Not
// RT. Errors: none; what cannot be found out is left out of the advice.

// Whether a person may be told to join the group: not root's, not one that lets its members do
// more than talk to the daemon, not the own one of an account.
[[nodiscard]] bool is_for_people(gid_t number, const std::string& name);
// The end of a sentence, from its ";" on: how to get at the socket of that path.
[[nodiscard]] std::string advice_to_join(const std::string& socket_path);

}  // namespace thimble::cli
