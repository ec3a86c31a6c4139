#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/servo/servo_frame.hpp"
#include "daemon/session/plugins.hpp"
#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"
#include "lab/run/played_file.hpp"
#include "lab/run/virtual_session.hpp"
#include "lab/trial/parallel.hpp"
#include "sim/time/trace_hash.hpp"

namespace thimble::lab {

struct RunSettings {
  // The daemon's configurations, unchanged: each is another host. One or more.
  std::vector<std::string> files;
  // As thimbled takes them with --set, for every file; "NAME:KEY=VALUE": only for the one of that
  // name (PlayedFile::name).
  std::vector<std::string> overrides;
  // Of all simulated persons and networks, instead of those that the file says: `seed` for the
  // first arm, one more for each after it, in the order of the files, then for each world whose
  // listener has a network.
  std::optional<std::uint64_t> seed;
  double for_s{20};  // > 0
};

// One arm, as it went.
struct ArmTrace {
  std::vector<servo::ServoFrame> frames;  // thinned: SessionRun::kMostRows at most
  sim::TraceHash hash;  // over what was felt and sent in each tick, to the last bit
  double driven_s{0};
};

// Any sessions of the daemon, played in virtual time; several talk to each other.
//
// Thread: one. Errors: the configuration's, all of them; what cannot be played, with the reasons;
// the runtime's.
class SessionRun {
 public:
  static constexpr std::size_t kMostRows = 4000;

  [[nodiscard]] static Result<std::unique_ptr<SessionRun>> load(const RunSettings& settings);
  // Once.
  void play(const Progress& progress = {});
  // After play().
  [[nodiscard]] Findings findings() const;
  [[nodiscard]] double for_s() const noexcept { return settings_.for_s; }
  [[nodiscard]] const ArmTrace& trace(std::size_t arm) const { return traces_[arm]; }
  [[nodiscard]] VirtualSession& session() noexcept { return *session_; }

 private:
  explicit SessionRun(RunSettings settings) : settings_(std::move(settings)) {}
  void note(std::size_t arm, bool is_shown);

  [[nodiscard]] std::string name_of(std::size_t arm) const;

  RunSettings settings_;
  std::vector<std::unique_ptr<session::Plugins>> plugins_;  // by file
  std::vector<PlayedFile> files_;
  std::unique_ptr<VirtualSession> session_;
  std::uint64_t shown_every_{1};  // ticks
  std::vector<ArmTrace> traces_;
};

}  // namespace thimble::lab
