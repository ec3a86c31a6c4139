#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/link/line_port.hpp"
#include "hal/base/time.hpp"

namespace thimble::lab {

// Serial lines between sessions of one process, in virtual time. Each session is on a host, which
// has a device of every name; those of the same name on two hosts are joined. Every byte takes its
// ten bits at the rate of who sends it, and is heard at the rate of who hears it (uart.hpp). What
// nobody is there to hear is lost, as on a line: it has no flow control. A device that is open is
// held against a second opening on its host, as the daemon holds it.
//
// Thread: one. Ownership: `clock` must outlive it, and it the ports of all hosts. Deterministic.
class VirtualLines {
 public:
  VirtualLines(const Clock& clock, std::size_t hosts);
  ~VirtualLines();
  VirtualLines(const VirtualLines&) = delete;
  VirtualLines& operator=(const VirtualLines&) = delete;

  [[nodiscard]] link::LinePorts& host(std::size_t i) noexcept;
  // Whatever has arrived, has been taken, or is due, each once, in the order of the ports' making.
  void pass();
  // When pass() has something to do; nothing: when somebody sends.
  [[nodiscard]] std::optional<MonotonicTime> due() const;

  // SOURCE: Linux, drivers/tty/serial/serial_core.c: what the kernel takes before it says no (a
  // page, UART_XMIT_SIZE), and how far that must have left before it takes more (WAKEUP_CHARS).
  static constexpr std::size_t kKernelTakes = 4096;
  static constexpr std::size_t kKernelWakes = 256;

 private:
  class Host;
  class Port;

  [[nodiscard]] Port* far_end_of(const Port& port) const;

  const Clock* clock_;
  std::vector<std::unique_ptr<Host>> hosts_;
  std::vector<Port*> ports_;  // in the order of their making
};

}  // namespace thimble::lab
