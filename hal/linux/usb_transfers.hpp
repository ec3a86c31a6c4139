#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/usb_mailboxes.hpp"

struct libusb_context;
struct libusb_device_handle;
struct libusb_transfer;

namespace thimble::linux {

// Moves the packets of one opened USB device between its mailboxes and the kernel, by libusb's
// asynchronous transfers: all of them, and their buffers, are allocated when it is opened. Two are
// always pending on each IN pipe; a finished one is handed back to the kernel with its other buffer
// before its packet is delivered. No transfer has a time-out.
//
// A context of its own per device, without discovery: nobody else's opening or closing can hold up
// this one (libusb keeps a lock of the context while callbacks run).
//
// A device that floods is not kept up with: after 62 reads within 1 ms (those and the two that are
// pending fill kUsbQueuedPackets; at full speed a frame has 19), or one for which there is no room
// because nobody reads, an IN pipe rests for 1 ms, ours: a full-speed frame. Whatever it sends,
// this thread has the priority of arms and may not be kept busy by it.
//
// After a stall the other transfers of the pipe are taken back, the halt is cleared and they are
// sent anew; after a failure on the wire the next try is 1 ms later, a full-speed frame. Clearing
// may block for 5 s (the kernel's USB_CTRL_SET_TIMEOUT), so it comes after everything else that can
// be handed over, output first, and for an IN pipe 50 ms after the stall: ours, the arm has been
// let go by then. An unplugged device is told of by its transfers, and by its node when there is
// none.
//
// Thread: everything from the bus's own thread, once opened. Not RT: libusb allocates and locks for
// each submission, and clearing a halt may block in the kernel.
// Ownership: owns the node's descriptor; the mailboxes and the clock must outlive it. Its
// destructor cancels and awaits what is pending, at most 1 s: ours, for a bad hub, since a
// cancelled transfer comes back within a frame. Errors: Result when opening; later they end in the
// mailboxes.
class UsbTransfers {
 public:
  // `node` is the opened /dev/bus/usb/BBB/DDD; it is closed in every case. A kernel driver is taken
  // off the interface, and put back by the destructor. Busy when another user of usbfs has claimed
  // it; NotFound for a device that is gone or has no such interface; Permission, System.
  [[nodiscard]] static Result<std::unique_ptr<UsbTransfers>> open(int node,
                                                                  std::uint8_t interface_number,
                                                                  bus::UsbMailboxes& mail,
                                                                  const Clock& clock);
  ~UsbTransfers();
  UsbTransfers(const UsbTransfers&) = delete;
  UsbTransfers& operator=(const UsbTransfers&) = delete;

  // Hands to the kernel what waits in the mailboxes, and what has to be asked for again.
  void serve() noexcept;
  // What ended a wait(): both, one, or neither, when it is time to try again.
  struct Woken {
    bool is_signalled{false};  // the descriptor is readable
    bool has_events{false};    // there is something for handle_events()
  };
  // Until a transfer ends, the descriptor `wake` is readable, or it is time to try again.
  [[nodiscard]] Woken wait(int wake) noexcept;
  // Brings home what has ended. Never waits.
  void handle_events() noexcept;
  // Before closing: the newest packet that waits for each OUT pipe, once what is under way has
  // ended. Waits at most 20 ms for that and as long for the end of the last: ours, a device that
  // takes one does so within a frame or two. A pipe that still has one under way then gets no
  // other. A halt of an OUT pipe is cleared, which may block.
  void send_last() noexcept;

 private:
  class Transfer;
  struct Pipe;
  struct Watched {  // by poll(2)
    int descriptor{-1};
    short events{0};
  };

  UsbTransfers(int node, std::uint8_t interface_number, bus::UsbMailboxes& mail,
               const Clock& clock) noexcept;
  [[nodiscard]] Result<void> start();
  [[nodiscard]] Result<void> allocate();
  void serve_pipes(bool is_halted) noexcept;
  void serve_pipe(Pipe& pipe) noexcept;
  void serve_halt(Pipe& pipe) noexcept;
  void serve_in(Pipe& pipe) noexcept;
  void serve_out(Pipe& pipe) noexcept;
  std::size_t fill_out(Transfer& transfer) noexcept;
  void serve_control() noexcept;
  bool submit(Transfer& transfer) noexcept;
  void ended(Transfer& transfer) noexcept;
  void ended_in(Transfer& transfer, bus::UsbOutcome outcome) noexcept;
  void ended_out(Transfer& transfer, bus::UsbOutcome outcome) noexcept;
  void ended_control(Transfer& transfer, bus::UsbOutcome outcome) noexcept;
  void cancel_all() noexcept;
  void await_outputs() noexcept;
  [[nodiscard]] bool has_to_try_again() const noexcept;

  int node_;
  std::uint8_t interface_number_;
  bus::UsbMailboxes* mail_;
  const Clock* clock_;
  libusb_context* context_{nullptr};
  libusb_device_handle* handle_{nullptr};
  std::vector<std::unique_ptr<Pipe>> pipes_;
  std::unique_ptr<Transfer> control_;
  std::vector<Watched> watched_;  // libusb's, which stay the same after opening
  std::size_t under_way_{0};
  bool is_claimed_{false};
  bool is_closing_{false};
};

}  // namespace thimble::linux
