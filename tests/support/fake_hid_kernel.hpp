#pragma once

#include <linux/hiddev.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "hal/linux/device_calls.hpp"

namespace thimble::test {

// A kernel with one HID device on USB, reached by hidraw's write() and by hiddev's ioctl(),
// whatever the descriptors. As hiddev_ioctl() of Linux 6.1 answers, of reports that go out.
class FakeHidKernel final : public linux::DeviceCalls {
 public:
  struct Field {
    std::uint32_t values{0};
    std::int32_t least{0};
    std::int32_t most{255};
  };
  // Of what went out: "raw" or "dev", and the bytes.
  struct Report {
    std::string way;
    std::vector<std::uint8_t> bytes;
    bool operator==(const Report&) const = default;
  };

  std::uint32_t report_number{0};
  std::vector<Field> fields{{2}};
  bool has_hiddev{true};
  bool is_unplugged{false};
  bool has_unread_events{false};
  // The device was asked for its reports, of itself before values are first set.
  bool is_initialized{false};
  // Before a report goes out: time may pass.
  std::function<void()> on_send = [] {};
  std::vector<Report> sent;

  std::ptrdiff_t write(int /*node*/, std::span<const std::uint8_t> bytes) noexcept override {
    on_send();
    if (is_unplugged) return refuse(ENODEV);
    sent.push_back({"raw", {bytes.begin(), bytes.end()}});
    return static_cast<std::ptrdiff_t>(bytes.size());
  }

  bool is_gone(int /*node*/) noexcept override { return is_unplugged && !has_unread_events; }

  int control(int /*node*/, unsigned long request, void* argument) noexcept override {
    if (!has_hiddev) return refuse(ENOTTY);
    if (is_unplugged) return refuse(ENODEV);
    switch (request) {
      case HIDIOCGUSAGE:
        is_initialized = true;
        return 0;
      case HIDIOCGREPORTINFO:
        return tell_report(*static_cast<hiddev_report_info*>(argument));
      case HIDIOCGFIELDINFO:
        return tell_field(*static_cast<hiddev_field_info*>(argument));
      case HIDIOCSUSAGES:
        return set(*static_cast<const hiddev_usage_ref_multi*>(argument));
      case HIDIOCSREPORT:
        return send(*static_cast<const hiddev_report_info*>(argument));
      default:
        return refuse(EINVAL);
    }
  }

 private:
  static int refuse(int code) {
    errno = code;
    return -1;
  }
  [[nodiscard]] bool is_there(std::uint32_t type, std::uint32_t id) const {
    return type == HID_REPORT_TYPE_OUTPUT && !fields.empty() && id == report_number;
  }
  int tell_report(hiddev_report_info& report) const {
    if ((report.report_id & HID_REPORT_ID_FIRST) != 0) report.report_id = report_number;
    if (!is_there(report.report_type, report.report_id)) return refuse(EINVAL);
    report.num_fields = static_cast<std::uint32_t>(fields.size());
    return 0;
  }
  int tell_field(hiddev_field_info& field) const {
    if (!is_there(field.report_type, field.report_id) || field.field_index >= fields.size()) {
      return refuse(EINVAL);
    }
    const Field& its = fields[field.field_index];
    field = {};
    field.field_index = its.values - 1;
    field.maxusage = its.values;
    field.logical_minimum = its.least;
    field.logical_maximum = its.most;
    return 0;
  }
  int set(const hiddev_usage_ref_multi& values) {
    is_initialized = true;
    const hiddev_usage_ref& at = values.uref;
    if (!is_there(at.report_type, at.report_id) || at.field_index >= fields.size() ||
        at.usage_index + values.num_values > fields[at.field_index].values) {
      return refuse(EINVAL);
    }
    values_.resize(fields[at.field_index].values);
    for (std::uint32_t i = 0; i < values.num_values; ++i) {
      values_[at.usage_index + i] = static_cast<std::uint8_t>(values.values[i]);
    }
    return 0;
  }
  int send(const hiddev_report_info& report) {
    if (!is_there(report.report_type, report.report_id)) return refuse(EINVAL);
    on_send();
    sent.push_back({"dev", values_});
    return 0;
  }

  std::vector<std::uint8_t> values_;
};

}  // namespace thimble::test
