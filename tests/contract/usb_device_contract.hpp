#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/contract/byte_pattern.hpp"
#include "tests/contract/usb_rig.hpp"

namespace thimble::test {

// What an FTDI bridge is asked for: no data stage.
inline bus::UsbControlRequest vendor_request(std::uint8_t number) {
  bus::UsbControlRequest request;
  request.request = number;
  request.value = 0x4138;
  return request;
}

inline bus::UsbControlRequest request_for_data(std::uint16_t bytes) {
  bus::UsbControlRequest request;
  request.request_type = 0xc0;
  request.length = bytes;
  return request;
}

// What every bus::UsbDevice promises. An implementation joins with
// INSTANTIATE_TEST_SUITE_P(Name, UsbDeviceContract, testing::Values(factory), usb_rig_name).
class UsbDeviceContract : public testing::TestWithParam<UsbRigFactory> {
 protected:
  UsbDeviceContract();

  void run_frames(int frames) { rig->run_for(std::chrono::milliseconds(frames)); }
  // All that waits on an IN pipe.
  std::vector<UsbRig::Packet> read_all(std::uint8_t endpoint);
  // Sends a request and waits for its end; NoData when it has none after some frames.
  IoStatus transact(const bus::UsbControlRequest& request, bus::UsbControlReply& reply);

  std::unique_ptr<UsbRig> rig = GetParam().make();
  std::unique_ptr<bus::UsbDevice> sut;
};

inline std::string usb_rig_name(const testing::TestParamInfo<UsbRigFactory>& rig) {
  return rig.param.name;
}

}  // namespace thimble::test
