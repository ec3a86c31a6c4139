#include "tests/vm/replay/session.hpp"

#include <bit>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "daemon/config/load.hpp"
#include "daemon/session/plugins.hpp"
#include "daemon/session/runtime.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "tests/support/willing_guards.hpp"

namespace thimble::replay {
namespace {

// The bridge chip's own two bytes; then what the processor behind it said, 16 bytes a reply.
constexpr std::size_t kStatusBytes = 2;
constexpr std::size_t kReplyBytes = 16;

std::string configuration(const Arm& arm, const std::string& device, const std::string& hand) {
  return "[servo]\nrate_hz = " + std::to_string(std::lround(arm.rate_hz)) +
         "\n[[arm]]\nname = \"right\"\nworld = \"box\"\ndevice = \"" + device + "\"\n" + arm.words +
         hand + "[[world]]\nname = \"box\"\nsource = \"box:3\"\n";
}

Result<std::unique_ptr<session::Runtime>> make_session(const std::string& text,
                                                       const session::RigParts& parts) {
  const config::ConfigResult config = config::parse(text, "replay.toml", {});
  if (!config) return fail(Errc::InvalidArgument, to_string(config.error().front()));
  return session::Runtime::create(*config, parts);
}

void run(session::Runtime& runtime, std::size_t ticks, const std::function<void()>& after_each) {
  session::ArmRig& arm = *runtime.arms().front();
  const Duration period = arm.session().loop().settings().period();
  MonotonicTime next = arm.clock().now();
  for (std::size_t i = 0; i < ticks; ++i) {
    next = next + period;
    static_cast<void>(arm.clock().sleep_until(next));
    arm.session().loop().tick({});
    runtime.pump(next);
    static_cast<void>(runtime.follow_buses(next));
    after_each();
  }
}

// Big-endian, so that the text reads like the number.
void append_bits(std::vector<std::uint8_t>& bytes, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int shift = 56; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
}

std::string line_of(const servo::ServoFrame& frame, std::span<const Transcript::Bytes> sent) {
  std::vector<std::uint8_t> force;
  for (const double value : {frame.force.x, frame.force.y, frame.force.z}) {
    append_bits(force, value);
  }
  std::string line =
      std::to_string(frame.tick) + ' ' + std::string(to_string(frame.state)) + ' ' + hex(force);
  for (const Transcript::Bytes& bytes : sent) line += ' ' + hex(bytes);
  return line + '\n';
}

std::vector<Transcript::Bytes> replies_in(const std::vector<Transcript::Bytes>& packets) {
  std::vector<Transcript::Bytes> replies;
  Transcript::Bytes serial;
  for (const Transcript::Bytes& packet : packets) {
    if (packet.size() <= kStatusBytes) continue;
    serial.insert(serial.end(), packet.begin() + kStatusBytes, packet.end());
    for (; serial.size() >= kReplyBytes; serial.erase(serial.begin(), serial.begin() + kReplyBytes))
      replies.emplace_back(serial.begin(), serial.begin() + kReplyBytes);
  }
  return replies;
}

}  // namespace

Result<Arm> find_arm(const std::string& name) {
  if (name == "phantom") {
    return Arm{"phantom-vintage", "model = \"phantom-vintage\"\namplifier_max_a = 3.0\n", 1000,
               4'500, 4'000};
  }
  // An exchange with a Falcon takes 1.3 ms; replay has one in a tick.
  if (name == "falcon") {
    return Arm{"falcon-loaded", "newton_per_count = 0.00244\n", 500, 3'000, 2'500};
  }
  return fail(Errc::NotFound, "no arm " + name + "; there are: phantom falcon");
}

Result<Tape> record(const Arm& arm) {
  const session::Plugins plugins;
  linux::MonotonicClock machine;
  Transcript transcript;
  session::RigParts parts{plugins.models, plugins.drivers};
  parts.wrap_sim_bus = [&](bus::BusEnumerator& buses, const Clock& clock) {
    return std::make_unique<SteppedBus>(buses, clock, machine, Pace::Virtual, transcript);
  };
  auto runtime = make_session(
      configuration(arm, "sim:" + arm.model, "[arm.hand]\nmotion = \"explore\"\nseed = 1\n"),
      parts);
  if (!runtime) return tl::unexpected(runtime.error());
  Tape tape;
  tape.info = (*runtime)->arms().front()->buses().list().front();
  // Of a Falcon, half of the packets say nothing but that the bridge is there.
  run(**runtime, 2 * arm.reports, [] {});
  const bool is_bridged = tape.info.kind == bus::BusKind::Usb;
  tape.reports = is_bridged ? replies_in(transcript.from_device) : transcript.from_device;
  if (tape.reports.size() < arm.reports) {
    return fail(Errc::System, "the simulated arm said too little for a tape");
  }
  tape.reports.resize(arm.reports);
  return tape;
}

Result<std::string> play(const Arm& arm, const std::string& device, bus::BusEnumerator& buses,
                         sim::VirtualClock& clock, Pace pace) {
  const session::Plugins plugins;
  linux::MonotonicClock machine;
  test::WillingGuards guards;
  Transcript transcript;
  SteppedBus stepped(buses, clock, machine, pace, transcript);
  session::RigParts parts{plugins.models, plugins.drivers};
  parts.real_buses = &stepped;
  parts.guards = &guards;
  parts.real_clock = &clock;
  auto runtime = make_session(configuration(arm, device, {}), parts);
  if (!runtime) return tl::unexpected(runtime.error());
  std::string lines;
  std::size_t told = 0;
  run(**runtime, arm.ticks, [&] {
    const std::span<const Transcript::Bytes> sent(transcript.to_device);
    lines += line_of((*runtime)->arms().front()->session().snapshot().frame, sent.subspan(told));
    told = sent.size();
  });
  return lines;
}

}  // namespace thimble::replay
