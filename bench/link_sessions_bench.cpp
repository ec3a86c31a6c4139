// How many hands of other hosts one world host serves at 1 kHz each on one core: the processor time
// of its thread for a sample, from the socket to the answer sent, with 64 sealed sessions: eight
// worlds, each with a listener of its own and the eight hands that it takes, as a daemon has them.
// Arms are not paced: sealing what 64 of them send and are told takes more than a second processor.
// With the ghost point, and with composite, what auto takes: once its map is known, and to
// arms that acknowledge none of it: each answer then brings as many blocks as one can.
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <cstdio>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "bench/comparison.hpp"
#include "bench/processor_time.hpp"
#include "daemon/coupling/constraint_model.hpp"
#include "daemon/coupling/scheme.hpp"
#include "daemon/link/udp_arm_link.hpp"
#include "daemon/link/udp_world_server.hpp"
#include "daemon/world/occupancy_block.hpp"
#include "daemon/world/voxel_world.hpp"
#include "hal/linux/monotonic_clock.hpp"

namespace {

using namespace thimble;

constexpr std::size_t kSessions = 64;
constexpr std::size_t kSessionsOfAWorld = 8;
constexpr std::size_t kRounds = 500;
constexpr std::size_t kMostTurns = 200'000;  // until it is said not to work

link::LinkKey key() { return link::LinkKey(std::array<std::byte, link::LinkKey::kSize>{}); }

struct Course {
  std::string name;
  coupling::Scheme scheme;
  bool is_acknowledged;  // what the answers tell
};

class Host {
 public:
  Host(Clock& clock, coupling::Scheme scheme) {
    link::UdpWorldServer::Settings settings;
    settings.bind.address = {127, 0, 0, 1};
    settings.end.key = key();
    settings.end.max_sessions = kSessionsOfAWorld;
    for (std::size_t i = 0; i < kSessions / kSessionsOfAWorld; ++i) {
      auto& world = *worlds_.emplace_back(
          std::make_unique<world::VoxelWorld>(world::make_box(64).value(), "box:64"));
      auto opened = link::UdpWorldServer::open(
          io_, clock, settings, {.make_half = [&world, scheme](const link::ThimbleHalf&) {
            return coupling::has_own_world_half(scheme)
                       ? coupling::make_own_world_half(scheme, {}, world, 1)
                       : coupling::make_world_coupling(coupling::ConstraintModel::GhostPoint, world,
                                                       1);
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
  Arms(Clock& clock, const Host& host, const Course& course)
      : clock_(clock), is_acknowledged_(course.is_acknowledged) {
    link::UdpArmLink::Settings settings;
    settings.end.half.scheme = link::ShortName::of(coupling::to_string(course.scheme));
    settings.end.protocol = link::ArmEndSettings::Protocol::Thimble;
    settings.end.key = key();
    for (std::size_t i = 0; i < kSessions; ++i) {
      settings.peer = host.place(i);
      auto opened = link::UdpArmLink::open(io_, clock, settings, nullptr);
      if (opened) arms_.push_back(*std::move(opened));
    }
    applied_.resize(arms_.size());
  }
  // Each arm sends a hand that presses on a wall, until each is answered. False: one never is.
  bool round() {
    ++number_;
    for (std::size_t i = 0; i < arms_.size(); ++i) {
      coupling::HandSample sample{
          .sequence = number_, .sampled_at = clock_.now(), .hand = {0.046, 0, 0}};
      if (is_acknowledged_) {
        sample.applied_reply = applied_[i];
        sample.applied_before = ~std::uint64_t{0};
      }
      arms_[i]->arm_end().send(sample);
      arms_[i]->on_wake();
    }
    std::vector<bool> is_answered(arms_.size());
    std::size_t left = arms_.size();
    for (std::size_t turn = 0; left > 0 && turn < kMostTurns; ++turn) {
      io_.run_one_for(std::chrono::milliseconds(10));
      for (std::size_t i = 0; i < arms_.size(); ++i) {
        coupling::ConstraintSet reply;
        if (is_answered[i] || !arms_[i]->arm_end().receive(reply)) continue;
        is_answered[i] = true;
        applied_[i] = reply.sequence;
        blocks_ = reply.has_map ? reply.map.blocks.size() : 0;
        --left;
      }
    }
    return left == 0 && arms_.size() == kSessions;
  }
  // Of a map, in the answer that came last.
  [[nodiscard]] std::size_t blocks() const { return blocks_; }

 private:
  Clock& clock_;
  bool is_acknowledged_;
  std::vector<std::uint64_t> applied_;
  std::size_t blocks_{0};
  boost::asio::io_context io_{1};
  std::vector<std::unique_ptr<link::UdpArmLink>> arms_;
  std::uint64_t number_{0};
};

bool run(Clock& clock, const Course& course) {
  Host host(clock, course.scheme);
  if (!host.is_open()) return false;
  Arms arms(clock, host, course);
  // The sessions begin, and what can be known of the box is.
  for (std::size_t i = 0; i < kRounds; ++i) {
    if (!arms.round()) return false;
  }
  bench::Slices each_us;
  for (std::size_t slice = 0; slice < bench::kSlices; ++slice) {
    const double begin_s = host.seconds();
    for (std::size_t i = 0; i < kRounds; ++i) {
      if (!arms.round()) return false;
    }
    each_us.push_back(1e6 * (host.seconds() - begin_s) / (kRounds * kSessions));
  }
  const bool tells_a_map = course.scheme == coupling::Scheme::Composite && !course.is_acknowledged;
  if (arms.blocks() != (tells_a_map ? world::kMostBlocksTold : 0)) return false;
  // 64 sessions of 1 kHz leave 15.6 us of a core for each sample.
  bench::print(bench::compare("a sample served, of 64 sessions, " + course.name, "us",
                              {bench::Goal::Of::Value, 1e6 / (1000 * kSessions)}, each_us, {}));
  return true;
}

}  // namespace

int main() {
  linux::MonotonicClock clock;
  for (const Course& course :
       {Course{"ghost-point", coupling::Scheme::GhostPoint, false},
        Course{"composite", coupling::Scheme::Composite, true},
        Course{"composite, nothing acknowledged", coupling::Scheme::Composite, false}}) {
    if (run(clock, course)) continue;
    std::fputs("bench_link_sessions: not every hand is answered, or not as it should be\n", stderr);
    return 1;
  }
  return 0;
}
