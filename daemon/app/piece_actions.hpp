#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "daemon/api/commands.hpp"
#include "daemon/session/runtime.hpp"

namespace thimble::app {

// Takes what clients want done to pieces, and tells what came of it. A board that is slow may keep
// them waiting: kPatience, then the answer is Timeout, and what was not begun is withdrawn; what
// was may yet be done.
//
// Thread: the net plane's one thread. Not RT. Ownership: the runtime and the clock must outlive it.
class PieceActions {
 public:
  // Ours: beside the 5 s that the command line waits.
  static constexpr Duration kPatience = std::chrono::seconds(3);

  PieceActions(session::Runtime& runtime, const Clock& clock) : runtime_(runtime), clock_(clock) {}

  void submit(std::string_view world, api::PieceVerb verb, api::ClientId client,
              api::PieceAnswer answer);
  // Has the board looked at, so that WorldHost::cells() are those of now. A world without pieces is
  // a mistake of the caller.
  using Looked = std::function<void(const Result<void>&)>;
  void look(session::WorldHost& host, api::ClientId client, Looked answer);
  // Its answers do not come; what it asked for is done all the same, but for looks that have not
  // begun.
  void client_gone(api::ClientId client);
  // Answers what has been done. Call it every few ms.
  void poll();

 private:
  struct Wait {
    session::WorldHost* world{nullptr};
    std::uint64_t number{0};
    api::ClientId client{};
    MonotonicTime until{};
    api::PieceAnswer answer;
    bool is_look{false};
  };
  session::Runtime& runtime_;
  const Clock& clock_;
  std::vector<Wait> waits_;
};

}  // namespace thimble::app
