#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "tests/contract/cam_board_rig.hpp"

namespace thimble::test {

// What every CamBoard promises. An implementation joins with
// INSTANTIATE_TEST_SUITE_P(Name, CamBoardContract, testing::Values(factory), cam_board_rig_name).
class CamBoardContract : public testing::TestWithParam<CamBoardRigFactory> {
 protected:
  static constexpr Duration kPatience = std::chrono::seconds(1);

  Result<CamAnswer> play(const CamSteps& steps, Duration at_most = kPatience) {
    const auto started = sut.start(steps, at_most, rig->now());
    if (!started) return tl::unexpected(started.error());
    while (true) {
      auto answer = sut.poll(rig->now());
      if (!answer) return tl::unexpected(answer.error());
      if (*answer) return **std::move(answer);
      rig->pass(std::chrono::microseconds(20));
    }
  }

  std::unique_ptr<CamBoardRig> rig = GetParam().make();
  CamBoard& sut = rig->board();
  CamGeometry space = rig->geometry();
};

inline std::string cam_board_rig_name(const testing::TestParamInfo<CamBoardRigFactory>& rig) {
  return rig.param.name;
}

}  // namespace thimble::test
