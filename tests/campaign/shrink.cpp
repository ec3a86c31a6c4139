#include "tests/campaign/shrink.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace thimble::campaign {
namespace {

class Shrinker {
 public:
  Shrinker(const Programme& failing, const Breach& breach, const Play& play, std::uint64_t plays)
      : play_(&play), plays_left_(plays), best_{failing, breach, 1} {}

  Shrunk run() {
    cut();
    drop_events();
    simplify();
    drop_events();
    best_.programme.ticks = best_.breach.tick;
    return best_;
  }

 private:
  // Nothing after the breach matters.
  void cut() {
    Programme shorter = best_.programme;
    shorter.ticks = with_slack(best_.breach.tick);
    const Duration end = best_.breach.at.since_epoch;
    std::erase_if(shorter.events, [end](const Event& event) { return event.at > end; });
    (void)keeps_failing(shorter);
  }

  bool keeps_failing(const Programme& candidate) {
    if (plays_left_ == 0) return false;
    --plays_left_;
    ++best_.plays;
    const std::optional<Breach> breach = (*play_)(candidate);
    if (!breach || breach->rule != best_.breach.rule) return false;
    best_.programme = candidate;
    best_.breach = *breach;
    best_.programme.ticks = std::min(candidate.ticks, with_slack(breach->tick));
    return true;
  }

  // Without an event that makes the servo skip periods the same moment has a higher number.
  static std::uint64_t with_slack(std::uint64_t ticks) noexcept { return ticks + ticks / 8 + 200; }

  // Halves, then quarters … then single ones, each left out in turn for as long as that helps.
  void drop_events() {
    std::size_t size = (best_.programme.events.size() + 1) / 2;
    while (size > 0 && plays_left_ > 0) {
      const bool has_dropped = drop_pieces(size);
      if (size == 1 && !has_dropped) return;
      size = std::max<std::size_t>(1, size / 2);
    }
  }

  bool drop_pieces(std::size_t size) {
    bool has_dropped = false;
    for (std::size_t from = 0; from < best_.programme.events.size();) {
      Programme fewer = best_.programme;
      const std::size_t to = std::min(from + size, fewer.events.size());
      fewer.events.erase(fewer.events.begin() + static_cast<std::ptrdiff_t>(from),
                         fewer.events.begin() + static_cast<std::ptrdiff_t>(to));
      if (keeps_failing(fewer)) {
        has_dropped = true;
      } else {
        from = to;
      }
    }
    return has_dropped;
  }

  template <class Value>
  void try_plain(Value Setup::*member) {
    Programme plainer = best_.programme;
    plainer.setup.*member = Setup{}.*member;
    (void)keeps_failing(plainer);
  }

  void try_plain_rate() {
    Programme plainer = best_.programme;
    const auto rate_hz =
        static_cast<std::uint64_t>(std::exchange(plainer.setup.rate_hz, Setup{}.rate_hz));
    plainer.ticks =
        (plainer.ticks * static_cast<std::uint64_t>(plainer.setup.rate_hz)) / rate_hz + 1;
    (void)keeps_failing(plainer);
  }

  // Each setting that differs from tests/data/hello.toml is put back where that changes nothing.
  void simplify() {
    Programme quiet = best_.programme;
    quiet.setup.noise = {};
    (void)keeps_failing(quiet);
    try_plain_rate();
    try_plain(&Setup::hand_seed);
    try_plain(&Setup::device);
    try_plain(&Setup::motion);
    for (const auto member :
         {&Setup::loss, &Setup::duplicate, &Setup::reorder, &Setup::jitter_s, &Setup::delay_s,
          &Setup::force_newton, &Setup::rise_newton_per_s, &Setup::amplifier_a, &Setup::ramp_s,
          &Setup::hand_newton_per_m, &Setup::hand_reach_m, &Setup::hand_speed_m_per_s,
          &Setup::stiffness_newton_per_m}) {
      try_plain(member);
    }
    for (const auto member : {&Setup::is_lock_step, &Setup::is_thesis_literal,
                              &Setup::is_simple_model, &Setup::is_realtime_required,
                              &Setup::is_edited, &Setup::is_hostile, &Setup::has_bystander}) {
      try_plain(member);
    }
    try_plain(&Setup::world);
    try_plain(&Setup::materials);
    try_plain(&Setup::world_seed);
    try_plain(&Setup::cells);
  }

  const Play* play_;
  std::uint64_t plays_left_;
  Shrunk best_;
};

}  // namespace

std::optional<Shrunk> shrink(const Programme& failing, const Play& play, std::uint64_t most_plays) {
  const std::optional<Breach> breach = play(failing);
  if (!breach) return std::nullopt;
  return Shrinker(failing, *breach, play, most_plays).run();
}

}  // namespace thimble::campaign
