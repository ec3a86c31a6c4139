#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "hal/bus/gpio_mailboxes.hpp"
#include "hal/linux/gpio_transfers.hpp"

namespace thimble::test {

// Of edges that nobody reads the kernel's queue keeps sixteen: the oldest for libgpiod 1.6, the
// newest for 2. Four were lost, which leaves every level as it was: that the queue was full is the
// only trace for 1.6, the kernel's numbers tell for 2, and it is a hole before the sixteen.
// `set_wire`: of the first input of `sut`, which was low and is low then.
inline void expect_full_queue_told(linux::GpioTransfers& sut, bus::GpioMailboxes& mail,
                                   const std::function<void(bool)>& set_wire) {
  for (int i = 0; i < 20; ++i) set_wire(i % 2 == 0);
  sut.serve();
  bus::GpioEdge edge;
  for (std::uint64_t i = 1; i <= 16; ++i) {
    ASSERT_EQ(mail.next_edge(edge), IoStatus::Ok);
    EXPECT_EQ(edge.sequence, i + 1);
    EXPECT_EQ(edge.is_high, i % 2 != 0);
  }
  EXPECT_EQ(mail.next_edge(edge), IoStatus::NoData);
}

// The hole is told once.
inline void expect_next_edge_told_as_whole(linux::GpioTransfers& sut, bus::GpioMailboxes& mail,
                                           const std::function<void(bool)>& set_wire) {
  set_wire(true);
  sut.serve();
  bus::GpioEdge edge;
  ASSERT_EQ(mail.next_edge(edge), IoStatus::Ok);
  EXPECT_EQ(edge.sequence, 18U);
}

}  // namespace thimble::test
