#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <random>
#include <vector>

#include "daemon/world/block_world.hpp"

namespace thimble::world {

// Where a block of this kind goes between two hands that wander at random, each turn its own: all
// of it, its weight included, permuted by `shift` axes and mirrored by `sign`; and the places
// turned back.
inline std::vector<Position3> wander_about_block(const BlockScene& kind, std::size_t shift,
                                                 double sign) {
  std::mt19937_64 random(420);
  const auto turned = [&](auto p) {
    auto out = p;
    for (std::size_t axis = 0; axis < 3; ++axis) out[(axis + shift) % 3] = sign * p[axis];
    return out;
  };
  BlockScene scene = kind;
  scene.weight = turned(kind.weight);
  BlockWorld block = BlockWorld::create(scene).value();
  std::array<Position3, 2> hands{Position3{-0.03, 0, 0}, Position3{0.03, 0.001, 0}};
  std::array<ProbeId, 2> probes{};
  for (std::size_t i = 0; i < 2; ++i) probes[i] = block.add_probe(turned(hands[i])).value();
  std::vector<Position3> rows;
  for (int step = 0; step < 3000; ++step) {
    const std::size_t who = random() % 2;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      hands[who][axis] += std::uniform_real_distribution<double>(-0.003, 0.003)(random);
      hands[who][axis] = std::clamp(hands[who][axis], -0.044, 0.044);
    }
    (void)block.move_probe(probes[who], turned(hands[who]), std::chrono::milliseconds(1));
    Position3 row;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      row[axis] = sign * (*block.block_center())[(axis + shift) % 3];
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace thimble::world
