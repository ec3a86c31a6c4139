#include <gtest/gtest.h>

#include <cerrno>

#include "tests/unit/export/usbip_session_fixture.hpp"

// A device that is told to misbehave, and what waits for nothing.
namespace thimble::sim {
namespace {

TEST_F(UsbipSessionTest, HaltsWhatGoesOutAsWellButNothingThatItRefuses) {
  attach();
  bench_.misbehaviour.halt(2);
  bench_.misbehaviour.stall_until(bench_.clock.now() + std::chrono::milliseconds(2));
  EXPECT_EQ(transfer(host_.write(Model::kBulkOut, {1}), false).status, -EPIPE);
  EXPECT_EQ(bench_.misbehaviour.struck().halted, 0U) << "a refusal halts nothing";
  serve(20);
  EXPECT_EQ(transfer(host_.write(Model::kBulkOut, {2}), false).status, -EPIPE);
  say(host_.write(Model::kBulkOut, {3}));
  serve(20);
  EXPECT_TRUE(sut_.outbox().empty()) << "halted already: it waits, and is not counted";
  EXPECT_EQ(bench_.misbehaviour.struck().halted, 1U);
  EXPECT_EQ(bench_.misbehaviour.struck().halted_out, 1U);
  EXPECT_TRUE(script_->received[Model::kBulkOut].empty());
}

TEST_F(UsbipSessionTest, AReadForWhichTheModelIsNotAskedIsAnsweredInTheNextRound) {
  attach();
  script_->unchanged_until = bench_.clock.now() + std::chrono::hours(1);
  const auto needed_after = [&](const Bytes& read) {
    say(read);
    const MonotonicTime now = bench_.clock.now();
    const Duration after = sut_.next_needed(now) - now;
    serve();
    say(host_.unlink(host_.seqnum));
    serve(7);  // to the end of the frame
    sut_.outbox().clear();
    return after;
  };
  EXPECT_EQ(needed_after(host_.read(Model::kBulkIn, 64)), 8 * kRound);
  EXPECT_EQ(needed_after(host_.read(Model::kBulkIn, 0)), kRound) << "of nothing";
  EXPECT_EQ(needed_after(host_.read(0x8f, 64)), kRound) << "where nothing is";
  say(host_.read(0x8f, 64));
  say(host_.read(0x8f, 64));
  serve();
  sut_.outbox().clear();
  EXPECT_EQ(needed_after(host_.read(Model::kBulkIn, 64)), kRound) << "there is the second";
  serve(7);  // to the end of the frame
  say(host_.read(Model::kBulkIn, 64));
  bench_.misbehaviour.stall_until(bench_.clock.now() + std::chrono::milliseconds(2));
  EXPECT_EQ(sut_.next_needed(bench_.clock.now()), bench_.clock.now() + kRound) << "it is refused";
}

TEST_F(UsbipSessionTest, ToldToHaltAnEndpointItDoesUntilTheHostEndsThat) {
  attach();
  script_->to_send[Model::kBulkIn] = {{1, 2}};
  bench_.misbehaviour.halt(1);
  EXPECT_EQ(transfer(host_.control({0x80, 6, 0, 1, 0, 0, 18, 0}), true).status, 0) << "a request";
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 64), true).status, -EPIPE);
  EXPECT_EQ(bench_.misbehaviour.struck().halted, 1U);
  say(host_.read(Model::kBulkIn, 64));
  serve(20);
  EXPECT_TRUE(sut_.outbox().empty()) << "it is halted";
  say(host_.unlink(host_.seqnum));
  sut_.outbox().clear();
  EXPECT_EQ(transfer(host_.control({0x02, 1, 0, 0, Model::kBulkIn, 0, 0, 0}), false).status, 0);
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 64), true).data, (Bytes{1, 2}))
      << "the model was never asked";
}

TEST_F(UsbipSessionTest, MisbehavesOnDemand) {
  attach();
  bench_.misbehaviour.be_silent_until(bench_.clock.now() + std::chrono::milliseconds(2));
  serve(1);
  EXPECT_EQ(bench_.misbehaviour.struck().unanswered, 0U) << "nobody asked";
  script_->to_send[Model::kBulkIn] = {Bytes(20), Bytes(20), Bytes(20)};
  say(host_.read(Model::kBulkIn, 64));
  serve(8);
  EXPECT_TRUE(sut_.outbox().empty());
  serve(16);
  EXPECT_TRUE(UsbipHost::take_reply(sut_.outbox(), true));
  EXPECT_GE(bench_.misbehaviour.struck().unanswered, 8U);
  bench_.misbehaviour.stall_until(bench_.clock.now() + std::chrono::milliseconds(2));
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 64), true).status, -EPIPE);
  EXPECT_EQ(bench_.misbehaviour.struck().refused, 1U);
  serve(16);
  bench_.misbehaviour.shorten(1);
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 64), true).data.size(), 10U);
  bench_.misbehaviour.babble(1);
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 20), true).status, -EOVERFLOW);
}

TEST_F(UsbipSessionTest, APacketThatItTakesHalfOfEndsItsTransferAndTheHostHearsHowMuch) {
  attach();
  bench_.misbehaviour.cut_what_comes(1);
  const auto reply = transfer(host_.write(Model::kBulkOut, Bytes(80, 7)), false);
  EXPECT_EQ(reply.status, 0);
  EXPECT_EQ(reply.actual, 32U);
  EXPECT_EQ(script_->received[Model::kBulkOut], std::vector<Bytes>{Bytes(32, 7)});
  EXPECT_EQ(transfer(host_.write(Model::kBulkOut, Bytes(80, 8)), false).actual, 80U);
  EXPECT_EQ(bench_.misbehaviour.struck().cut, 1U);
}

TEST_F(UsbipSessionTest, APacketThatIsPutOffIsCutWhenItIsTaken) {
  attach();
  bench_.misbehaviour.cut_what_comes(1);
  script_->deaf = {Model::kBulkOut};
  say(host_.write(Model::kBulkOut, Bytes(16, 7)));
  serve(8);
  EXPECT_EQ(bench_.misbehaviour.struck().cut, 0U);
  script_->deaf.clear();
  serve(8);
  EXPECT_EQ(UsbipHost::take_reply(sut_.outbox(), false)->actual, 8U);
  EXPECT_EQ(bench_.misbehaviour.struck().cut, 1U);
}

}  // namespace
}  // namespace thimble::sim
