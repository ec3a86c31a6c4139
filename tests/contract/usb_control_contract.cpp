// What every bus::UsbDevice promises of requests to endpoint 0.
#include "tests/contract/usb_device_contract.hpp"

namespace thimble::test {

using bus::UsbOutcome;

IoStatus UsbDeviceContract::transact(const bus::UsbControlRequest& request,
                                     bus::UsbControlReply& reply) {
  EXPECT_EQ(sut->start_control(request), IoStatus::Ok);
  run_frames(5);
  return sut->read_control(reply);
}

TEST_P(UsbDeviceContract, ARequestReachesTheDeviceAndEndsOnce) {
  bus::UsbControlReply reply;
  EXPECT_EQ(sut->read_control(reply), IoStatus::NoData);

  ASSERT_EQ(transact(vendor_request(9), reply), IoStatus::Ok);

  EXPECT_EQ(reply.outcome, UsbOutcome::Done);
  EXPECT_EQ(rig->requests_of_device(), std::vector<bus::UsbControlRequest>{vendor_request(9)});
  EXPECT_EQ(sut->read_control(reply), IoStatus::NoData);
  EXPECT_EQ(sut->counters(0).packets_out, 1U);
}

TEST_P(UsbDeviceContract, ARequestCarriesItsBytesOut) {
  bus::UsbControlRequest request = vendor_request(7);
  request.length = 3;
  request.data = {1, 2, 3};
  bus::UsbControlReply reply;
  ASSERT_EQ(transact(request, reply), IoStatus::Ok);
  EXPECT_EQ(reply.outcome, UsbOutcome::Done);
  EXPECT_EQ(reply.size, 3U);
  EXPECT_EQ(rig->requests_of_device(), std::vector<bus::UsbControlRequest>{request});
}

TEST_P(UsbDeviceContract, ARequestBringsAsManyBytesAsTheDeviceHas) {
  rig->device_answers_control({1, 2, 3});
  bus::UsbControlReply reply;
  ASSERT_EQ(transact(request_for_data(8), reply), IoStatus::Ok);
  EXPECT_EQ(reply.outcome, UsbOutcome::Done);
  ASSERT_EQ(reply.size, 3U);
  EXPECT_EQ(reply.data[2], 3);
}

TEST_P(UsbDeviceContract, AnAnswerThatIsTooLongBabbles) {
  rig->device_answers_control(pattern(9, 1));
  bus::UsbControlReply reply;
  ASSERT_EQ(transact(request_for_data(8), reply), IoStatus::Ok);
  EXPECT_EQ(reply.outcome, UsbOutcome::Babbled);
  EXPECT_EQ(reply.size, 0U);
  EXPECT_EQ(sut->counters(0).babbles, 1U);
}

TEST_P(UsbDeviceContract, ARefusedRequestSaysSoAndTheNextWorks) {
  rig->device_stalls_once(0);
  bus::UsbControlReply reply;
  ASSERT_EQ(transact(vendor_request(1), reply), IoStatus::Ok);
  EXPECT_EQ(reply.outcome, UsbOutcome::Stalled);
  ASSERT_EQ(transact(vendor_request(2), reply), IoStatus::Ok);
  EXPECT_EQ(reply.outcome, UsbOutcome::Done);
  EXPECT_EQ(sut->counters(0).stalls, 1U);
}

TEST_P(UsbDeviceContract, RequestsGoOneAtATime) {
  rig->set_deaf(0, true);
  EXPECT_EQ(sut->start_control(vendor_request(1)), IoStatus::Ok);
  EXPECT_EQ(sut->start_control(vendor_request(2)), IoStatus::Backlogged);
  run_frames(50);
  bus::UsbControlReply reply;
  EXPECT_EQ(sut->read_control(reply), IoStatus::NoData) << "no time-out";
  rig->set_deaf(0, false);
  run_frames(5);
  EXPECT_EQ(sut->start_control(vendor_request(3)), IoStatus::Backlogged) << "its end is unread";
  EXPECT_EQ(sut->read_control(reply), IoStatus::Ok);

  EXPECT_EQ(transact(vendor_request(4), reply), IoStatus::Ok);

  EXPECT_EQ(rig->requests_of_device(),
            (std::vector<bus::UsbControlRequest>{vendor_request(1), vendor_request(4)}));
}

TEST_P(UsbDeviceContract, RequestsOfTheBusAndTooLongOnesAreRefused) {
  bus::UsbControlRequest standard;
  standard.request_type = 0x00;
  standard.request = 5;  // SET_ADDRESS
  EXPECT_EQ(sut->start_control(standard), IoStatus::ProtocolError);
  EXPECT_EQ(sut->start_control(request_for_data(bus::kMaxUsbControlBytes + 1)),
            IoStatus::ProtocolError);
  run_frames(3);
  EXPECT_TRUE(rig->requests_of_device().empty());
}

}  // namespace thimble::test
