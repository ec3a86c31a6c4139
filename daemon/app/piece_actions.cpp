#include "daemon/app/piece_actions.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "daemon/world/cam/piece_world.hpp"

namespace thimble::app {
namespace {

using world::cam::PieceAction;
using world::cam::PieceOutcome;

[[nodiscard]] PieceAction action_of(api::PieceVerb verb) noexcept {
  switch (verb) {
    case api::PieceVerb::Select:
      return PieceAction::Select;
    case api::PieceVerb::Drop:
      return PieceAction::Drop;
    case api::PieceVerb::Delete:
      return PieceAction::Delete;
    case api::PieceVerb::Free:
      return PieceAction::ToggleFree;
    case api::PieceVerb::Reset:
      return PieceAction::Reset;
  }
  return PieceAction::Reset;
}

[[nodiscard]] bool is_done(PieceOutcome outcome) noexcept {
  switch (outcome) {
    case PieceOutcome::NothingThere:
    case PieceOutcome::NoRoom:
    case PieceOutcome::NothingHeld:
    case PieceOutcome::AlreadyHeld:
    case PieceOutcome::BoardFailed:
    case PieceOutcome::NoBoard:
      return false;
    default:
      return true;
  }
}

// With the reason, where there is one that can still be seen.
[[nodiscard]] std::string told(PieceOutcome outcome, const world::cam::PieceBoard& board) {
  std::string text(to_string(outcome));
  const bool is_boards = outcome == PieceOutcome::BoardFailed || outcome == PieceOutcome::NoBoard;
  if (is_boards && board.trouble()) text += ": " + board.trouble()->message;
  return text;
}

}  // namespace

void PieceActions::submit(std::string_view world, api::PieceVerb verb, api::ClientId client,
                          api::PieceAnswer answer) {
  session::WorldHost* host = runtime_.find_world(world);
  const std::string name = "world '" + std::string(world) + "'";
  if (host == nullptr) {
    return answer(fail(Errc::NotFound, name + ": this daemon has none of that name"));
  }
  world::cam::PieceWorld* pieces = host->pieces();
  if (pieces == nullptr) {
    return answer(fail(Errc::Unsupported, name + ": it has no pieces"));
  }
  const auto number = pieces->submit(action_of(verb));
  if (!number) return answer(tl::unexpected(number.error().in(name)));
  waits_.push_back({host, *number, client, clock_.now() + kPatience, std::move(answer), false});
}

void PieceActions::look(session::WorldHost& host, api::ClientId client, Looked answer) {
  const auto number = host.pieces()->submit(PieceAction::Look);
  if (!number) {
    return answer(tl::unexpected(number.error().in("world '" + host.name() + "'")));
  }
  const auto on_done = [answer = std::move(answer)](const Result<api::PieceDone>& done) {
    if (!done) return answer(tl::unexpected(done.error()));
    if (!done->is_done) return answer(fail(Errc::Busy, done->outcome));
    answer({});
  };
  waits_.push_back({&host, *number, client, clock_.now() + kPatience, on_done, true});
}

void PieceActions::client_gone(api::ClientId client) {
  std::erase_if(waits_, [&](const Wait& wait) {
    if (wait.client != client) return false;
    if (wait.is_look) wait.world->pieces()->withdraw(wait.number);
    return true;
  });
}

void PieceActions::poll() {
  // Taken out first: an answer may bring the next request, or the end of its client.
  std::vector<std::pair<api::PieceAnswer, Result<api::PieceDone>>> answers;
  for (const auto& host : runtime_.worlds()) {
    if (host->pieces() == nullptr) continue;
    for (const auto& finished : host->pieces()->take_finished()) {
      const auto wait = std::find_if(waits_.begin(), waits_.end(), [&](const Wait& one) {
        return one.world == host.get() && one.number == finished.number;
      });
      if (wait == waits_.end()) continue;
      answers.emplace_back(std::move(wait->answer),
                           api::PieceDone{told(finished.outcome, host->pieces()->board()),
                                          is_done(finished.outcome)});
      waits_.erase(wait);
    }
  }
  const MonotonicTime now = clock_.now();
  for (auto wait = waits_.begin(); wait != waits_.end();) {
    if (now < wait->until) {
      ++wait;
      continue;
    }
    const bool is_withdrawn = wait->world->pieces()->withdraw(wait->number);
    answers.emplace_back(
        std::move(wait->answer),
        fail(Errc::Timeout, is_withdrawn ? "the board does not come to it, and it is not done"
                                         : "the board is not ready with it; it may yet be done"));
    wait = waits_.erase(wait);
  }
  for (const auto& [answer, done] : answers) answer(done);
}

}  // namespace thimble::app
