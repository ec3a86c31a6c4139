#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "tests/contract/serial_rig.hpp"

namespace thimble::test {

// What every bus::SerialPort promises. An implementation joins with
// INSTANTIATE_TEST_SUITE_P(Name, SerialPortContract, testing::Values(factory), serial_rig_name).
class SerialPortContract : public testing::TestWithParam<SerialRigFactory> {
 protected:
  void run_ms(int duration_ms) { rig->run_for(std::chrono::milliseconds(duration_ms)); }
  // All that waits.
  SerialRig::Bytes read_all();

  std::unique_ptr<SerialRig> rig = GetParam().make();
};

inline std::string serial_rig_name(const testing::TestParamInfo<SerialRigFactory>& rig) {
  return rig.param.name;
}

}  // namespace thimble::test
