// A constraint's round trip over loopback UDP, from a hand sample given to the arm's end to the
// reply taken from it, with the world's end on a thread of its own: by the datagrams of 1999, and
// by our own, plain and sealed.
#include <array>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "bench/comparison.hpp"
#include "bench/reference_ping_pong.hpp"
#include "daemon/link/udp_arm_link.hpp"
#include "daemon/link/udp_world_server.hpp"
#include "hal/linux/monotonic_clock.hpp"

namespace {

using namespace thimble;

constexpr std::size_t kTrips = 4000;

// A wall that answers at once.
class Wall final : public coupling::WorldCoupling {
 public:
  Wall() { set_.planes.push_back({.normal = {1, 0, 0}, .offset_m = 0.015}); }
  Result<void> open(const coupling::HandSample&) override { return {}; }
  coupling::ConstraintSet answer(const coupling::HandSample&, Duration) noexcept override {
    ++set_.sequence;
    set_.session = 1;
    return set_;
  }
  void close() noexcept override {}

 private:
  coupling::ConstraintSet set_{};
};

struct Carriage {
  const char* name;
  link::ArmEndSettings::Protocol protocol;
  std::optional<link::LinkKey> key;
};

std::vector<Carriage> carriages() {
  using Protocol = link::ArmEndSettings::Protocol;
  std::array<std::byte, link::LinkKey::kSize> bytes{};
  bytes.fill(std::byte{1});
  return {{"constraint round trip, UDP", Protocol::Thesis, std::nullopt},
          {"the same, our own datagrams", Protocol::Thimble, std::nullopt},
          {"the same, our own, sealed", Protocol::Thimble, link::LinkKey(bytes)}};
}

link::UdpWorldServer::Settings server_settings(const Carriage& carriage) {
  link::UdpWorldServer::Settings settings;
  settings.bind.address = {127, 0, 0, 1};
  settings.end.key = carriage.key;
  return settings;
}

link::UdpArmLink::Settings arm_settings(const Carriage& carriage, const link::Endpoint& peer) {
  link::UdpArmLink::Settings settings{.peer = peer};
  settings.end.protocol = carriage.protocol;
  settings.end.key = carriage.key;
  return settings;
}

// Empty when something did not open.
bench::Slices link_round_trips(const Carriage& carriage, Clock& clock) {
  Wall wall;
  boost::asio::io_context world_io(1);
  boost::asio::io_context arm_io(1);
  auto server = link::UdpWorldServer::open(
      world_io, clock, server_settings(carriage),
      {.of_1999 = carriage.key ? nullptr : &wall,
       .make_half = [](const link::ThimbleHalf&) { return std::make_unique<Wall>(); }});
  if (!server) return {};
  auto arm =
      link::UdpArmLink::open(arm_io, clock, arm_settings(carriage, (*server)->local()), nullptr);
  if (!arm) return {};
  std::thread thread([&] { world_io.run(); });

  bench::Slices trips_s;
  coupling::ConstraintSet reply;
  std::uint64_t sequence = 0;
  const auto send = [&] {
    (*arm)->arm_end().send(
        {.sequence = ++sequence, .sampled_at = clock.now(), .hand = {0.016, 0, 0}});
    (*arm)->on_wake();
  };
  // Until a session stands: what was sent before has no answer.
  while (!(*arm)->arm_end().receive(reply)) {
    send();
    arm_io.run_for(std::chrono::milliseconds(5));
  }
  for (std::size_t i = 0; i < kTrips; ++i) {
    const MonotonicTime begin = clock.now();
    send();
    while (!(*arm)->arm_end().receive(reply)) {
      // A datagram that a busy machine dropped is no reason to wait for ever.
      if (arm_io.run_one_for(std::chrono::seconds(1)) == 0) send();
    }
    trips_s.push_back(seconds(clock.now() - begin));
  }
  world_io.stop();
  thread.join();
  return trips_s;
}

// False when something did not open.
bool measure(const Carriage& carriage, Clock& clock) {
  bench::Slices ours_us;
  bench::Slices reference_us;
  bench::alternate(
      2 * bench::kSlices + 1,
      [&] { ours_us.push_back(1e6 * bench::median(link_round_trips(carriage, clock))); },
      [&] { reference_us.push_back(1e6 * bench::median(reference_ping_pong(kTrips))); });
  if (bench::median(ours_us) <= 0) return false;
  bench::print(
      bench::compare(carriage.name, "us", {bench::Goal::Of::Ratio, 1.25}, ours_us, reference_us));
  return true;
}

}  // namespace

int main() {
  linux::MonotonicClock clock;
  for (const Carriage& carriage : carriages()) {
    if (measure(carriage, clock)) continue;
    std::fputs("bench_link_round_trip: the link does not open\n", stderr);
    return 1;
  }
  return 0;
}
