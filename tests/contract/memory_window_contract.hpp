#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "tests/contract/memory_rig.hpp"

namespace thimble::test {

// What every bus::MemoryWindow promises. An implementation joins with
// INSTANTIATE_TEST_SUITE_P(Name, MemoryWindowContract, testing::Values(factory), memory_rig_name).
class MemoryWindowContract : public testing::TestWithParam<MemoryRigFactory> {
 protected:
  std::unique_ptr<MemoryRig> rig = GetParam().make();
  bus::MemoryWindow& sut = rig->window();
};

inline std::string memory_rig_name(const testing::TestParamInfo<MemoryRigFactory>& rig) {
  return rig.param.name;
}

}  // namespace thimble::test
