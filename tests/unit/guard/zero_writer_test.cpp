#include "guard/zero_writer.hpp"

#include <gtest/gtest.h>
#include <linux/usbdevice_fs.h>

#include <cerrno>
#include <numeric>
#include <vector>

namespace thimble::guard {
namespace {

using Bytes = std::vector<std::uint8_t>;

// All that the kernel is asked for, whatever it is; the node is none.
struct WatchedKernel final : linux::DeviceCalls {
  struct Asked {
    unsigned long request{0};  // 0: write()
    Bytes bytes;
    unsigned endpoint{0};
    unsigned timeout_ms{0};
    bool operator==(const Asked&) const = default;
  };
  std::vector<Asked> asked;
  int answer{0};

  std::ptrdiff_t write(int, std::span<const std::uint8_t> bytes) noexcept override {
    asked.push_back({0, Bytes(bytes.begin(), bytes.end()), 0, 0});
    return answer;
  }
  int control(int, unsigned long request, void* argument) noexcept override {
    Asked what{request, {}, 0, 0};
    if (request == USBDEVFS_BULK) {
      const auto& transfer = *static_cast<const usbdevfs_bulktransfer*>(argument);
      const auto* bytes = static_cast<const std::uint8_t*>(transfer.data);
      what = {request, Bytes(bytes, bytes + transfer.len), transfer.ep, transfer.timeout};
    }
    asked.push_back(std::move(what));
    return answer;
  }
  bool is_gone(int) noexcept override { return false; }
};

Handover handover_by(ZeroRoute route, std::size_t size) {
  Handover handover{route, 0x02, size, {}};
  std::iota(handover.bytes.begin(), handover.bytes.end(), std::uint8_t{1});
  return handover;
}

Bytes zero_of(const Handover& handover) { return {handover.zero().begin(), handover.zero().end()}; }

// Other requests take transfers of the daemon from it (reap, discard), or its claim.
TEST(ZeroWriter, OfUsbfsOneBulkTransferIsAskedForAndNothingElse) {
  for (const std::size_t size : {1U, 16U, 64U}) {
    const Handover handover = handover_by(ZeroRoute::UsbBulk, size);
    WatchedKernel kernel;
    ZeroWriter sut(handover, linux::Descriptor(), kernel);
    kernel.answer = static_cast<int>(size);
    EXPECT_TRUE(sut.write());
    kernel.answer = -1;
    errno = ETIMEDOUT;
    EXPECT_FALSE(sut.write());
    const WatchedKernel::Asked bulk{USBDEVFS_BULK, zero_of(handover), 0x02,
                                    ZeroWriter::kBulkTimeout_ms};
    EXPECT_EQ(kernel.asked, (std::vector{bulk, bulk}));
  }
}

TEST(ZeroWriter, APartThatWasTakenIsNoZero) {
  for (const ZeroRoute route : {ZeroRoute::UsbBulk, ZeroRoute::Write}) {
    WatchedKernel kernel;
    ZeroWriter sut(handover_by(route, 16), linux::Descriptor(), kernel);
    for (const int taken : {0, 1, 15}) {
      kernel.answer = taken;
      EXPECT_FALSE(sut.write()) << taken;
    }
    kernel.answer = 16;
    EXPECT_TRUE(sut.write());
    EXPECT_EQ(sut.refused(), 3U);
    EXPECT_EQ(sut.written(), 1U);
  }
}

TEST(ZeroWriter, OfANodeThatIsWrittenToOneWriteIsAskedForAndNothingElse) {
  const Handover handover = handover_by(ZeroRoute::Write, kMaxZeroBytes);
  WatchedKernel kernel;
  kernel.answer = static_cast<int>(kMaxZeroBytes);
  ZeroWriter sut(handover, linux::Descriptor(), kernel);
  EXPECT_TRUE(sut.write());
  EXPECT_EQ(kernel.asked, (std::vector{WatchedKernel::Asked{0, zero_of(handover), 0, 0}}));
}

}  // namespace
}  // namespace thimble::guard
