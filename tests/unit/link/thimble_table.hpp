#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/link/thimble_arm_end.hpp"
#include "daemon/link/thimble_world_end.hpp"
#include "tests/unit/link/world_double.hpp"

namespace thimble::link {

// A world's end and any number of arms' on one table, in virtual time of 1 ms a step: what one
// sends the other has at once, delays and losses are those that the ends inject. Every datagram is
// kept. The clocks of the two sides differ by `offset`.
namespace on_table {

inline RandomBytes seeded_random(std::uint64_t seed) {
  return [state = seed](std::span<std::byte> out) mutable {
    for (std::byte& byte : out) {
      state = state * 6364136223846793005U + 1442695040888963407U;  // Knuth's, MMIX
      byte = std::byte(state >> 56U);
    }
  };
}

inline LinkKey key_of(unsigned value) {
  std::array<std::byte, LinkKey::kSize> bytes{};
  bytes.fill(std::byte(value));
  return LinkKey(bytes);
}

inline ThimbleWorldEnd::Settings keyed_world(unsigned key = 1) {
  ThimbleWorldEnd::Settings settings;
  settings.key = key_of(key);
  settings.welcome.world = ShortName::of("box");
  return settings;
}
inline ThimbleArmEnd::Settings keyed_arm(unsigned key = 1) {
  ThimbleArmEnd::Settings settings;
  settings.key = key_of(key);
  return settings;
}

inline Endpoint at_port(std::uint16_t port) {
  Endpoint out;
  out.address = {127, 0, 0, 1};
  out.port = port;
  return out;
}

// A half that gives its session back to the table's worlds, which outlive it.
class Half final : public coupling::WorldCoupling {
 public:
  explicit Half(WorldDouble& world) : world_(&world) {}
  Result<void> open(const coupling::HandSample& first) override { return world_->open(first); }
  coupling::ConstraintSet answer(const coupling::HandSample& sample,
                                 Duration dt) noexcept override {
    return world_->answer(sample, dt);
  }
  void close() noexcept override { world_->close(); }
  [[nodiscard]] std::uint64_t cells_epoch() const noexcept override { return 77; }

 private:
  WorldDouble* world_;
};

struct Carried {
  bool is_to_world{};
  Endpoint peer{};
  ThimbleDatagram datagram{};
};

struct Arm {
  Arm(const ThimbleArmEnd::Settings& settings, std::uint16_t port, std::uint64_t seed)
      : end(settings, seeded_random(seed)), place(at_port(port)) {}

  ThimbleArmEnd end;
  Endpoint place;
  coupling::HandSample sample{.hand = {0.016, 0, 0}};
  bool is_running{true};
  std::vector<coupling::ConstraintSet> replies;
};

class Table {
 public:
  explicit Table(ThimbleWorldEnd::Settings settings = {}) : settings_(std::move(settings)) {
    restart_world();
  }

  void restart_world() {
    world.reset();
    world = std::make_unique<ThimbleWorldEnd>(
        settings_,
        [this](const ThimbleHalf& arm) -> Result<std::unique_ptr<coupling::WorldCoupling>> {
          if (arm.scheme.view() == unheard_of) return fail(Errc::InvalidArgument, "no such scheme");
          worlds.push_back(std::make_unique<WorldDouble>());
          worlds.back()->is_silent = are_silent;
          worlds.back()->refusals = refusals;
          return std::make_unique<Half>(*worlds.back());
        },
        seeded_random(++seed_));
  }

  Arm& add_arm(ThimbleArmEnd::Settings settings = {}) {
    arms.push_back(std::make_unique<Arm>(settings, port_++, ++seed_));
    return *arms.back();
  }

  // To the world, as `from`; what it answers goes to the arm there, if there is one.
  void deliver(const Endpoint& from, std::span<const std::byte> bytes) {
    world->on_datagram(from, bytes, now() + offset);
    drain_world();
  }

  void step() {
    time_ms_ += 1;
    for (auto& arm : arms) step(*arm);
    drain_world();
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) step();
  }
  [[nodiscard]] MonotonicTime now() const { return {std::chrono::milliseconds(time_ms_)}; }
  [[nodiscard]] std::size_t sent_by_world() const {
    return static_cast<std::size_t>(std::count_if(carried.begin(), carried.end(),
                                                  [](const Carried& c) { return !c.is_to_world; }));
  }

  std::vector<std::unique_ptr<WorldDouble>> worlds;  // one a session, in their order
  std::unique_ptr<ThimbleWorldEnd> world;
  std::vector<std::unique_ptr<Arm>> arms;
  std::vector<Carried> carried;
  Duration offset{std::chrono::seconds(100)};  // the world's clock minus an arm's
  std::string unheard_of{"unheard-of"};        // a scheme that the world has not
  bool are_silent{false};
  int refusals{0};

 private:
  void step(Arm& arm) {
    if (arm.is_running) {
      ++arm.sample.sequence;
      arm.sample.sampled_at = now();
      arm.end.offer(arm.sample);
    }
    for (coupling::ConstraintSet reply; arm.end.take_reply(now(), reply);) {
      arm.replies.push_back(reply);
    }
    for (ThimbleDatagram datagram; arm.end.poll(now(), datagram);) {
      carried.push_back({true, arm.place, datagram});
      deliver(arm.place, datagram.view());
    }
  }

  void drain_world() {
    for (ThimbleWorldEnd::Reply reply; world->poll(now() + offset, reply);) {
      carried.push_back({false, reply.to, reply.datagram});
      for (auto& arm : arms) {
        if (arm->place == reply.to) arm->end.on_datagram(reply.datagram.view(), now());
      }
    }
  }

  ThimbleWorldEnd::Settings settings_;
  std::uint64_t seed_{0};
  std::uint16_t port_{40000};
  std::int64_t time_ms_{1000};
};

}  // namespace on_table
}  // namespace thimble::link
