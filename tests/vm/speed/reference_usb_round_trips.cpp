#include <fcntl.h>
#include <libusb-1.0/libusb.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>

#include "tests/vm/speed/reference_round_trips.hpp"

namespace {

void note_end(libusb_transfer* transfer) { *static_cast<int*>(transfer->user_data) = 1; }

bool is_whole(const libusb_transfer* transfer) {
  return transfer->status == LIBUSB_TRANSFER_COMPLETED && transfer->actual_length == 16;
}

std::optional<RoundTripFigures> exchange(libusb_context* context, libusb_device_handle* device,
                                         std::size_t round_trips) {
  unsigned char sent[16] = {};
  unsigned char answer[64] = {};
  int is_sent = 0;
  int is_back = 0;
  libusb_transfer* out = libusb_alloc_transfer(0);
  libusb_transfer* in = libusb_alloc_transfer(0);
  libusb_fill_bulk_transfer(out, device, 0x02, sent, sizeof sent, note_end, &is_sent, 0);
  libusb_fill_bulk_transfer(in, device, 0x81, answer, sizeof answer, note_end, &is_back, 0);
  const auto prepare = [&](std::size_t number) {
    std::memcpy(sent, &number, sizeof number);
    is_sent = is_back = 0;
    return libusb_submit_transfer(in) == 0;
  };
  std::optional<RoundTripFigures> figures = measured(round_trips, prepare, [&] {
    const bool is_out = libusb_submit_transfer(out) == 0;
    while (is_out && is_sent == 0) libusb_handle_events_completed(context, &is_sent);
    while (is_back == 0) libusb_handle_events_completed(context, &is_back);
    return is_out && is_whole(out) && is_whole(in) && std::memcmp(answer, sent, 16) == 0;
  });
  if (!figures) {
    std::fprintf(stderr, "sent %d, %d bytes; back %d, %d bytes\n", out->status, out->actual_length,
                 in->status, in->actual_length);
  }
  libusb_free_transfer(in);
  libusb_free_transfer(out);
  return figures;
}

}  // namespace

std::optional<RoundTripFigures> reference_usb_round_trips(const ReferenceNodes& nodes,
                                                          std::size_t round_trips) {
  libusb_context* context = nullptr;
  const int node = ::open(nodes.node, O_RDWR | O_CLOEXEC);
  if (node < 0 || libusb_init(&context) != 0) return std::nullopt;
  std::optional<RoundTripFigures> figures;
  libusb_device_handle* device = nullptr;
  int error = libusb_wrap_sys_device(context, node, &device);
  if (error == 0) error = libusb_claim_interface(device, 0);
  if (error == 0) figures = exchange(context, device, round_trips);
  if (error != 0) std::fprintf(stderr, "%s: %s\n", nodes.node, libusb_error_name(error));
  if (device != nullptr) libusb_close(device);
  libusb_exit(context);
  ::close(node);
  return figures;
}
