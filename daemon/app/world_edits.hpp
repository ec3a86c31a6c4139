#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "daemon/api/commands.hpp"
#include "daemon/session/runtime.hpp"

namespace thimble::app {

// Takes clients' edits to the worlds and tells when they are in. Worlds, links and clients share
// one thread, so an edit falls between two answers of its world by itself; the servos see
// nothing of it but the next constraints, by the same buffers as ever.
//
// Thread: the net plane's one thread. Not RT. Ownership: the runtime must outlive it.
class WorldEdits {
 public:
  explicit WorldEdits(session::Runtime& runtime) : runtime_(runtime) {}

  void submit(std::string_view world, const std::vector<api::CellEdit>& edits, api::ClientId client,
              api::EditAnswer answer);
  // Its requests that have not begun are dropped, one that has stays; its answers do not come.
  void client_gone(api::ClientId client);
  // Answers those whose edits are applied. Call it every few ms.
  void poll();

 private:
  struct Wait {
    session::WorldHost* world{nullptr};
    std::uint64_t batch{0};
    std::size_t edits{0};
    api::ClientId client{};
    api::EditAnswer answer;
  };
  session::Runtime& runtime_;
  std::vector<Wait> waits_;
};

}  // namespace thimble::app
