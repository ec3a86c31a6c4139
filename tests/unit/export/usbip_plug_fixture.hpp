#pragma once

#include <gtest/gtest.h>

#include <boost/asio/write.hpp>
#include <memory>

#include "sim/export/usbip_plug.hpp"
#include "tests/support/scripted_usb_model.hpp"
#include "tests/unit/export/export_bench.hpp"
#include "tests/unit/export/usbip_host.hpp"

namespace thimble::sim {

// Over a real socket of the loopback, between whose two ends virtual time runs by hand.
class UsbipPlugTest : public ::testing::Test {
 protected:
  using Bytes = UsbipHost::Bytes;
  using Tcp = boost::asio::ip::tcp;
  UsbipPlugTest() : sut_(make(model_, {model_.describe(), {}})) { EXPECT_TRUE(sut_->plug()); }

  std::unique_ptr<UsbipPlug> make(plugin::SimUsbModel& model, UsbPersona persona) {
    auto plug = UsbipPlug::listen(io_, 0, model, std::move(persona), bench_.surroundings());
    EXPECT_TRUE(plug);
    return *std::move(plug);
  }
  Tcp::socket connect(UsbipPlug& plug) {
    Tcp::socket socket(io_);
    socket.connect({boost::asio::ip::address_v4::loopback(), plug.port()});
    socket.non_blocking(true);
    socket.set_option(Tcp::no_delay(true));  // as a kernel's host has it
    return socket;
  }
  // Says it, and runs frames until so many bytes came back, or the other side hangs up.
  Bytes ask(Tcp::socket& socket, const Bytes& bytes, std::size_t wanted) {
    boost::system::error_code error;
    if (!bytes.empty()) boost::asio::write(socket, boost::asio::buffer(bytes), error);
    Bytes answer;
    for (int frame = 0; frame < 200 && answer.size() < wanted; ++frame) {
      bench_.run_frames(1);
      Bytes piece(65536);
      piece.resize(socket.read_some(boost::asio::buffer(piece), error));
      answer.insert(answer.end(), piece.begin(), piece.end());
      is_hung_up_ = error && error != boost::asio::error::would_block;
      if (is_hung_up_) break;
    }
    return answer;
  }

  ExportBench bench_;
  boost::asio::io_context io_;
  std::shared_ptr<test::UsbModelScript> script_ = std::make_shared<test::UsbModelScript>();
  test::ScriptedUsbModel model_{script_};
  std::unique_ptr<UsbipPlug> sut_;
  UsbipHost host_;
  bool is_hung_up_{false};
};

}  // namespace thimble::sim
