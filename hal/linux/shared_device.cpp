#include "hal/linux/shared_device.hpp"

#include <fcntl.h>

#include <cerrno>
#include <utility>

#include "hal/linux/hiddev.hpp"
#include "hal/linux/system_error.hpp"

namespace thimble::linux {
namespace {

Result<Descriptor> duplicate(int file) {
  Descriptor copy(::fcntl(file, F_DUPFD_CLOEXEC, 0));
  if (copy.get() < 0) return tl::unexpected(system_error("cannot be shared with a guard", errno));
  return copy;
}

// Beside the first way: what it cannot be had for is no reason to have none.
Descriptor open_second_way(const std::string& hiddev, std::size_t report_bytes) {
  if (hiddev.empty()) return {};
  Descriptor second(::open(hiddev.c_str(), O_RDONLY | O_CLOEXEC));
  KernelCalls calls;
  const bool is_usable = second.get() >= 0 && takes_plain_bytes(second.get(), report_bytes, calls);
  return is_usable ? std::move(second) : Descriptor();
}

}  // namespace

Result<SharedDevice> open_hid_to_share(const std::string& hidraw, const std::string& hiddev,
                                       bool has_report_ids, std::size_t output_report_bytes) {
  SharedDevice shared;
  shared.takes_leading_zero = !has_report_ids;
  if (!has_report_ids) shared.hiddev = open_second_way(hiddev, output_report_bytes);
  shared.node = Descriptor(::open(hidraw.c_str(), O_WRONLY | O_CLOEXEC));
  if (shared.node.get() >= 0) return shared;
  return tl::unexpected(system_error(hidraw + " cannot be opened", errno));
}

Result<SharedDevice> share_node(int node) {
  Result<Descriptor> copy = duplicate(node);
  if (!copy.has_value()) return tl::unexpected(copy.error());
  return SharedDevice{std::move(copy.value()), {}, false};
}

Result<SharedDevice> share_again(const SharedDevice& device) {
  Result<SharedDevice> copy = share_node(device.node.get());
  if (!copy.has_value()) return copy;
  copy->takes_leading_zero = device.takes_leading_zero;
  if (device.hiddev.get() < 0) return copy;
  Result<Descriptor> hiddev = duplicate(device.hiddev.get());
  if (!hiddev.has_value()) return tl::unexpected(hiddev.error());
  copy->hiddev = std::move(hiddev.value());
  return copy;
}

}  // namespace thimble::linux
