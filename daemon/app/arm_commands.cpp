#include "daemon/app/arm_commands.hpp"

#include <algorithm>
#include <utility>

#include "daemon/coupling/wave_channel.hpp"
#include "daemon/session/arm_instruction.hpp"

namespace thimble::app {
namespace {

std::string named(const session::ArmSession& session) {
  return "arm '" + session.config().name + "'";
}

std::string told(const Fault& fault) {
  return std::string(to_string(fault.code)) + ": " + std::string(explain(fault.code));
}

// An unplug that stopped nothing is told as a fault, but has no number.
bool is_latched(const servo::ServoSnapshot& seen) { return seen.fault.number != 0; }

// Why the fault of an arm in this state cannot be cleared now; success: it can.
Result<void> check_clearable(session::ArmSession& session, const servo::ServoSnapshot& seen) {
  const std::string arm = named(session);
  const bool is_calibrated_first =
      seen.was_pulled && !seen.is_place_known && session.controls().is_estop_healthy.load();
  if (seen.frame.state == OperatingState::Fault && !is_calibrated_first) return {};
  // One that was never there has nothing latched, either.
  if (seen.frame.state == OperatingState::Lost && seen.fault.code != FaultCode::None) {
    return fail(Errc::Disconnected, arm + " is lost (" + told(seen.fault) +
                                        "); what is latched can be cleared when it is back");
  }
  if (!is_latched(seen)) return fail(Errc::Busy, arm + " has no latched fault");
  return fail(Errc::Busy, arm + " is not calibrated yet (" + told(seen.fault) + ")");
}

// Why an arm in this state cannot come to be driven, whoever asks; success: it may. `safety`:
// nullptr where there are no such lines.
Result<void> check_drivable(session::ArmRig& rig, const session::SafetySession* safety) {
  session::ArmSession& session = rig.session();
  const servo::ServoSnapshot& seen = session.snapshot();
  if (seen.frame.state == OperatingState::Lost) {
    const std::string trouble = rig.trouble();
    const std::string why = trouble.empty() ? told(seen.fault) : trouble;
    return fail(Errc::Disconnected, named(session) + " is lost (" + why + ")");
  }
  // Also while it is calibrated again before that.
  if (is_latched(seen)) {
    const bool is_start = safety != nullptr && seen.fault.code == FaultCode::Estop &&
                          safety->status().awaits_first_clear();
    if (is_start) {
      return fail(Errc::Busy,
                  named(session) + " stands still: " + std::string(session::kNotYetCleared));
    }
    return fail(Errc::Busy, named(session) + " stands still after a fault (" + told(seen.fault) +
                                "); nothing moves it before that fault is cleared");
  }
  return {};
}

// Why nothing can be asked of the world of this arm now; success: it can.
Result<void> check_world_hears(session::ArmRig& rig) {
  session::ArmSession& session = rig.session();
  const std::string arm = named(session);
  const config::ArmConfig& said = session.config();
  if (said.is_remote() && said.protocol == config::LinkProtocol::Thesis) {
    return fail(Errc::Unsupported,
                arm + ": the datagrams of 1999 carry no actions; set arm.protocol = \"thimble\"");
  }
  if (session.snapshot().frame.state != OperatingState::Active) {
    return fail(Errc::Busy, arm + " is not active, so its hand is in no world; activate it first");
  }
  const link::LinkStatus link = rig.link_status();
  if (!link.is_up) return fail(Errc::Disconnected, arm + ": its world does not answer");
  if (link.hears_actions) return {};
  return fail(Errc::Unsupported,
              arm +
                  ": its far end does nothing of the kind; only a world of pieces does, of this "
                  "version or later");
}

}  // namespace

void ArmCommands::activate(std::string_view arm, api::ClientId client, api::Answer answer) {
  const Result<std::size_t> index = leases_.find(arm);
  if (!index) return answer(tl::unexpected(index.error()));
  if (const Result<void> possible = check_drivable(*runtime_.arms()[*index], safety_); !possible) {
    return answer(tl::unexpected(possible.error()));
  }
  const bool is_new_lease = leases_.holder(*index) == Leases::Holder::Nobody;
  if (const Result<Leases::Grant> grant = leases_.acquire(arm, client.value); !grant) {
    return answer(tl::unexpected(grant.error()));
  }
  apply_leases();
  Wait wait;
  wait.kind = Kind::Activate;
  wait.arm = *index;
  wait.client = client;
  wait.asked_at_tick = session(*index).snapshot().frame.tick;
  wait.is_new_lease = is_new_lease;
  wait.until = clock_.now() + kPatience;
  wait.answer = std::move(answer);
  waits_.push_back(std::move(wait));
}

void ArmCommands::deactivate(std::string_view arm, api::ClientId, api::Answer answer) {
  if (const Result<void> released = leases_.release(arm); !released) {
    return answer(tl::unexpected(released.error()));
  }
  end_steady_force(*leases_.find(arm));
  apply_leases();
  answer(done(*leases_.find(arm)));
}

void ArmCommands::clear_fault(std::string_view arm, std::optional<std::uint32_t> fault,
                              api::ClientId client, api::Answer answer) {
  const Result<std::size_t> index = leases_.find(arm);
  if (!index) return answer(tl::unexpected(index.error()));
  session::ArmSession& asked = session(*index);
  const servo::ServoSnapshot& seen = asked.snapshot();
  const bool is_of_chain = is_chain_awaited(seen);
  if (const Result<void> possible = check_clearable(asked, seen); !possible && !is_of_chain) {
    return answer(tl::unexpected(possible.error()));
  }
  // Whoever names another has not seen this one: it may be newer than what they looked at.
  if (fault.value_or(seen.fault.number) != seen.fault.number) {
    return answer(fail(Errc::Busy, named(asked) + " stands still after fault " +
                                       std::to_string(seen.fault.number) + " (" + told(seen.fault) +
                                       "), not after fault " + std::to_string(*fault) +
                                       "; look at the status first"));
  }
  end_steady_force(*index);
  Wait wait;
  wait.kind = is_of_chain ? Kind::FreeChain : Kind::ClearFault;
  wait.arm = *index;
  wait.client = client;
  wait.asked_at_tick = seen.frame.tick;
  wait.fault = seen.fault.number;
  if (safety_ != nullptr) {
    wait.reset_id = safety_->ask_reset();
  } else {
    wait.clear_id = asked.controls().request_clear(wait.fault);
  }
  wait.until = clock_.now() + kPatience;
  wait.answer = std::move(answer);
  waits_.push_back(std::move(wait));
}

// An arm that is not there may need the power that the chain cuts to come back, and nobody else may
// be there whose clear lets the chain go.
bool ArmCommands::is_chain_awaited(const servo::ServoSnapshot& seen) const {
  const bool is_lost = seen.frame.state == OperatingState::Lost;
  return is_lost && safety_ != nullptr && safety_->status().is_stopped;
}

void ArmCommands::steady_force(std::string_view arm, std::optional<double> up_newton,
                               api::ClientId client, api::Answer answer) {
  const Result<std::size_t> index = leases_.find(arm);
  if (!index) return answer(tl::unexpected(index.error()));
  session::ArmSession& asked = session(*index);
  const bool is_ours = leases_.is_held_for(*index, client.value);
  if (!is_ours || asked.snapshot().frame.state != OperatingState::Active) {
    return answer(fail(
        Errc::Busy, named(asked) + " must be active, and for this connection: activate it first"));
  }
  if (up_newton && asked.snapshot().is_kept_out) {
    return answer(fail(Errc::Busy, named(asked) + " has no force where it is: " +
                                       session::way_in(*runtime_.arms()[*index])));
  }
  if (!up_newton) {
    end_steady_force(*index);
    return answer(done(*index));
  }
  // One after another without a gap: nothing is let go of between them.
  std::erase_if(steady_, [&](const Steady& steady) { return steady.arm == *index; });
  asked.steady_force().hold(*up_newton);
  steady_.push_back({*index, client, clock_.now() + kSteadyFor});
  answer(done(*index));
}

static_assert(api::kLeastImpedance_newton_s_per_m == coupling::kLeastImpedance_newton_s_per_m &&
              api::kMostImpedance_newton_s_per_m == coupling::kMostImpedance_newton_s_per_m);

void ArmCommands::set_impedance(std::string_view arm, double newton_s_per_m, api::Answer answer) {
  const Result<std::size_t> index = leases_.find(arm);
  if (!index) return answer(tl::unexpected(index.error()));
  session::ArmSession& asked = session(*index);
  if (!asked.set_impedance({newton_s_per_m})) {
    return answer(fail(Errc::Unsupported,
                       named(asked) + " has no impedance to tune: its scheme is not \"wave\""));
  }
  answer(done(*index));
}

void ArmCommands::ask_world(std::string_view arm, api::HandVerb verb, api::Answer answer) {
  const Result<std::size_t> index = leases_.find(arm);
  if (!index) return answer(tl::unexpected(index.error()));
  if (const Result<void> heard = check_world_hears(*runtime_.arms()[*index]); !heard) {
    return answer(tl::unexpected(heard.error()));
  }
  session(*index).controls().actions.ask(
      verb == api::HandVerb::Reset ? world::HandAction::Reset : world::HandAction::ToggleFree);
  answer(done(*index));
}

// A force that nobody looks after is none: its lease, its client or its time is over.
void ArmCommands::end_steady_forces() {
  std::erase_if(steady_, [&](const Steady& steady) {
    coupling::SteadyForce& force = session(steady.arm).steady_force();
    const bool is_over = clock_.now() >= steady.until ||
                         !leases_.is_held_for(steady.arm, steady.client.value) ||
                         session(steady.arm).snapshot().frame.state != OperatingState::Active;
    if (is_over) {
      force.release();
    } else {
      force.keep();
    }
    return is_over;
  });
}

// Before the next look at it: who held it may hold the arm again by then.
void ArmCommands::end_steady_force(std::size_t arm) {
  std::erase_if(steady_, [&](const Steady& steady) { return steady.arm == arm; });
  session(arm).steady_force().release();
}

void ArmCommands::client_gone(api::ClientId client) {
  for (const Wait& wait : waits_) {
    if (wait.client == client) withdraw(wait);  // nobody is left to be told what comes of it
  }
  std::erase_if(waits_, [&](const Wait& wait) { return wait.client == client; });
  for (Steady& steady : steady_) {
    if (steady.client == client) steady.until = clock_.now();
  }
  end_steady_forces();
  edits_.client_gone(client);
  pieces_.client_gone(client);
  whole_.client_gone(client);
  if (!leases_.drop_client(client.value).empty()) apply_leases();
}

void ArmCommands::poll() {
  end_steady_forces();
  // Taken out first: an answer may bring the next command, or the end of its client.
  std::vector<std::pair<api::Answer, Result<api::Done>>> answers;
  for (std::size_t i = 0; i < waits_.size();) {
    Verdict verdict = judge(waits_[i]);
    if (!verdict) {
      ++i;
      continue;
    }
    if (!*verdict) withdraw(waits_[i]);
    answers.emplace_back(std::move(waits_[i].answer), *std::move(verdict));
    waits_.erase(waits_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  for (const auto& [answer, verdict] : answers) answer(verdict);
  edits_.poll();
  pieces_.poll();
  whole_.poll();
}

ArmCommands::Verdict ArmCommands::judge(Wait& wait) {
  session::ArmSession& asked = session(wait.arm);
  const servo::ServoSnapshot& seen = asked.snapshot();
  // The tick after the next one has surely begun after the command.
  const bool is_seen_since = seen.frame.tick >= wait.asked_at_tick + 2;
  if (wait.reset_id != 0) {
    if (Verdict verdict = judge_reset(wait)) return verdict;
  } else if (is_seen_since) {
    Verdict verdict =
        wait.kind == Kind::Activate ? judge_activation(wait, seen) : judge_clearing(wait, seen);
    if (verdict) return verdict;
  }
  if (clock_.now() < wait.until) return std::nullopt;
  if (!is_seen_since || wait.kind != Kind::Activate) {
    return fail(Errc::Timeout, named(asked) + ": its servo does not run");
  }
  std::string why = named(asked) + " did not become active in time: it is " +
                    std::string(to_string(seen.frame.state));
  const std::string_view instruction = asked.device().calibration_instruction();
  const bool is_unknown = seen.frame.calibration == CalibrationState::Unknown;
  if (is_unknown && !instruction.empty()) {
    why.append("; ").append(instruction);
  } else if (is_unknown || seen.frame.is_stale) {
    why += " and does not report its position; check its power and cable";
  }
  return fail(Errc::Timeout, std::move(why));
}

// The chain of all arms comes first: while it is stopped no servo takes a request.
ArmCommands::Verdict ArmCommands::judge_reset(Wait& wait) {
  const session::SafetySession::Answer answer = safety_->answer();
  if (static_cast<std::int32_t>(answer.id - wait.reset_id) < 0) return std::nullopt;
  session::ArmSession& asked = session(wait.arm);
  if (!answer.is_free) {
    return fail(Errc::Busy, named(asked) + " stays in its fault: " + safety_->explanation());
  }
  if (wait.kind == Kind::FreeChain) {
    return fail(Errc::Disconnected, named(asked) +
                                        " is lost; the safety lines are let go, so that it has "
                                        "its power: plug it in, and clear it when it is back");
  }
  wait.reset_id = 0;
  wait.clear_id = asked.controls().request_clear(wait.fault);
  wait.asked_at_tick = asked.snapshot().frame.tick;
  return std::nullopt;
}

ArmCommands::Verdict ArmCommands::judge_activation(const Wait& wait,
                                                   const servo::ServoSnapshot& seen) {
  if (!leases_.is_held_for(wait.arm, wait.client.value)) {
    return fail(Errc::Busy, named(session(wait.arm)) + " was deactivated meanwhile");
  }
  if (const Result<void> possible = check_drivable(*runtime_.arms()[wait.arm], safety_);
      !possible) {
    return tl::unexpected(possible.error());
  }
  const bool is_up_to_person = seen.frame.state == OperatingState::Calibrating &&
                               seen.frame.calibration == CalibrationState::NeedsUser;
  if (seen.frame.state == OperatingState::Active || is_up_to_person || seen.is_kept_out) {
    return driven(wait.arm);
  }
  return std::nullopt;
}

ArmCommands::Verdict ArmCommands::judge_clearing(const Wait& wait,
                                                 const servo::ServoSnapshot& seen) {
  // Ids may wrap; a later request of the same fault speaks for this one, too.
  if (static_cast<std::int32_t>(seen.clear_answered - wait.clear_id) < 0) return std::nullopt;
  const std::string name = named(session(wait.arm));
  if (seen.fault.number != wait.fault) {  // it is latched no more, whoever cleared it
    if (seen.frame.state != OperatingState::Fault) return driven(wait.arm);
    return fail(Errc::Busy, name + " was cleared, and stopped again (" + told(seen.fault) + ")");
  }
  if (const Result<void> possible = check_clearable(session(wait.arm), seen); !possible) {
    return tl::unexpected(possible.error());
  }
  const std::string why(seen.clear_outcome == ClearOutcome::InputUnhealthy
                            ? explain(FaultCode::Estop)
                            : "the wish to clear it was taken back; ask again");
  return fail(Errc::Busy, name + " stays in its fault (" + std::string(to_string(seen.fault.code)) +
                              "): " + why);
}

// What did not come true shall not come true later, unasked.
void ArmCommands::withdraw(const Wait& wait) {
  servo::ServoControls& controls = session(wait.arm).controls();
  if (wait.kind == Kind::ClearFault) {
    // Whose id is the newest does not matter: who asked for the same fault shares the request.
    const auto shares = [&](const Wait& other) {
      return &other != &wait && other.kind == wait.kind && other.arm == wait.arm &&
             other.client != wait.client && other.fault == wait.fault;
    };
    const bool is_wanted = std::any_of(waits_.begin(), waits_.end(), shares);
    if (!is_wanted && controls.clear_request.load().fault == wait.fault) controls.request_clear(0);
  } else if (wait.is_new_lease && leases_.is_held_for(wait.arm, wait.client.value)) {
    static_cast<void>(leases_.release(session(wait.arm).config().name));
    apply_leases();
  }
}

api::Done ArmCommands::done(std::size_t arm) {
  session::ArmSession& asked = session(arm);
  return {std::string(to_string(asked.snapshot().frame.state)),
          std::string(asked.device().calibration_instruction())};
}

api::Done ArmCommands::driven(std::size_t arm) {
  api::Done answer = done(arm);
  if (session(arm).snapshot().is_kept_out)
    answer.instruction = session::way_in(*runtime_.arms()[arm]);
  return answer;
}

void ArmCommands::apply_leases() {
  for (std::size_t i = 0; i < runtime_.arms().size(); ++i) {
    session(i).controls().want_active = leases_.holder(i) != Leases::Holder::Nobody;
  }
}

}  // namespace thimble::app
