#include "tests/campaign/episode.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "drivers/falcon/firmware_image.hpp"
#include "tests/campaign/circumstances.hpp"
#include "tests/campaign/hostile_link.hpp"
#include "tests/campaign/tapped_arm.hpp"
#include "tests/campaign/worlds.hpp"
#include "tests/support/closed_loop.hpp"
#include "tests/support/falcon_image.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::campaign {
namespace {

// A Falcon that was not heard is asked whether it runs, and else gets its firmware again: 5 s of
// rest after what failed (BootSequence::kRest), a hundred questions of 50 ms, and the upload.
constexpr Duration kFalconBoot = std::chrono::seconds(12);

// A word at a time; sim::TraceHash goes by bytes, too slow for every tick of a billion.
class Trace {
 public:
  void add(std::uint64_t word) noexcept {
    hash_ = (hash_ ^ word) * 0x9fb21c651e98df25U;
    hash_ ^= hash_ >> 29U;
  }
  void add(double value) noexcept { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const servo::ServoFrame& frame, const plugin::ArmTruth& truth) noexcept {
    add(frame.tick ^ (static_cast<std::uint64_t>(frame.state) << 56U));
    add(static_cast<std::uint64_t>(frame.now.since_epoch.count()));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      add(frame.force[axis]);
      add(frame.offset[axis]);
      add(truth.tip[axis]);
      add(truth.motor_current_a[axis]);
    }
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return hash_; }

 private:
  std::uint64_t hash_{0};
};

Bounds bounds_of(const Setup& setup, test::ClosedLoop& loop) {
  const double cell_m = loop.world().info().cell_m;
  Bounds bounds;
  bounds.servo = loop.settings();
  if (setup.has_bystander) bounds.other_servo = loop.arm(1).session().loop().settings();
  bounds.workspace_radius_m = loop.arm().session().device().capabilities().workspace_radius_m;
  bounds.stiffness_newton_per_m = setup.is_thesis_literal ? 800 : setup.stiffness_newton_per_m;
  bounds.damping_newton_s_per_m = setup.is_thesis_literal ? 10 : 5;
  for (const Material& material : materials_of(setup)) {
    bounds.stiffness_newton_per_m =
        std::max(bounds.stiffness_newton_per_m, material.stiffness_newton_per_m);
    bounds.damping_newton_s_per_m =
        std::max(bounds.damping_newton_s_per_m, material.damping_newton_s_per_m);
    bounds.friction = std::max(bounds.friction, material.friction);
  }
  const bool is_halved = !setup.is_thesis_literal && cell_m > 0;
  bounds.hysteresis_m = is_halved ? std::min(0.0005, cell_m / 4) : 0.0005;
  // Where order is lost a reply waits for those that overtook it, where delay and jitter add up.
  bounds.round_trip = from_seconds(setup.delay_s + setup.jitter_s + 0.01);
  bounds.is_network_lossless = setup.loss == 0 && setup.reorder == 0;
  // A harder wall is not passive behind the milliseconds of this bus (teleop.md 2(a)).
  // It speaks of one stiffness and of flat walls.
  const bool is_plain = setup.world != "sphere" && setup.materials == 0 && !setup.is_hostile;
  bounds.is_energy_bounded = !setup.is_thesis_literal && is_plain &&
                             setup.stiffness_newton_per_m <= 800 && !setup.is_bare_usb();
  bounds.is_world_honest = !setup.is_hostile;
  if (!setup.is_bare_usb()) return bounds;
  bounds.is_tapped = false;
  bounds.boot = bounds.silence = kFalconBoot;
  return bounds;
}

// What counting one tick needs to know of the one before.
struct Before {
  explicit Before(const servo::ServoSnapshot& servo) noexcept
      : faults(servo.faults), clear_answered(servo.clear_answered), state(servo.frame.state) {}
  std::uint64_t faults;
  std::uint32_t clear_answered;
  OperatingState state;
};

void count(const Before& before, const servo::ServoSnapshot& now, bool& is_down, Tally& tally) {
  const servo::ServoFrame& frame = now.frame;
  ++tally.ticks;
  ++tally.ticks_in[static_cast<std::size_t>(frame.state)];
  if (now.faults != before.faults) ++tally.latched[static_cast<std::size_t>(frame.fault)];
  if (now.clear_answered != before.clear_answered && now.clear_outcome == ClearOutcome::Cleared) {
    ++tally.cleared;
  }
  const bool is_lost = frame.state == OperatingState::Lost;
  if (is_lost && before.state != OperatingState::Lost) ++tally.unplugged;
  is_down = is_down || is_lost || frame.state == OperatingState::Fault;
  if (!is_down || frame.gain < 1) return;
  is_down = false;
  ++tally.recoveries;
}

std::vector<std::string> firmware_in(const testing_support::TemporaryFolder& folder) {
  constexpr int kBlocks = 2;  // short, so that an episode has time for more than its upload
  const std::vector<std::uint8_t> image = test::falcon_image(1, kBlocks);
  const auto file =
      folder.write("image", {reinterpret_cast<const char*>(image.data()), image.size()});
  return {"arm.right.firmware=" + file.string(),
          "arm.right.firmware_sha256=" + falcon::sha256_of(image)};
}

// The session of a programme, and what stands between its first arm and its world.
struct Stage {
  // An arm that is opened again reads its firmware again.
  std::unique_ptr<testing_support::TemporaryFolder> folder;
  std::unique_ptr<test::ClosedLoop> loop;
  HostileLink* liar{nullptr};
};

