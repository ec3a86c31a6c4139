#include "hal/linux/shared_device.hpp"

#include <fcntl.h>

#include <cerrno>
#include <utility>

#include "hal/linux/system_error.hpp"

namespace thimble::linux {
Result<SharedDevice> open_hidraw_to_share(const std::string& hidraw, bool has_report_ids) {
  Descriptor node(::open(hidraw.c_str(), O_WRONLY | O_CLOEXEC));
  if (node.get() < 0) return tl::unexpected(system_error(hidraw + " cannot be opened", errno));
  return SharedDevice{std::move(node),
                      has_report_ids ? NodeWay::AsTheyAre : NodeWay::HidrawAfterZero};
}

Result<SharedDevice> share_node(int node, NodeWay way) {
  Descriptor copy(::fcntl(node, F_DUPFD_CLOEXEC, 0));
  if (copy.get() < 0) return tl::unexpected(system_error("cannot be shared with a guard", errno));
  return SharedDevice{std::move(copy), way};
}

Result<SharedDevice> share_again(const SharedDevice& device) {
  return share_node(device.node.get(), device.way);
}

}  // namespace thimble::linux
