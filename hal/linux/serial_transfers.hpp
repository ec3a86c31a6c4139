#pragma once

#include <memory>
#include <string>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/serial_mailboxes.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/device_calls.hpp"

namespace thimble::linux {

// What the bus does with an opened serial port: the calls of a terminal's node, raw and never
// blocking. The node is this process's alone: flock against another daemon, TIOCEXCL against
// everybody who does not look for that.
//
// Nothing is written while the kernel still has bytes of an earlier message: it keeps many (16
// writes for CDC-ACM), and each would reach the arm after the newer one was wished for.
//
// Thread: one, but the construction and destruction. Not RT, but no call waits beside wait() and
// send_last(). Ownership: the mailboxes, the clock and the calls must outlive it. Closing a port
// whose device takes nothing may last as long as the kernel likes (30 s where a driver cannot
// discard). Errors: Result when opening; a device that is gone shows in the mailboxes.
class SerialTransfers {
 public:
  // What the kernel had received before is discarded. NotFound, Permission, Busy (another process
  // holds it), InvalidArgument (no such rate) or System.
  [[nodiscard]] static Result<std::unique_ptr<SerialTransfers>> open(const std::string& node,
                                                                     const bus::SerialLine& line,
                                                                     bus::SerialMailboxes& mail,
                                                                     const Clock& clock,
                                                                     DeviceCalls& calls);
  ~SerialTransfers();
  SerialTransfers(const SerialTransfers&) = delete;
  SerialTransfers& operator=(const SerialTransfers&) = delete;

  // Brings what has arrived to the mailboxes, in at most kMostReads chunks within kReadWindow; what
  // comes after them waits in the kernel meanwhile.
  void receive() noexcept;
  // Writes what waits in the mailbox as far as the kernel takes it. True: nothing is left.
  bool send() noexcept;
  // What wait() ended for. None of both: there is room for what is left to send, or it is time to
  // look again.
  struct Ready {
    bool is_woken{false};   // `event` is readable
    bool has_bytes{false};  // something to receive, or the device is gone
  };
  // Until there is something that receive() would take, room for what is left to send, or `event`
  // is readable.
  [[nodiscard]] Ready wait(int event) const noexcept;
  // send() again and again until the device has all of it, at most 20 ms: ours, as of a USB device
  // (UsbTransfers::send_last()).
  void send_last() noexcept;
  // A device that floods may not keep this thread busy, which has the priority of arms, nor its
  // servo, which looks at each byte. Ours: a message has some 60 bytes and comes once a
  // millisecond, be it in pieces; so many reads are 4 KiB.
  static constexpr int kMostReads = 8;
  static constexpr Duration kReadWindow = std::chrono::milliseconds(1);
  // Open as long as this lives.
  [[nodiscard]] int node() const noexcept { return node_.get(); }

 private:
  enum class Left : std::uint8_t {
    Nothing,
    Room,
    Earlier
  };  // what the rest of a message waits for

  SerialTransfers(Descriptor node, bus::SerialMailboxes& mail, const Clock& clock,
                  DeviceCalls& calls)
      : node_(std::move(node)), mail_(&mail), clock_(&clock), calls_(&calls) {}
  [[nodiscard]] bool is_kernel_done() const noexcept;
  [[nodiscard]] Duration rest() const noexcept;  // until it may read again
  void fail_unless_later() noexcept;

  Descriptor node_;
  bus::SerialMailboxes* mail_;
  const Clock* clock_;
  DeviceCalls* calls_;
  Left left_{Left::Nothing};
  MonotonicTime first_read_{};  // of this window
  int reads_{0};
};

}  // namespace thimble::linux