Stage make_stage(const Programme& programme, const Planted& planted) {
  const Setup& setup = programme.setup;
  Stage stage;
  std::vector<std::string> settings = overrides(setup);
  if (setup.world == "volume" || setup.is_bare_usb())
    stage.folder = std::make_unique<testing_support::TemporaryFolder>();
  if (setup.is_bare_usb()) {
    for (const std::string& line : firmware_in(*stage.folder)) settings.push_back(line);
  }
  if (setup.world == "volume") {
    const auto file = stage.folder->write("volume.nrrd", volume_of(setup));
    settings.push_back("world.source=" + file.string());
  }
  test::ClosedLoop::Setup parts;
  parts.text = test::hello_text() + more_configuration(setup);
  parts.cables = cables_of(programme);
  parts.spares_others = true;
  parts.wrap_link = [&](coupling::ArmLink& below) -> std::unique_ptr<coupling::ArmLink> {
    if (!setup.is_hostile || stage.liar != nullptr) return nullptr;
    auto liar = std::make_unique<HostileLink>(below, derive(programme.seed, 1));
    stage.liar = liar.get();
    return liar;
  };
  stage.loop = std::make_unique<test::ClosedLoop>(
      settings, parts, planted.models.empty() ? tapped_arms() : planted.models);
  return stage;
}

void finish_setup(const Setup& setup, const Stage& stage, Tally& tally) {
  tally.lies = stage.liar == nullptr ? 0 : stage.liar->lies();
  tally.in_spheres = setup.world == "sphere" ? 1 : 0;
  tally.in_volumes = setup.world == "volume" ? 1 : 0;
  tally.with_bystander = setup.has_bystander ? 1 : 0;
  tally.on_bare_usb = setup.is_bare_usb() ? 1 : 0;
  tally.recoveries_on_usb = setup.is_bare_usb() ? tally.recoveries : 0;
  if (setup.has_bystander) tally.played_s += seconds(stage.loop->frame(1).now.since_epoch);
}

void finish(test::ClosedLoop& loop, const Circumstances& circumstances, std::uint64_t cut,
            Tally& tally) {
  tally.episodes = 1;
  tally.events = circumstances.happened();
  tally.edits = circumstances.edits_applied();
  tally.reports = loop.injected();
  tally.reports.by_kind[static_cast<std::size_t>(sim::FaultKind::TruncateOut)] += cut;
  const link::LinkStatus link = loop.arm().link_status();
  tally.messages_lost = link.counters.injected.lost;
  tally.messages_duplicated = link.counters.injected.duplicated;
  tally.messages_reordered = link.counters.injected.reordered;
  tally.contacts = loop.snapshot().total_contacts;
  tally.peak_newton = loop.snapshot().peak_force_newton;
  tally.played_s = seconds(loop.now().since_epoch);
}

}  // namespace

void Tally::add(const Tally& other) noexcept {
  const auto add_all = [](auto& sums, const auto& more) {
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += more[i];
  };
  episodes += other.episodes;
  ticks += other.ticks;
  played_s += other.played_s;
  add_all(events, other.events);
  add_all(reports.by_kind, other.reports.by_kind);
  messages_lost += other.messages_lost;
  messages_duplicated += other.messages_duplicated;
  messages_reordered += other.messages_reordered;
  add_all(ticks_in, other.ticks_in);
  add_all(latched, other.latched);
  cleared += other.cleared;
  unplugged += other.unplugged;
  recoveries += other.recoveries;
  edits += other.edits;
  lies += other.lies;
  in_spheres += other.in_spheres;
  in_volumes += other.in_volumes;
  with_bystander += other.with_bystander;
  on_bare_usb += other.on_bare_usb;
  contacts += other.contacts;
  recoveries_on_usb += other.recoveries_on_usb;
  judged.ticks_due_on_usb += other.judged.ticks_due_on_usb;
  judged.touches += other.judged.touches;
  judged.excused_touches += other.judged.excused_touches;
  peak_newton = std::max(peak_newton, other.peak_newton);
}

Ending play(const Programme& programme, const Planted& planted) {
  const Stage stage = make_stage(programme, planted);
  test::ClosedLoop& loop = *stage.loop;
  auto* const tap = dynamic_cast<TappedArm*>(&loop.sim_arm().backend());
  if ((tap == nullptr) != programme.setup.is_bare_usb()) throw std::logic_error("a tap too few");
  if (tap != nullptr) tap->set_cable(cables_of(programme));
  const Bounds bounds = bounds_of(programme.setup, loop);
  const auto invariants = planted.invariants ? planted.invariants(bounds) : make_invariants(bounds);

  Circumstances circumstances(programme, loop);
  Findings findings;
  Ending ending;
  Observation observation;
  const bool has_other = programme.setup.has_bystander;
  Trace trace;
  bool is_down = false;
  while (ending.tally.ticks < programme.ticks && !findings.breach()) {
    const Before before(observation.servo);
    loop.tick(circumstances.prepare(loop.now()));
    observation.servo = loop.snapshot();
    observation.truth = loop.truth();
    if (tap != nullptr) observation.wire = tap->look();
    if (has_other) observation.other = &loop.snapshot(1);
    circumstances.describe(observation);
    findings.look_at(observation.servo.frame);
    for (const auto& invariant : invariants) invariant->see(observation, findings);
    trace.add(observation.servo.frame, observation.truth);
    if (has_other) trace.add(observation.other->frame, loop.truth(1));
    count(before, observation.servo, is_down, ending.tally);
  }
  for (const auto& invariant : invariants) invariant->tell(ending.tally.judged);
  finish(loop, circumstances, observation.wire.cut, ending.tally);
  finish_setup(programme.setup, stage, ending.tally);
  ending.breach = findings.breach();
  ending.trace = trace.value();
  return ending;
}

}  // namespace thimble::campaign
