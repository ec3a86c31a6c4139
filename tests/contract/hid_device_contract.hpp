#pragma once

#include <gtest/gtest.h>

#include "tests/contract/hid_rig.hpp"

namespace thimble::test {

// What every bus::HidDevice promises. An implementation joins with
// INSTANTIATE_TEST_SUITE_P(Name, HidDeviceContract, testing::Values(factory), rig_name).
class HidDeviceContract : public testing::TestWithParam<HidRigFactory> {
 protected:
  std::unique_ptr<HidRig> rig = GetParam().make();

  [[nodiscard]] std::vector<std::uint8_t> input(std::uint8_t seed) const;
  [[nodiscard]] std::vector<std::uint8_t> output(std::uint8_t seed) const;
  void run_frames(int frames) { rig->run_for(rig->frame_period() * frames); }
};

inline std::string rig_name(const testing::TestParamInfo<HidRigFactory>& rig) {
  return rig.param.name;
}

}  // namespace thimble::test
