// How many hands of other hosts one world host serves at 1 kHz each on one core: the processor time
// of its thread for a sample, from the socket to the answer sent, with 64 sealed sessions: eight
// worlds, each with a listener of its own and the eight hands that it takes, as a daemon has them.
// Arms are not paced: sealing what 64 of them send and are told takes more than a second processor.
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <cstdio>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "bench/comparison.hpp"
#include "bench/processor_time.hpp"
#include "daemon/coupling/constraint_model.hpp"
#include "daemon/link/udp_arm_link.hpp"
#include "daemon/link/udp_world_server.hpp"
#include "daemon/world/voxel_world.hpp"
#include "hal/linux/monotonic_clock.hpp"

namespace {

using namespace thimble;

constexpr std::size_t kSessions = 64;
constexpr std::size_t kSessionsOfAWorld = 8;
constexpr std::size_t kRounds = 500;
constexpr std::size_t kMostTurns = 200'000;  // until it is said not to work

link::LinkKey key() { return link::LinkKey(std::array<std::byte, link::LinkKey::kSize>{}); }

class Host {
 public:
  explicit Host(Clock& clock) {
    link::UdpWorldServer::Settings settings;
    settings.bind.address = {127, 0, 0, 1};
    settings.end.key = key();
    settings.end.max_sessions = kSessionsOfAWorld;
    for (std::size_t i = 0; i < kSessions / kSessionsOfAWorld; ++i) {
      auto& world = *worlds_.emplace_back(
          std::make_unique<world::VoxelWorld>(world::make_box(64).value(), "box:64"));
      auto opened = link::UdpWorldServer::open(
          io_, clock, settings, {.make_half = [&world](const link::ThimbleHalf&) {
            return coupling::make_world_coupling(coupling::ConstraintModel::GhostPoint, world, 1);
          }});
      if (opened) servers_.push_back(*std::move(opened));
    }
    if (is_open()) thread_ = std::thread([this] { io_.run(); });
  }
  ~Host() {
    io_.stop();
    if (thread_.joinable()) thread_.join();
  }
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;
  [[nodiscard]] bool is_open() const { return servers_.size() == kSessions / kSessionsOfAWorld; }
  [[nodiscard]] link::Endpoint place(std::size_t session) const {
    return servers_[session / kSessionsOfAWorld]->local();
  }
  // Of the processor, by its thread so far.
  [[nodiscard]] double seconds() {
    std::promise<double> told;
    boost::asio::post(io_, [&told] { told.set_value(bench::processor_s()); });
    return told.get_future().get();
  }

 private:
  std::vector<std::unique_ptr<world::VoxelWorld>> worlds_;
  boost::asio::io_context io_{1};
  std::vector<std::unique_ptr<link::UdpWorldServer>> servers_;
  std::thread thread_;
};

class Arms {
 public:
  Arms(Clock& clock, const Host& host) : clock_(clock) {
    link::UdpArmLink::Settings settings;
    settings.end.protocol = link::ArmEndSettings::Protocol::Thimble;
    settings.end.key = key();
    for (std::size_t i = 0; i < kSessions; ++i) {
      settings.peer = host.place(i);
      auto opened = link::UdpArmLink::open(io_, clock, settings, nullptr);
      if (opened) arms_.push_back(*std::move(opened));
    }
  }
  // Each arm sends a hand that presses on a wall, until each is answered. False: one never is.
  bool round() {
    ++number_;
    for (auto& arm : arms_) {
      arm->arm_end().send({.sequence = number_, .sampled_at = clock_.now(), .hand = {0.046, 0, 0}});
      arm->on_wake();
    }
    std::vector<bool> is_answered(arms_.size());
    std::size_t left = arms_.size();
    for (std::size_t turn = 0; left > 0 && turn < kMostTurns; ++turn) {
      io_.run_one_for(std::chrono::milliseconds(10));
      for (std::size_t i = 0; i < arms_.size(); ++i) {
        coupling::ConstraintSet reply;
        if (is_answered[i] || !arms_[i]->arm_end().receive(reply)) continue;
        is_answered[i] = true;
        --left;
      }
    }
    return left == 0 && arms_.size() == kSessions;
  }

 private:
  Clock& clock_;
  boost::asio::io_context io_{1};
  std::vector<std::unique_ptr<link::UdpArmLink>> arms_;
  std::uint64_t number_{0};
};

}  // namespace

int main() {
  linux::MonotonicClock clock;
  Host host(clock);
  bool is_good = host.is_open();
  bench::Slices each_us;
  if (is_good) {
    Arms arms(clock, host);
    is_good = arms.round();  // the sessions begin
    for (std::size_t slice = 0; is_good && slice < bench::kSlices; ++slice) {
      const double begin_s = host.seconds();
      for (std::size_t i = 0; is_good && i < kRounds; ++i) is_good = arms.round();
      each_us.push_back(1e6 * (host.seconds() - begin_s) / (kRounds * kSessions));
    }
  }
  if (!is_good) {
    std::fputs("bench_link_sessions: not every hand is answered\n", stderr);
    return 1;
  }
  // 64 sessions of 1 kHz leave 15.6 us of a core for each sample.
  bench::print(bench::compare("a sample served, of 64 sessions, sealed", "us",
                              {bench::Goal::Of::Value, 1e6 / (1000 * kSessions)}, each_us, {}));
  return 0;
}
