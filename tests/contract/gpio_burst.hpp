#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "hal/bus/gpio_mailboxes.hpp"
#include "hal/linux/gpio_transfers.hpp"

namespace thimble::test {

// Of edges that nobody reads the kernel's queue keeps the sixteen oldest. `set_wire`: of the first
// input of `sut`, which was low and is high then.
inline void expect_sixteen_edges_kept(linux::GpioTransfers& sut, bus::GpioMailboxes& mail,
                                      const std::function<void(bool)>& set_wire) {
  for (int i = 0; i < 20; ++i) set_wire(i % 2 == 0);
  set_wire(true);  // the last that was kept was low
  sut.serve();
  bus::GpioEdge edge;
  for (std::uint64_t i = 1; i <= 16; ++i) {
    ASSERT_EQ(mail.next_edge(edge), IoStatus::Ok);
    EXPECT_EQ(edge.sequence, i);
    EXPECT_EQ(edge.is_high, i % 2 != 0);
  }
  EXPECT_EQ(mail.next_edge(edge), IoStatus::NoData);
}

// And the next one tells that there is a hole.
inline void expect_hole_seen(linux::GpioTransfers& sut, bus::GpioMailboxes& mail,
                             const std::function<void(bool)>& set_wire) {
  set_wire(false);
  sut.serve();
  bus::GpioEdge edge;
  ASSERT_EQ(mail.next_edge(edge), IoStatus::Ok);
  EXPECT_EQ(edge.sequence, 18U) << "low after low: one between was lost";
}

}  // namespace thimble::test
