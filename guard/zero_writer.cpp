#include "guard/zero_writer.hpp"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <cerrno>

namespace thimble::guard {

bool ZeroWriter::write() noexcept {
  errno = 0;
  const bool is_written = try_once();
  refused_by_ = is_written ? 0 : errno;
  ++(is_written ? written_ : refused_);
  return is_written;
}

// A hiddev whose events nobody reads, as here, does not tell of a hang-up (hiddev_poll() of Linux
// 6.1), but refuses all with ENODEV once it is gone, and for nothing else. On usbfs ENODEV is
// also what a device that is being reset says, which comes back to the same node.
bool ZeroWriter::is_gone() noexcept {
  if (handover_.route == ZeroRoute::Hiddev) return refused_by_ == ENODEV;
  return calls_->is_gone(node_.get());
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
