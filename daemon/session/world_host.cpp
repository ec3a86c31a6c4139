#include "daemon/session/world_host.hpp"

#include <utility>

#include "daemon/coupling/constraint_model.hpp"
#include "daemon/session/arm_settings.hpp"
#include "daemon/session/combination.hpp"
#include "daemon/session/world_settings.hpp"
#include "daemon/world/cam/automaton_file.hpp"
#include "daemon/world/cam/live_world.hpp"
#include "daemon/world/cam/piece_world.hpp"
#include "daemon/world/io/nrrd_write.hpp"

namespace thimble::session {

namespace {

// What is told of it to other hosts.
link::ThimbleWorldEnd::Settings end_of(const world::World& world, const std::string& name) {
  link::ThimbleWorldEnd::Settings settings;
  settings.max_sessions = world::kMaxProbes;
  settings.welcome.world = link::ShortName::of(name);
  settings.welcome.cells = world.info().cells;
  settings.welcome.cell_m = world.info().cell_m;
  if (world.has_actions()) settings.welcome.capabilities |= link::kHearsActions;
  return settings;
}

}  // namespace

WorldHost::WorldHost() = default;
WorldHost::~WorldHost() = default;

Result<std::unique_ptr<WorldHost>> WorldHost::create(const config::WorldConfig& said,
                                                     const RigParts& parts) {
  const std::string name = "world '" + said.name + "'";
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<WorldHost> host(new WorldHost());
  host->name_ = said.name;
  host->model_ = said.constraint_model;
  host->loss_ = find_loss(said);
  const Clock* const clock = parts.world_clock ? parts.world_clock : parts.real_clock;
  Result<MadeWorld> made = make_world(said, clock, host->plugs_for(said, parts));
  if (!made) return tl::unexpected(made.error().in(name));
  host->world_ = std::move(made->world);
  host->usb_board_ = std::move(made->usb_board);
  if (world::VoxelWorld* cells = host->world_->editable()) host->edits_.emplace(*cells);
  if (const auto good = check_combination(*host->world_, said); !good) {
    return tl::unexpected(good.error().in(name));
  }
  if (!said.is_listening()) return host;
  if (const auto opened = host->listen(said, parts); !opened) {
    return tl::unexpected(opened.error().in(name));
  }
  return host;
}

// The world half of the one peer that the datagrams of 1999 know, and how one is made for each of
// our own.
Result<void> WorldHost::listen(const config::WorldConfig& said, const RigParts& parts) {
  link::UdpWorldServer::Worlds worlds;
  if (can_serve_1999(*world_)) {
    auto half = make_world_half({}, parts.first_session);
    if (!half) return tl::unexpected(half.error());
    half_of_1999_ = *std::move(half);
    worlds.of_1999 = half_of_1999_.get();
  }
  worlds.make_half = [this, has_materials = !said.materials.empty(),
                      first_session = parts.first_session](const link::ThimbleHalf& arm) {
    return make_half_for(arm, has_materials, first_session);
  };
  auto listener = Listener::open({said.listen, said.line, said.allow_unauthenticated, said.peer,
                                  said.key_file, said.impairment},
                                 end_of(*world_, name_), worlds, parts);
  if (!listener) return tl::unexpected(listener.error());
  listener_ = *std::move(listener);
  return {};
}

BoardPlugs WorldHost::plugs_for(const config::WorldConfig& said, const RigParts& parts) {
  if (!is_board_plugged_in(said)) return {};
  BoardPlugs plugs{parts.real_buses, &inline_executor_, parts.open_board_window};
  if (parts.executor_for_board) plugs.executor = &parts.executor_for_board(said.name);
  return plugs;
}

Result<std::unique_ptr<coupling::WorldCoupling>> WorldHost::make_world_half(
    const config::CouplingConfig& arm, std::uint32_t first_session) {
  const coupling::Scheme scheme = scheme_of(arm.scheme);
  if (coupling::has_own_world_half(scheme)) {
    return coupling::make_own_world_half(scheme, world_half_settings(arm), *world_, first_session);
  }
  const auto model = model_ == config::ConstraintModel::Simple
                         ? coupling::ConstraintModel::Simple
                         : coupling::ConstraintModel::GhostPoint;
  return coupling::make_world_coupling(model, *world_, first_session);
}

Result<std::unique_ptr<coupling::WorldCoupling>> WorldHost::make_half_for(
    const link::ThimbleHalf& half, bool has_materials, std::uint32_t first_session) {
  const Result<config::CouplingConfig> arm = coupling_of(half);
  if (!arm) return tl::unexpected(arm.error());
  if (const auto good = check_combination(*world_, *arm); !good) {
    return tl::unexpected(good.error());
  }
  // What a configuration of one host refuses when it is read: config/relations.cpp.
  const coupling::Scheme scheme = scheme_of(arm->scheme);
  const bool feels_materials = scheme != coupling::Scheme::ThesisLiteral &&
                               scheme != coupling::Scheme::BufferZone &&
                               scheme != coupling::Scheme::Composite;
  const bool is_simple = model_ == config::ConstraintModel::Simple;
  if ((has_materials && !feels_materials) || (is_simple && coupling::has_own_world_half(scheme))) {
    return fail(Errc::Unsupported,
                "the world cannot be felt by " + std::string(half.scheme.view()));
  }
  return make_world_half(*arm, first_session);
}

Result<std::uint64_t> WorldHost::submit_edits(std::vector<world::CellEdit> edits) {
  const std::string name = "world '" + name_ + "'";
  if (world_->pieces() != nullptr) {
    return fail(Errc::Unsupported,
                name + ": the cells of pieces are the board's: use thimble select, drop or delete");
  }
  if (!edits_) {
    return fail(Errc::Unsupported, name + ": " + world_->info().source +
                                       " is made of no cells, so none can be edited");
  }
  Result<std::uint64_t> number = edits_->submit(std::move(edits));
  if (!number) return tl::unexpected(number.error().in(name));
  return number;
}

std::string WorldHost::trouble() const {
  const auto* there = pieces();
  if (there == nullptr) return "";
  const auto& board = there->board();
  const auto& why = board.trouble() ? board.trouble() : board.why_dark();
  return why ? why->in("world '" + name_ + "'").message : "";
}

Result<std::string> WorldHost::cells() {
  if (const auto* pieces = world_->pieces()) {
    return world::nrrd_of_bytes(world_->info().cells, pieces->board().picture());
  }
  const world::VoxelWorld* const voxels = world_->editable();
  if (voxels == nullptr) {
    return fail(Errc::Unsupported, "world '" + name_ + "': it is made of no cells");
  }
  return world::nrrd_of_grid(*voxels->grid(), kMostShownCells);
}

Result<std::string> WorldHost::save_state() {
  auto* live = world_->live();
  if (live == nullptr) return does_not_run();
  return world::cam::to_nrrd(live->save());
}

Result<std::uint64_t> WorldHost::load_state(std::string_view bytes) {
  auto* live = world_->live();
  if (live == nullptr) return does_not_run();
  const auto state = world::cam::parse_state(bytes);
  if (!state) return tl::unexpected(state.error().in("world '" + name_ + "'"));
  const auto loaded = live->load(*state);
  if (!loaded) return tl::unexpected(loaded.error().in("world '" + name_ + "'"));
  return state->steps;
}

tl::unexpected<Error> WorldHost::does_not_run() const {
  return fail(Errc::Unsupported, "world '" + name_ + "': it does not run by itself, so it has no " +
                                     "state to save or load");
}

std::optional<MonotonicTime> WorldHost::pump(MonotonicTime now) {
  if (auto* pieces = world_->pieces()) {
    pieces->pump();
    return now + kEditPace;
  }
  std::optional<MonotonicTime> due = pump_edits(now);
  auto* live = world_->live();
  const auto step_due = live == nullptr ? std::nullopt : live->pump(now);
  if (!due || (step_due && *step_due < *due)) due = step_due;
  return due;
}

std::optional<MonotonicTime> WorldHost::pump_edits(MonotonicTime now) {
  if (!edits_ || edits_->is_idle()) return std::nullopt;
  if (!next_slice_ || now >= *next_slice_) {
    edits_->step();
    next_slice_ = now + kEditPace;
  }
  if (edits_->is_idle()) return std::nullopt;
  return next_slice_;
}

std::optional<link::LinkStatus> WorldHost::listener_status() const {
  if (!listener_) return std::nullopt;
  return listener_->status();
}

bool WorldHost::has_line() const noexcept { return listener_ && listener_->has_line(); }

std::vector<link::LinkStatus> WorldHost::session_statuses() const {
  return listener_ ? listener_->sessions() : std::vector<link::LinkStatus>();
}

}  // namespace thimble::session
