// A constraint's round trip over loopback UDP, from a hand sample given to the arm's end to the
// reply taken from it, with the world's end on a thread of its own.
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>

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

// Empty when something did not open.
bench::Slices link_round_trips(Clock& clock) {
  Wall wall;
  boost::asio::io_context world_io(1);
  boost::asio::io_context arm_io(1);
  link::Endpoint any_port;
  any_port.address = {127, 0, 0, 1};
  auto server = link::UdpWorldServer::open(world_io, clock, {.bind = any_port}, {.of_1999 = &wall});
  if (!server) return {};
  auto arm = link::UdpArmLink::open(arm_io, clock, {.peer = (*server)->local()}, nullptr);
  if (!arm) return {};
  std::thread thread([&] { world_io.run(); });

  bench::Slices trips_s;
  coupling::ConstraintSet reply;
  for (std::uint64_t i = 1; i <= kTrips; ++i) {
    const MonotonicTime begin = clock.now();
    (*arm)->arm_end().send({.sequence = i, .sampled_at = begin, .hand = {0.016, 0, 0}});
    (*arm)->on_wake();
    while (!(*arm)->arm_end().receive(reply)) arm_io.run_one();
    trips_s.push_back(seconds(clock.now() - begin));
  }
  world_io.stop();
  thread.join();
  return trips_s;
}

}  // namespace

int main() {
  linux::MonotonicClock clock;
  bench::Slices ours_us;
  bench::Slices reference_us;
  bench::alternate(
      2 * bench::kSlices + 1,
      [&] { ours_us.push_back(1e6 * bench::median(link_round_trips(clock))); },
      [&] { reference_us.push_back(1e6 * bench::median(reference_ping_pong(kTrips))); });
  if (bench::median(ours_us) <= 0) {
    std::fputs("bench_link_round_trip: the link does not open\n", stderr);
    return 1;
  }
  bench::print(bench::compare("constraint round trip, UDP", "us", {bench::Goal::Of::Ratio, 1.25},
                              ours_us, reference_us));
  return 0;
}
