#include "daemon/app/whole_worlds.hpp"

#include <utility>

namespace thimble::app {
namespace {

tl::unexpected<Error> has_no_world(std::string_view world) {
  return fail(Errc::NotFound, "this daemon has no world '" + std::string(world) + "'");
}

}  // namespace

void WholeWorlds::read_cells(std::string_view world, api::ClientId client, api::FileAnswer answer) {
  session::WorldHost* host = runtime_.find_world(world);
  if (host == nullptr) return answer(has_no_world(world));
  if (host->pieces() == nullptr) {
    return paced_.submit(client, [host, answer = std::move(answer)] { answer(host->cells()); });
  }
  const auto read = [this, host, answer = std::move(answer)](const Result<void>& looked) {
    if (!looked) return answer(tl::unexpected(looked.error()));
    paced_.finish([&] { answer(host->cells()); });
  };
  looks_.submit(client, [this, host, client, read] {
    const auto look = std::make_shared<Look>();
    look_ = look;
    pieces_.look(*host, client, [look, read](const Result<void>& looked) { read(looked); });
  });
}

void WholeWorlds::save(std::string_view world, api::ClientId client, api::FileAnswer answer) {
  session::WorldHost* host = runtime_.find_world(world);
  if (host == nullptr) return answer(has_no_world(world));
  paced_.submit(client, [host, answer = std::move(answer)] { answer(host->save_state()); });
}

void WholeWorlds::load(std::string_view world, std::string state, api::ClientId client,
                       api::LoadAnswer answer) {
  session::WorldHost* host = runtime_.find_world(world);
  if (host == nullptr) return answer(has_no_world(world));
  paced_.submit(client, [host, state = std::move(state), answer = std::move(answer)] {
    answer(host->load_state(state));
  });
}

}  // namespace thimble::app
