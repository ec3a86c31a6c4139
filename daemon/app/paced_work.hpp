#pragma once

#include <deque>
#include <functional>

#include "daemon/api/commands.hpp"
#include "hal/base/time.hpp"

namespace thimble::app {

// What clients ask for that takes milliseconds of the net plane: one after the other, with a rest
// in between, so that however many ask for however much, links, worlds and commands have most of
// the thread.
//
// Thread: the net plane's one thread. Not RT. Ownership: the clock must outlive it, and what pieces
// use them. Memory: a piece per client that waits, each of which may hold a state to be put back;
// both are bounded by who takes them in (ServerSettings: max_connections, max_state_bytes).
class PacedWork {
 public:
  using Piece = std::function<void()>;
  // Of what a piece took, nothing of the kind is done for so many times as long: ours, a fifth of
  // the thread at most. On a machine where the most cells there are take 28 ms (here 2), 32
  // connections that each ask for them have waited for some 5 s then, as the command line does.
  static constexpr int kRests = 4;

  explicit PacedWork(const Clock& clock) noexcept : clock_(&clock) {}

  // Done in one of the next calls of poll(), in the order of asking.
  void submit(api::ClientId client, Piece piece);
  // Of a piece whose turn it was, but which had to wait for somebody else: at once, and its rest
  // follows.
  void finish(const Piece& piece);
  // What it waits for is not done any more.
  void client_gone(api::ClientId client);
  // Does one piece if there is one and the rest is over. Call it every few ms.
  void poll();

 private:
  struct Wait {
    api::ClientId client{};
    Piece piece;
  };
  const Clock* clock_;
  std::deque<Wait> waits_;
  MonotonicTime rests_until_{};
};

}  // namespace thimble::app
