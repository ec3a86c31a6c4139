#pragma once

#include <cstddef>
#include <vector>

// Seconds that an exchange of 16 bytes with a device takes that sends them back: one thread, the
// library's own calls, nothing around them. Empty when the device does not open or one fails.

// `path`: the device's node. hidapi: hid_write, then hid_read.
std::vector<double> reference_hid_round_trips(const char* path, std::size_t round_trips);
// libusb: a transfer waits on 0x81 before one is submitted to 0x02.
std::vector<double> reference_usb_round_trips(const char* path, std::size_t round_trips);
// The C library and the kernel: write, then read, of a raw terminal.
std::vector<double> reference_serial_round_trips(const char* path, std::size_t round_trips);
