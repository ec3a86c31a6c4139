#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "sim/export/usbip_session.hpp"
#include "tests/support/scripted_usb_model.hpp"
#include "tests/unit/export/export_bench.hpp"
#include "tests/unit/export/usbip_host.hpp"

namespace thimble::sim {

class UsbipSessionTest : public ::testing::Test {
 protected:
  using Bytes = UsbipHost::Bytes;
  using Model = test::ScriptedUsbModel;

  UsbipSessionTest() { sut_.set_available(true); }

  void attach() {
    ASSERT_TRUE(sut_.take(UsbipHost::import()));
    ASSERT_EQ(sut_.outbox().size(), 320U);
    sut_.outbox().clear();
  }
  void say(const Bytes& bytes) { ASSERT_TRUE(sut_.take(bytes)); }
  void serve(int rounds = 1) {
    for (int i = 0; i < rounds; ++i) {
      bench_.clock.run_for(kRound);
      sut_.serve(bench_.clock.now());
    }
  }
  // Says it and serves one frame: its answer, the only one.
  UsbipHost::Reply transfer(const Bytes& message, bool has_data) {
    say(message);
    serve(8);
    const auto reply = UsbipHost::take_reply(sut_.outbox(), has_data);
    EXPECT_TRUE(reply);
    EXPECT_TRUE(sut_.outbox().empty());
    return reply.value_or(UsbipHost::Reply{});
  }

  static constexpr Duration kRound{125'000};
  ExportBench bench_;
  std::shared_ptr<test::UsbModelScript> script_ = std::make_shared<test::UsbModelScript>();
  Model model_{script_};
  UsbPersona persona_{model_.describe(), {}};
  UsbipSession sut_{model_, persona_, 8, bench_.surroundings()};
  UsbipHost host_;
};

}  // namespace thimble::sim
