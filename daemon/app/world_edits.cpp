#include "daemon/app/world_edits.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace thimble::app {
namespace {

world::Cell cell_of(const std::array<std::int32_t, 3>& index) {
  return {index[0], index[1], index[2]};
}

world::CellEdit edit_of(const api::CellEdit& said) {
  using From = api::CellEdit::Kind;
  using To = world::CellEdit::Kind;
  world::CellEdit edit;
  edit.kind = said.kind == From::Fill ? To::Fill : said.kind == From::Box ? To::Box : To::Paint;
  edit.first = cell_of(said.min);
  edit.last = cell_of(said.max);
  edit.center = {said.center_m[0], said.center_m[1], said.center_m[2]};
  edit.radius_m = said.radius_m;
  edit.value = said.cell;
  return edit;
}

}  // namespace

void WorldEdits::submit(std::string_view world, const std::vector<api::CellEdit>& edits,
                        api::ClientId client, api::EditAnswer answer) {
  session::WorldHost* host = runtime_.find_world(world);
  if (host == nullptr) {
    return answer(fail(Errc::NotFound, "this daemon has no world '" + std::string(world) +
                                           "'; one on another host is edited there"));
  }
  std::vector<world::CellEdit> converted;
  converted.reserve(edits.size());
  for (const api::CellEdit& edit : edits) converted.push_back(edit_of(edit));
  const Result<std::uint64_t> batch = host->submit_edits(std::move(converted));
  if (!batch) return answer(tl::unexpected(batch.error()));
  waits_.push_back({host, *batch, edits.size(), client, std::move(answer)});
}

void WorldEdits::client_gone(api::ClientId client) {
  for (const Wait& wait : waits_) {
    if (wait.client == client) wait.world->edits()->withdraw(wait.batch);
  }
  std::erase_if(waits_, [&](const Wait& wait) { return wait.client == client; });
}

void WorldEdits::poll() {
  // Taken out first: an answer may bring the next edit, or the end of its client.
  std::vector<std::pair<api::EditAnswer, api::Edited>> answers;
  for (const auto& host : runtime_.worlds()) {
    if (host->edits() == nullptr) continue;
    for (const world::EditQueue::Finished& finished : host->edits()->take_finished()) {
      const auto wait = std::find_if(waits_.begin(), waits_.end(), [&](const Wait& one) {
        return one.world == host.get() && one.batch == finished.batch;
      });
      if (wait == waits_.end()) continue;
      answers.emplace_back(std::move(wait->answer),
                           api::Edited{wait->edits, finished.changed_cells});
      waits_.erase(wait);
    }
  }
  for (const auto& [answer, edited] : answers) answer(edited);
}

}  // namespace thimble::app
