#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "daemon/api/commands.hpp"
#include "daemon/app/paced_work.hpp"
#include "daemon/app/piece_actions.hpp"
#include "daemon/session/runtime.hpp"

namespace thimble::app {

// Reads whole worlds for clients, and puts them back: each in its turn (PacedWork), for it takes
// milliseconds of the thread that serves all others.
//
// Thread: the net plane's one thread. Not RT. Ownership: runtime, pieces and clock must outlive it.
// Errors: NotFound at once for a world that is not there, else as WorldHost has them.
class WholeWorlds {
 public:
  WholeWorlds(session::Runtime& runtime, PieceActions& pieces, const Clock& clock)
      : runtime_(runtime), pieces_(pieces), paced_(clock), looks_(clock) {}
  WholeWorlds(const WholeWorlds&) = delete;
  WholeWorlds& operator=(const WholeWorlds&) = delete;

  // As api::Commands has them. Of pieces the board is looked at when it is their turn, which takes
  // PieceActions::kPatience at most: one after the other, and beside what other worlds are asked
  // for.
  void read_cells(std::string_view world, api::ClientId client, api::FileAnswer answer);
  void save(std::string_view world, api::ClientId client, api::FileAnswer answer);
  void load(std::string_view world, std::string state, api::ClientId client,
            api::LoadAnswer answer);
  void client_gone(api::ClientId client) {
    paced_.client_gone(client);
    looks_.client_gone(client);
  }
  // Call it every few ms.
  void poll() {
    paced_.poll();
    if (look_.expired()) looks_.poll();
  }

 private:
  session::Runtime& runtime_;
  PieceActions& pieces_;
  PacedWork paced_;
  PacedWork looks_;  // at boards, which take long, but not of this thread
  struct Look {};
  std::weak_ptr<Look> look_;  // lives as long as somebody waits for one
};

}  // namespace thimble::app
