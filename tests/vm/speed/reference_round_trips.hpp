#pragma once

#include <cstddef>
#include <optional>

#include "tests/vm/speed/round_trip_figures.hpp"

// What an exchange of 16 bytes with a device takes that sends them back: one thread, the library's
// own calls, nothing around them. Nothing when the device does not open or one fails.

// The device's nodes in /dev.
struct ReferenceNodes {
  const char* node;
  const char* hiddev;  // where reports of a HID device leave; null: where the others come in
};

// hidapi: hid_write, or the two requests of hiddev that send a report; then hid_read.
std::optional<RoundTripFigures> reference_hid_round_trips(const ReferenceNodes& nodes,
                                                          std::size_t round_trips);
// libusb: a transfer waits on 0x81 before one is submitted to 0x02.
std::optional<RoundTripFigures> reference_usb_round_trips(const ReferenceNodes& nodes,
                                                          std::size_t round_trips);
// The C library and the kernel: write, then read, of a raw terminal.
std::optional<RoundTripFigures> reference_serial_round_trips(const ReferenceNodes& nodes,
                                                             std::size_t round_trips);
