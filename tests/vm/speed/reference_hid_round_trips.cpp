#include <fcntl.h>
#include <hidapi/hidapi.h>
#include <linux/hiddev.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstring>

#include "tests/vm/speed/reference_round_trips.hpp"

namespace {

struct Message {
  unsigned char bytes[17] = {};  // no report number, and 16 bytes
};

bool write_to_hiddev(int hiddev, const Message& message) {
  hiddev_usage_ref_multi values = {};
  values.uref.report_type = HID_REPORT_TYPE_OUTPUT;
  values.num_values = 16;
  for (int i = 0; i < 16; ++i) values.values[i] = message.bytes[1 + i];
  hiddev_report_info report = {};
  report.report_type = HID_REPORT_TYPE_OUTPUT;
  return ioctl(hiddev, HIDIOCSUSAGES, &values) >= 0 && ioctl(hiddev, HIDIOCSREPORT, &report) >= 0;
}

std::optional<RoundTripFigures> exchange(hid_device* device, int hiddev, std::size_t round_trips) {
  Message sent;
  unsigned char answer[64] = {};
  const auto prepare = [&](std::size_t number) {
    std::memcpy(sent.bytes + 1, &number, sizeof number);
    return true;
  };
  return measured(round_trips, prepare, [&] {
    bool is_back = hiddev >= 0
                       ? write_to_hiddev(hiddev, sent)
                       : hid_write(device, sent.bytes, sizeof sent.bytes) == sizeof sent.bytes;
    while (is_back && std::memcmp(answer, sent.bytes + 1, 16) != 0) {
      is_back = hid_read_timeout(device, answer, sizeof answer, 5000) == 16;
    }
    return is_back;
  });
}

}  // namespace

std::optional<RoundTripFigures> reference_hid_round_trips(const ReferenceNodes& nodes,
                                                          std::size_t round_trips) {
  const int hiddev = nodes.hiddev == nullptr ? -1 : open(nodes.hiddev, O_RDONLY | O_CLOEXEC);
  hid_device* device = hid_open_path(nodes.node);
  std::optional<RoundTripFigures> figures;
  if (device != nullptr && (nodes.hiddev == nullptr || hiddev >= 0)) {
    figures = exchange(device, hiddev, round_trips);
  }
  if (device != nullptr) hid_close(device);
  if (hiddev >= 0) close(hiddev);
  return figures;
}
