#include "sim/export/device_verbs.hpp"

#include <boost/json.hpp>
#include <utility>

namespace thimble::sim {
namespace {

namespace json = boost::json;

std::string line_of(const json::object& reply) { return json::serialize(reply) + "\n"; }

std::string refused(const Error& error) {
  return line_of({{"ok", false}, {"error", error.message}});
}

// In one piece.
DeviceVerbs::Reply whole(std::string text) {
  return [text = std::move(text)]() mutable { return std::exchange(text, {}); };
}

template <class Three>
json::array triple(const Three& value) {
  return {value[0], value[1], value[2]};
}

json::object counters_of(const PlugCounters& counters) {
  return {{"to_host", counters.to_host},       {"from_host", counters.from_host},
          {"superseded", counters.superseded}, {"lost", counters.lost},
          {"requests", counters.requests},     {"malformed", counters.malformed}};
}

json::object trouble_of(const Misbehaviour::Struck& struck) {
  return {{"refused", struck.refused},     {"unanswered", struck.unanswered},
          {"corrupted", struck.corrupted}, {"shortened", struck.shortened},
          {"babbled", struck.babbled},     {"cut", struck.cut},
          {"halted", struck.halted},       {"halted_out", struck.halted_out}};
}

void add_arm(json::object& reply, const plugin::ArmBackend& arm) {
  const plugin::ArmTruth truth = arm.truth();
  reply["tip_m"] = triple(truth.tip);
  reply["home_m"] = triple(arm.home_position());
  reply["force_newton"] = triple(truth.motor_force);
  reply["current_a"] = triple(truth.motor_current_a);
  reply["amplifier_on"] = truth.is_amplifier_on;
}

}  // namespace

DeviceVerbs::DeviceVerbs(bus::BusDeviceInfo info, Plug& plug, const Faces& faces,
                         const PlugSurroundings& surroundings)
    : info_(std::move(info)), plug_(&plug), faces_(faces), around_(surroundings) {
  if (faces_.arm != nullptr) hand_.emplace(*faces_.arm);
}

DeviceVerbs::Reply DeviceVerbs::execute(std::string_view line) {
  const Result<Verb> verb = parse_verb(line);
  if (!verb) return whole(refused(verb.error()));
  if (verb->kind == VerbKind::Status) return whole(status());
  if (verb->kind == VerbKind::Felt) return whole(felt(*verb));
  if (verb->kind == VerbKind::Log) return log_of_last(from_seconds(verb->numbers[0]));
  const Result<void> done = apply(*verb);
  return whole(done ? line_of({{"ok", true}}) : refused(done.error()));
}

Result<void> DeviceVerbs::apply(const Verb& verb) {
  const MonotonicTime now = around_.clock->now();
  const MonotonicTime later = now + from_seconds(verb.numbers[0]);
  // Of verbs that count; of others it may be any number.
  const auto reports = [&] { return static_cast<std::uint32_t>(verb.numbers[0]); };
  switch (verb.kind) {
    case VerbKind::Unplug:
      return plug_->unplug(Supply::Goes);
    case VerbKind::PullCable:
      return plug_->unplug(Supply::Stays);
    case VerbKind::Plug:
      return plug_->plug();
    case VerbKind::Stall:
      around_.misbehaviour->stall_until(later);
      return {};
    case VerbKind::Nak:
      around_.misbehaviour->be_silent_until(later);
      return {};
    case VerbKind::Corrupt:
      around_.misbehaviour->corrupt(reports());
      return {};
    case VerbKind::Short:
      around_.misbehaviour->shorten(reports());
      return {};
    case VerbKind::Babble:
      around_.misbehaviour->babble(reports());
      return {};
    case VerbKind::ShortOut:
      around_.misbehaviour->cut_what_comes(reports());
      return {};
    case VerbKind::Halt:
      return halt(reports());
    case VerbKind::Fault:
      return set_fault(verb.name, reports());
    case VerbKind::Press:
    case VerbKind::Release:
      return press(verb);
    default:
      return apply_to_arm(verb);
  }
}

Result<void> DeviceVerbs::halt(std::uint32_t transfers) {
  if (!plug_->has_endpoints()) {
    return fail(Errc::InvalidArgument,
                "through uhid it has no endpoints: offer it with --usbip or --vhci");
  }
  around_.misbehaviour->halt(transfers);
  return {};
}

Result<void> DeviceVerbs::set_fault(const std::string& name, std::uint32_t number) {
  if (faces_.panel != nullptr && faces_.panel->set_fault(name, number)) return {};
  std::string known;
  if (faces_.panel != nullptr) {
    for (const auto& one : faces_.panel->faults()) known += " " + std::string(one.name);
  }
  return fail(Errc::InvalidArgument, "it has no fault " + name + " with that number; it has:" +
                                         (known.empty() ? " none" : known));
}

Result<void> DeviceVerbs::press(const Verb& verb) {
  const auto number = static_cast<unsigned>(verb.numbers[0]);
  const bool is_down = verb.kind == VerbKind::Press;
  if (faces_.panel != nullptr && faces_.panel->press(number, is_down)) return {};
  if (faces_.arm == nullptr || number > 1) {
    return fail(Errc::InvalidArgument, "it has no button " + std::to_string(number));
  }
  if (number == 0) faces_.arm->press_calibration_button(is_down);
  if (number == 1) faces_.arm->press_stylus_button(is_down);
  return {};
}

Result<void> DeviceVerbs::apply_to_arm(const Verb& verb) {
  if (!hand_) return fail(Errc::InvalidArgument, "it is no arm: nobody can hold it");
  const auto& [x, y, z, last] = verb.numbers;
  if (verb.kind == VerbKind::Move) hand_->move_to({x, y, z}, from_seconds(last));
  if (verb.kind == VerbKind::Home) hand_->go_home(from_seconds(x));
  if (verb.kind == VerbKind::LetGo) hand_->let_go();
  if (verb.kind == VerbKind::Push) faces_.arm->push_tip({x, y, z});
  return {};
}

std::string DeviceVerbs::status() const {
  json::object reply{{"ok", true},
                     {"model", info_.address.text},
                     {"serial_number", info_.serial_number},
                     {"plugged", plug_->is_plugged()},
                     {"open", plug_->is_open()},
                     {"broken", plug_->is_broken()},
                     {"t_s", seconds(around_.clock->now().since_epoch)},
                     {"machine_s", seconds(around_.machine->now().since_epoch)},
                     {"counters", counters_of(plug_->counters())},
                     {"trouble", trouble_of(around_.misbehaviour->struck())}};
  if (faces_.arm != nullptr) {
    add_arm(reply, *faces_.arm);
    reply["held"] = hand_->has_hold();
  }
  if (faces_.panel != nullptr) {
    json::object readings;
    for (const auto& [name, value] : faces_.panel->readings()) readings[name] = value;
    reply["readings"] = std::move(readings);
    json::object faults;
    for (const auto& [name, number] : faces_.panel->faults()) faults[name] = number;
    reply["faults"] = std::move(faults);
  }
  return line_of(reply);
}

std::string DeviceVerbs::felt(const Verb& verb) const {
  if (faces_.arm == nullptr) {
    return refused({Errc::InvalidArgument, "it is no arm: it has no force"});
  }
  const MonotonicTime from = around_.clock->now() - from_seconds(verb.numbers[0]);
  const ModelLog::Felt felt = around_.log->felt(from, verb.numbers[1]);
  return line_of({{"ok", true},
                  {"frames", felt.frames},
                  {"from_s", seconds(felt.first.since_epoch)},
                  {"lasted_s", seconds(felt.lasted)},
                  {"least_newton", felt.least_newton},
                  {"most_newton", felt.most_newton},
                  {"longest_below_s", seconds(felt.longest_below)}});
}

DeviceVerbs::Reply DeviceVerbs::log_of_last(Duration duration) const {
  const ModelLog& log = *around_.log;
  return [&log, cursor = log.since(around_.clock->now() - duration), is_over = false]() mutable {
    std::string piece = log.lines(cursor, kLogLinesOfAPiece);
    if (!piece.empty() || std::exchange(is_over, true)) return piece;
    return line_of({{"ok", true}, {"entries", cursor.told}});
  };
}

}  // namespace thimble::sim
