#include "sim/model/cam/step_interface.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "drivers/cambus/cambus_wire.hpp"
#include "tests/unit/cambus/hand_list.hpp"

// Lists written by hand, without the driver.
namespace thimble::sim::cam {
namespace {

using cambus::Register;
namespace wire = cambus::wire;
using State = StepInterface::State;
using Interrupt = StepInterface::Interrupt;

class StepInterfaceTest : public testing::Test {
 protected:
  void step_at(std::uint32_t at, std::uint32_t opcode, std::uint32_t buffer, std::uint32_t length,
               std::uint32_t link) {
    cambus::test::put_descriptor(window_, at, opcode, buffer, length, link);
  }
  // All modules selected, the machine's interrupts enabled; then whatever lies at 0x40.
  void begin(std::uint32_t next = 0x40) {
    step_at(0x10, op(Register::Select) | wire::kImmediate, 0xffffffff, 3, 0x20);
    step_at(0x20, op(Register::IntEnable) | wire::kImmediate, 0xffffffff, 10, next);
    sut_.write_next_list(0x10);
  }
  static std::uint32_t op(Register number) { return static_cast<std::uint32_t>(number); }

  static constexpr std::uint32_t kEnd = wire::kDelay | wire::kStop;

  CamMachine machine_{TorusShape{{1, 1, 1}, 6}};
  cambus::test::HandWindow memory_{0x400};
  std::span<std::uint8_t> window_ = memory_.bytes();
  StepInterface sut_{machine_, bus::SharedWords(memory_.words())};
};

TEST_F(StepInterfaceTest, PlaysAListAndWaits) {
  begin();
  step_at(0x40, op(Register::SaBit) | wire::kInterrupt, 0x100, 5, 0x50);
  window_[0x104] = 0xff;  // bit 2 of layers 0 to 7
  step_at(0x50, kEnd, 0, 7, 0);
  EXPECT_TRUE(sut_.run(100));
  EXPECT_EQ(sut_.state(), State::Waiting);
  EXPECT_EQ(machine_.torus().modules[0].registers.planes(Register::SaBit)[2], 0x00ff);
  EXPECT_EQ(sut_.interrupts(Interrupt::Soft), 1U);
  EXPECT_EQ(sut_.interrupts(Interrupt::NewList), 1U);
  EXPECT_EQ(sut_.previous(), 0x50U);
}

TEST_F(StepInterfaceTest, ASecondListStartsBehindTheFirst) {
  step_at(0x10, wire::kDelay, 0, 5, 0x20);
  step_at(0x20, kEnd, 0, 5, 0);
  step_at(0x30, kEnd, 0, 1000, 0);
  sut_.write_next_list(0x10);
  EXPECT_TRUE(sut_.step());
  sut_.write_next_list(0x30);
  EXPECT_TRUE(sut_.is_list_pending());
  EXPECT_TRUE(sut_.run(100));
  EXPECT_FALSE(sut_.is_list_pending());
  EXPECT_EQ(machine_.now_clocks(), 1010U);
  EXPECT_EQ(sut_.interrupts(Interrupt::NewList), 2U);
}

TEST_F(StepInterfaceTest, AJumpLeavesALoopOnceThereIsSomewhereToGo) {
  step_at(0x10, wire::kDelay, 0, 1, 0x20);
  step_at(0x20, wire::kDelay | wire::kJump, 0, 1, 0x10);
  step_at(0x30, kEnd, 0, 1, 0);
  sut_.write_next_list(0x10);
  EXPECT_FALSE(sut_.run(100));
  sut_.write_next_list(0x30);
  EXPECT_TRUE(sut_.run(10));
  EXPECT_EQ(sut_.state(), State::Waiting);
}

TEST_F(StepInterfaceTest, AnUnknownRegisterHaltsUntilTheExceptionIsCleared) {
  begin();
  step_at(0x40, 29 | wire::kImmediate, 0, 1, 0x50);
  step_at(0x50, kEnd, 0, 1, 0);
  EXPECT_TRUE(sut_.run(100));
  EXPECT_EQ(sut_.state(), State::Halted);
  EXPECT_EQ(sut_.current(), 0x40U);
  EXPECT_EQ(sut_.interrupts(Interrupt::Machine), 1U);
  step_at(0x60, op(Register::IntFlags) | wire::kImmediate | wire::kStop, 0, 10, 0);
  sut_.write_next_list(0x60);
  EXPECT_EQ(sut_.state(), State::Halted);
  sut_.clear_exception();
  EXPECT_TRUE(sut_.run(100));
  EXPECT_EQ(sut_.state(), State::Waiting);
  EXPECT_FALSE(machine_.has_interrupt());
}

TEST_F(StepInterfaceTest, AModuleThatIsNotThereIsATimeout) {
  step_at(0x10, op(Register::Select) | wire::kImmediate, 0xffff0000, 3, 0x20);  // id 0xffff
  step_at(0x20, op(Register::SaBit) | wire::kRead, 0x100, 5, 0x30);
  sut_.write_next_list(0x10);
  EXPECT_TRUE(sut_.run(100));
  EXPECT_EQ(sut_.state(), State::Halted);
  EXPECT_EQ(sut_.interrupts(Interrupt::Timeout), 1U);
}

TEST_F(StepInterfaceTest, ASynchronisedScanIsATimeoutForWhoeverWaits) {
  begin();
  step_at(0x40, op(Register::Run) | wire::kImmediate, 0x0000ffff, 6, 0x50);  // sync 1
  step_at(0x50, kEnd | wire::kWait, 0, 1, 0);
  EXPECT_TRUE(sut_.run(100));
  EXPECT_EQ(sut_.state(), State::Halted);
  EXPECT_EQ(sut_.interrupts(Interrupt::Timeout), 1U);
}

TEST_F(StepInterfaceTest, WhatLiesOutsideTheWindowIsABusFault) {
  for (const std::uint32_t buffer : {0x0U, 0x108U, 0x400U, 0xfffffff0U}) {
    StepInterface sut(machine_, bus::SharedWords(memory_.words()));
    step_at(0x10, op(Register::SaBit), buffer, 5, 0x20);
    sut.write_next_list(0x10);
    EXPECT_TRUE(sut.run(10));
    EXPECT_EQ(sut.interrupts(Interrupt::Bus), 1U) << buffer;
  }
  StepInterface sut(machine_, bus::SharedWords(memory_.words()));
  sut.write_next_list(0x400);
  EXPECT_TRUE(sut.run(10));
  EXPECT_EQ(sut.interrupts(Interrupt::Bus), 1U);
}

TEST_F(StepInterfaceTest, BytesAreTheLowHalfOfEachWord) {
  begin();
  step_at(0x40, op(Register::SaBit) | wire::kImmediate, 0x12345678, 5, 0x50);
  step_at(0x50, op(Register::SaBit) | wire::kRead | wire::kByteMode, 0x100, 5, 0x60);
  step_at(0x60, kEnd, 0, 1, 0);
  EXPECT_TRUE(sut_.run(100));
  EXPECT_EQ(window_[0x100], 0x78);
  EXPECT_EQ(window_[0x101], 0x34);
  EXPECT_EQ(window_[0x104], 0x78);
  EXPECT_EQ(window_[0x105], 0);
}

TEST_F(StepInterfaceTest, WhateverTheWindowHoldsItComesToRestOrGoesOn) {
  std::mt19937 random(6);
  for (int i = 0; i < 300; ++i) {
    for (auto& byte : window_) byte = static_cast<std::uint8_t>(random() % 4 == 0 ? random() : 0);
    // Links and buffers that lead somewhere, lengths that are short.
    for (std::uint32_t at = 0x10; at < 0x400; at += 16) {
      step_at(at, static_cast<std::uint32_t>(random()) & ~wire::kStop,
              static_cast<std::uint32_t>(random() % 64) * 16,
              static_cast<std::uint32_t>(random() % 130),
              static_cast<std::uint32_t>(random() % 66) * 16);
    }
    StepInterface sut(machine_, bus::SharedWords(memory_.words()));
    sut.write_next_list(0x10);
    const bool is_at_rest = sut.run(50);
    EXPECT_NE(is_at_rest, sut.state() == State::Executing);
  }
}

}  // namespace
}  // namespace thimble::sim::cam
