#include "tests/campaign/circumstances.hpp"

#include <algorithm>

#include "daemon/link/send_gate.hpp"
#include "daemon/link/world_session.hpp"
#include "daemon/world/voxel_world.hpp"

namespace thimble::campaign {

Circumstances::Circumstances(const Programme& programme, test::ClosedLoop& loop)
    : programme_(&programme), loop_(&loop), edits_(*loop.runtime().worlds().front()) {
  for (std::size_t i = 0; i < programme.events.size(); ++i) {
    const Event& event = programme.events[i];
    edges_.push_back({MonotonicTime{event.at}, i, true});
    edges_.push_back({MonotonicTime{event.at + event.lasts}, i, false});
  }
  std::stable_sort(edges_.begin(), edges_.end(),
                   [](const Edge& a, const Edge& b) { return a.at < b.at; });
}

Duration Circumstances::prepare(MonotonicTime now) {
  late_ = {};
  was_on_.reset();
  for (; next_ < edges_.size() && edges_[next_].at <= now; ++next_) {
    const Event& event = programme_->events[edges_[next_].event];
    was_on_.set(static_cast<std::size_t>(event.kind));
    int& count = on_[static_cast<std::size_t>(event.kind)];
    if (edges_[next_].is_begin) {
      ++count;
      begin(event);
    } else {
      --count;
      end(event);
    }
  }
  return late_;
}

Position3 Circumstances::hand() {
  const servo::ServoFrame& frame = loop_->frame();
  return frame.tip + frame.offset;
}

void Circumstances::begin(const Event& event) {
  ++happened_[static_cast<std::size_t>(event.kind)];
  if (event.kind == EventKind::Unplug && on_[static_cast<std::size_t>(event.kind)] == 1) {
    loop_->unplug();
  }
  if (event.kind == EventKind::Clear) ask_to_clear(false);
  if (event.kind == EventKind::ClearOther) ask_to_clear(true);
  if (event.kind == EventKind::LateServo) late_ += event.lasts;
  if (event.kind == EventKind::Shove) push_ += event.push;
  if (event.kind == EventKind::FillCell) fill(event, true);
  if (is_edit(event.kind)) edits_.begin(event, hand());
  apply(event.kind);
}

void Circumstances::end(const Event& event) {
  if (event.kind == EventKind::Unplug && !is_on(EventKind::Unplug)) loop_->replug();
  if (event.kind == EventKind::Shove)
    push_ = is_on(EventKind::Shove) ? push_ - event.push : Force3{};
  if (event.kind == EventKind::FillCell) fill(event, false);
  if (is_edit(event.kind)) edits_.end(event);
  apply(event.kind);
}

// Everything that is as it is for as long as one of a kind lasts.
void Circumstances::apply(EventKind kind) {
  servo::ServoControls& controls = loop_->controls();
  switch (kind) {
    case EventKind::Estop:
      controls.is_estop_healthy = !is_on(kind);
      break;
    case EventKind::DeadmanOpen:
      controls.is_deadman_held = !is_on(kind);
      break;
    case EventKind::Withdraw:
      controls.want_active = !is_on(kind);
      break;
    case EventKind::NetworkDown:
      loop_->set_network_up(!is_on(kind));
      break;
    case EventKind::Shove:
      loop_->sim_arm().backend().push_tip(push_);
      break;
    default:
      break;
  }
}

void Circumstances::ask_to_clear(bool is_for_other) {
  const std::uint32_t number = loop_->snapshot().fault.number;
  is_clear_for_other_ = is_for_other;
  clear_asked_ = loop_->controls().request_clear(is_for_other ? number + 1 : number);
}

void Circumstances::fill(const Event& event, bool is_filled) {
  if (loop_->world().editable() == nullptr) return;
  world::VoxelWorld& world = *loop_->world().editable();
  const auto& cells = world.info().cells;
  std::uint64_t rest = event.cell;
  const auto draw = [&rest](std::uint32_t n) {
    const auto index = static_cast<std::int32_t>(rest % n);
    rest /= n;
    return index;
  };
  const std::int32_t x = draw(cells[0]);
  const std::int32_t y = draw(cells[1]);
  const std::int32_t z = draw(cells[2]);
  // A world without a free cell refuses the hand: then no reply is owed.
  if (is_filled && world.occupied_cells() + 1 >= all_cells(world)) return;
  world.set_cell({x, y, z}, is_filled);
}

void Circumstances::look_at_world(Observation& observation) {
  const MonotonicTime now = observation.servo.frame.now;
  const bool is_waiting = edits_.waiting() > 0;
  if (is_waiting || edits_.has_applied()) world_ok_since_ = now;
  if (!is_waiting || is_on(EventKind::NetworkDown)) edits_ok_since_ = now;
  const world::World& world = loop_->world();
  // One that was refused asks again after a while, in lock-step when it gave up the last sample.
  const bool is_full = world.grid() != nullptr && world.occupied_cells() >= all_cells(world);
  const Duration gate = programme_->setup.is_lock_step ? link::SendGate::kMaxTimeout : Duration{};
  if (is_full) replies_ok_since_ = now + link::WorldSession::kRetry + gate;
  observation.world_ok_since = world_ok_since_;
  observation.edits_ok_since = edits_ok_since_;
  observation.replies_ok_since = replies_ok_since_;
}

bool Circumstances::is_cable_disturbed() const noexcept {
  for (auto kind = EventKind::DropIn; kind <= EventKind::Disconnect;
       kind = static_cast<EventKind>(static_cast<int>(kind) + 1)) {
    if (has_been_on(kind)) return true;
  }
  return has_been_on(EventKind::Unplug) || has_been_on(EventKind::Halt) ||
         has_been_on(EventKind::Babble);
}

bool Circumstances::look_at_reports(Observation& observation) {
  const sim::FaultCounts injected = loop_->injected();
  // Those that were under way until this tick, too: it let them out.
  const bool is_late =
      injected.out_under_way > 0 || injected_.out_under_way > 0 ||
      injected.of(sim::FaultKind::DelayOut) > injected_.of(sim::FaultKind::DelayOut);
  if (is_late) late_out_at_ = observation.servo.frame.now;
  const bool is_injected = injected.by_kind != injected_.by_kind || observation.wire.cut != cut_;
  injected_ = injected;
  cut_ = observation.wire.cut;
  observation.spoilt_in =
      injected.of(sim::FaultKind::CorruptIn) + injected.of(sim::FaultKind::TruncateIn);
  observation.spoilt_out = injected.of(sim::FaultKind::CorruptOut);
  observation.late_out_at = late_out_at_;
  return is_injected || is_late;
}

void Circumstances::describe(Observation& observation) {
  const MonotonicTime now = observation.servo.frame.now;
  const bool are_reports_disturbed = look_at_reports(observation);
  if (is_cable_disturbed() || are_reports_disturbed || late_ > Duration{}) cable_ok_since_ = now;
  if (has_been_on(EventKind::NetworkDown)) network_ok_since_ = now;
  const bool is_opening_disturbed = has_been_on(EventKind::Unplug) ||
                                    has_been_on(EventKind::RefuseOpen) ||
                                    has_been_on(EventKind::Disconnect);
  if (is_opening_disturbed) opening_ok_since_ = now;
  if (has_been_on(EventKind::Shove)) tip_ok_since_ = now;
  observation.is_estop_healthy = !is_on(EventKind::Estop);
  observation.is_deadman_held = !is_on(EventKind::DeadmanOpen);
  observation.is_network_up = !is_on(EventKind::NetworkDown);
  observation.is_wanted = !is_on(EventKind::Withdraw);
  observation.clear_asked = clear_asked_;
  observation.is_clear_for_other = is_clear_for_other_;
  observation.cable_ok_since = cable_ok_since_;
  observation.network_ok_since = network_ok_since_;
  observation.opening_ok_since = opening_ok_since_;
  observation.tip_ok_since = tip_ok_since_;
  look_at_world(observation);
}

}  // namespace thimble::campaign
