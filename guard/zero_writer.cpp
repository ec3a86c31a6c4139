#include "guard/zero_writer.hpp"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

namespace thimble::guard {

bool ZeroWriter::write() noexcept {
  const bool is_written = try_once();
  ++(is_written ? written_ : refused_);
  return is_written;
}

bool ZeroWriter::try_once() noexcept {
  const auto size = static_cast<unsigned>(handover_.size);
  if (handover_.route == ZeroRoute::Hiddev) return hiddev_.write(handover_.zero());
  if (handover_.route == ZeroRoute::Write) {
    return calls_->write(node_.get(), handover_.zero()) == static_cast<ssize_t>(size);
  }
  usbdevfs_bulktransfer transfer{};
  transfer.ep = handover_.endpoint;
  transfer.len = size;
  transfer.timeout = kBulkTimeout_ms;
  transfer.data = handover_.bytes.data();
  return calls_->control(node_.get(), USBDEVFS_BULK, &transfer) == static_cast<int>(size);
}

}  // namespace thimble::guard
