#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "hal/base/result.hpp"

namespace thimble::api {

// One connection; never used twice while the daemon runs.
struct ClientId {
  std::uint64_t value{0};
  auto operator<=>(const ClientId&) const = default;
};

// A command that was carried out: how the arm stood when it had come true.
struct Done {
  std::string state;        // OperatingState in words
  std::string instruction;  // what the person has to do next; empty when nothing
};
using Answer = std::function<void(const Result<Done>&)>;

// What a client may ask of the daemon. An arm that a client activated is that client's lease:
// client_gone() must release it.
//
// Thread: the net thread; must not block. What takes the servo's time is answered later: each
// `answer` is called once, within the call or within a bounded time, and not after
// client_gone() of its client.
// Errors: NotFound for an unknown arm, Busy when the state or another lease forbids it,
//         Disconnected for a lost arm, Timeout when it did not come true in time.
class Commands {
 public:
  virtual ~Commands() = default;
  virtual void activate(std::string_view arm, ClientId client, Answer answer) = 0;
  virtual void deactivate(std::string_view arm, ClientId client, Answer answer) = 0;
  virtual void clear_fault(std::string_view arm, ClientId client, Answer answer) = 0;
  // Called once for every client that sent a command, after its last one.
  virtual void client_gone(ClientId client) = 0;
};

}  // namespace thimble::api
