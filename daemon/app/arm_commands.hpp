#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/api/commands.hpp"
#include "daemon/app/leases.hpp"
#include "daemon/app/piece_actions.hpp"
#include "daemon/app/whole_worlds.hpp"
#include "daemon/app/world_edits.hpp"
#include "daemon/session/runtime.hpp"
#include "daemon/session/safety_session.hpp"
#include "hal/base/time.hpp"

namespace thimble::app {

// Carries out what clients ask of arms, and answers with what was then seen of the servo: an
// activation when the arm is active or waits for a person to calibrate it or to bring it into its
// world, a cleared fault when the arm has left it, for which the safety chain is let go first. What
// cannot come true is refused at once, with the cause. Edits of worlds are handed on to WorldEdits,
// what is done to pieces to PieceActions, and whole worlds that are read or put back to
// WholeWorlds.
//
// Thread: the net plane's one thread. Not RT.
// Ownership: runtime, leases and clock must outlive it; the clock never decides about an arm,
//            it only bounds how long a client waits.
class ArmCommands final : public api::Commands {
 public:
  // `safety`, which must outlive it, is nullptr where there are no such lines.
  ArmCommands(session::Runtime& runtime, Leases& leases, const Clock& clock,
              session::SafetySession* safety = nullptr)
      : runtime_(runtime),
        leases_(leases),
        clock_(clock),
        safety_(safety),
        edits_(runtime),
        pieces_(runtime, clock),
        whole_(runtime, pieces_, clock) {}

  void activate(std::string_view arm, api::ClientId client, api::Answer answer) override;
  void deactivate(std::string_view arm, api::ClientId client, api::Answer answer) override;
  void clear_fault(std::string_view arm, std::optional<std::uint32_t> fault, api::ClientId client,
                   api::Answer answer) override;
  void steady_force(std::string_view arm, std::optional<double> up_newton, api::ClientId client,
                    api::Answer answer) override;
  void set_impedance(std::string_view arm, double newton_s_per_m, api::Answer answer) override;
  void ask_world(std::string_view arm, api::HandVerb verb, api::Answer answer) override;
  void edit_world(std::string_view world, const std::vector<api::CellEdit>& edits,
                  api::ClientId client, api::EditAnswer answer) override {
    edits_.submit(world, edits, client, std::move(answer));
  }
  void act_on_pieces(std::string_view world, api::PieceVerb verb, api::ClientId client,
                     api::PieceAnswer answer) override {
    pieces_.submit(world, verb, client, std::move(answer));
  }
  void read_cells(std::string_view world, api::ClientId client, api::FileAnswer answer) override {
    whole_.read_cells(world, client, std::move(answer));
  }
  void save_world(std::string_view world, api::ClientId client, api::FileAnswer answer) override {
    whole_.save(world, client, std::move(answer));
  }
  void load_world(std::string_view world, std::string state, api::ClientId client,
                  api::LoadAnswer answer) override {
    whole_.load(world, std::move(state), client, std::move(answer));
  }
  void client_gone(api::ClientId client) override;

  // Answers those whose command has come true or never will. Call it every few ms.
  void poll();

  // A controller that was just plugged in starts within 1 s; the command line waits 5 s. Ours.
  static constexpr Duration kPatience = std::chrono::seconds(2);
  // A person looks at a scale and types what it says. Ours.
  static constexpr Duration kSteadyFor = std::chrono::seconds(60);

 private:
  enum class Kind : std::uint8_t { Activate, ClearFault, FreeChain };
  struct Wait {
    Kind kind{};
    std::size_t arm{0};
    api::ClientId client{};
    std::uint64_t asked_at_tick{0};
    std::uint32_t fault{0};     // ClearFault: number of the fault
    std::uint32_t reset_id{0};  // ClearFault: of the safety chain; 0: it was let go
    std::uint32_t clear_id{0};  // ClearFault: of the request
    bool is_new_lease{false};   // Activate: this command took the lease
    MonotonicTime until{};
    api::Answer answer;
  };
  struct Steady {
    std::size_t arm{0};
    api::ClientId client{};
    MonotonicTime until{};
  };
  using Verdict = std::optional<Result<api::Done>>;  // nothing: not yet

  [[nodiscard]] session::ArmSession& session(std::size_t arm) {
    return runtime_.arms()[arm]->session();
  }
  [[nodiscard]] Verdict judge(Wait& wait);
  [[nodiscard]] Verdict judge_reset(Wait& wait);
  [[nodiscard]] bool is_chain_awaited(const servo::ServoSnapshot& seen) const;
  [[nodiscard]] Verdict judge_activation(const Wait& wait, const servo::ServoSnapshot& seen);
  [[nodiscard]] Verdict judge_clearing(const Wait& wait, const servo::ServoSnapshot& seen);
  void withdraw(const Wait& wait);
  void end_steady_forces();
  void end_steady_force(std::size_t arm);
  [[nodiscard]] api::Done done(std::size_t arm);
  // The same of an arm that shall be driven, with what keeps it from a force.
  [[nodiscard]] api::Done driven(std::size_t arm);
  void apply_leases();

  session::Runtime& runtime_;
  Leases& leases_;
  const Clock& clock_;
  session::SafetySession* safety_;
  WorldEdits edits_;
  PieceActions pieces_;
  WholeWorlds whole_;  // after the pieces that it has looked at
  std::vector<Wait> waits_;
  std::vector<Steady> steady_;
};

}  // namespace thimble::app
