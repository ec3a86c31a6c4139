#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "drivers/falcon/boot_sequence.hpp"

// Any device: each byte of the input says what it does next. No order that cannot be; the image
// leaves in order, a byte only after all before its chunk came back.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace falcon = thimble::falcon;
  std::vector<std::uint8_t> image(150);
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<std::uint8_t>(i * 5);
  falcon::BootSequence boot(image);
  thimble::MonotonicTime now{};
  std::vector<std::uint8_t> last;  // what was sent and not yet echoed
  for (const std::uint8_t does : std::span(data, size)) {
    const falcon::BootOrder order = boot.next();
    if (order.kind == falcon::BootOrder::Kind::Request) {
      if (!thimble::bus::may_be_sent(order.request)) std::abort();
      boot.on_request_end(does == 0xff ? thimble::bus::UsbOutcome::Stalled
                                       : thimble::bus::UsbOutcome::Done);
    }
    if (order.kind == falcon::BootOrder::Kind::Packet) {
      if (order.size == 0 || order.size > falcon::wire::kUploadChunkBytes) std::abort();
      last.assign(order.packet().begin(), order.packet().end());
      if (boot.stage() == falcon::BootStage::Uploading &&
          std::search(image.begin(), image.end(), last.begin(), last.end()) == image.end()) {
        std::abort();
      }
    }
    now = now + std::chrono::milliseconds(does % 64);
    if (does < 0x40) {
      boot.on_packet(last, now);
    } else if (does < 0x80) {
      boot.on_packet(falcon::wire::kBootAnswer, now);
    } else if (does < 0xc0) {
      boot.on_packet(std::span(&does, 1), now);
    } else {
      boot.on_packet({}, now);
    }
    if (boot.is_running()) return 0;
  }
  return 0;
}
