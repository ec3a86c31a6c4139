#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/base/check.hpp"
#include "hal/bus/device_name.hpp"
#include "hal/linux/device_texts.hpp"
#include "hal/linux/usb_path.hpp"

namespace {

using namespace thimble;
using linux::DeviceTexts;
using linux::FoundDevice;
using linux::ReadDevice;

enum Kind : unsigned { HidOnUsb, Hid, Serial, Usb };

// Pieces of what is left: a byte says how long, in steps of 64 bytes from 192 on.
class Pieces {
 public:
  explicit Pieces(std::string_view left) : left_(left) {}
  [[nodiscard]] bool has_more() const { return !left_.empty(); }
  std::uint8_t byte() {
    if (left_.empty()) return 0;
    const auto first = static_cast<std::uint8_t>(left_.front());
    left_.remove_prefix(1);
    return first;
  }
  std::string text() {
    const std::size_t said = byte();
    const std::string_view piece = left_.substr(0, said < 192 ? said : (said - 191) * 64);
    left_.remove_prefix(piece.size());
    return std::string(piece);
  }

 private:
  std::string_view left_;
};

// The kernel makes node and port: no two devices have the same.
DeviceTexts texts_of(Pieces& pieces, unsigned kind, const std::string& number) {
  DeviceTexts texts;
  texts.is_on_usb = kind != Hid;
  texts.node = "/dev/" + number;
  const std::string port = std::to_string(pieces.byte() % 8);
  texts.port = kind == Hid ? "0003:1234:0006.00" + number : "1-" + (kind == Usb ? number : port);
  texts.name = "tty" + number;
  texts.hid_id = pieces.text();
  texts.hid_name = pieces.text();
  texts.hid_uniq = pieces.text();
  // By the same bytes: what is on USB is not asked for them.
  if (texts.is_on_usb) {
    texts.path =
        linux::usb_path_of("/sys/devices/" + texts.hid_name + "/usb1/" + texts.port, texts.hid_id);
  }
  texts.vendor_id = pieces.text();
  texts.product_id = pieces.text();
  texts.manufacturer = pieces.text();
  texts.product = pieces.text();
  texts.serial_number = pieces.text();
  texts.configuration = pieces.text();
  texts.interface_number = pieces.text();
  (kind == Usb ? texts.descriptors : texts.report_descriptor) = pieces.text();
  return texts;
}

// They go to the log, to documents and to terminals.
void require_printable(const std::string& text) {
  THIMBLE_CHECK(text.size() <= linux::kMaxTextBytes);
  const auto is_printable = [](char c) { return c >= ' ' && c <= '~'; };
  THIMBLE_CHECK(std::all_of(text.begin(), text.end(), is_printable));
}

void require_bounded(const bus::BusDeviceInfo& info) {
  require_printable(info.manufacturer);
  require_printable(info.product);
  require_printable(info.serial_number);
  THIMBLE_CHECK(info.input_report_bytes <= 8193 && info.output_report_bytes <= 8193);
  THIMBLE_CHECK(info.endpoints.size() <= 30);
}

// A configuration can name it so, and means this device of all.
void require_name(const FoundDevice& device, const std::vector<FoundDevice>& all) {
  const std::string& text = device.info.address.text;
  const std::string scheme(bus::to_string(device.info.kind));
  THIMBLE_CHECK(text.starts_with(scheme + ":") && text.size() <= linux::kMaxUsbPathLetters + 34);
  THIMBLE_CHECK(bus::is_device_address(text));
  const auto has_it = [&](const FoundDevice& one) { return one.info.address.text == text; };
  THIMBLE_CHECK(std::count_if(all.begin(), all.end(), has_it) == 1);
}

}  // namespace

// Whatever devices say of themselves: bounded and printable, each with an address of its own that a
// configuration can hold, and no device is lost or doubled by it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Pieces pieces({reinterpret_cast<const char*>(data), size});
  std::vector<ReadDevice> read;
  std::vector<std::string> nodes;
  for (unsigned i = 10; pieces.has_more() && i < 42; ++i) {
    const unsigned kind = pieces.byte() % 4;
    const DeviceTexts texts = texts_of(pieces, kind, std::to_string(i));
    auto device = kind == Usb      ? linux::usb_device_of(texts)
                  : kind == Serial ? linux::serial_port_of(texts)
                                   : linux::hid_device_of(texts);
    if (!device) continue;
    THIMBLE_CHECK(device->place.has_value());
    const unsigned interface = device->place->interface_number;
    THIMBLE_CHECK(kind != Usb || interface == 0);
    nodes.push_back(texts.node);
    read.push_back(*std::move(device));
  }
  const std::vector<FoundDevice> found = linux::with_addresses(
      std::move(read), [](const bus::BusDeviceInfo& info) { return info.vendor_id % 2 == 0; });
  THIMBLE_CHECK(found.size() == nodes.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    THIMBLE_CHECK(found[i].node == nodes[i]);
    require_bounded(found[i].info);
    require_name(found[i], found);
  }
  return 0;
}
