#pragma once

namespace thimble::cli {

// Ctrl-C and its kin, taken as an event instead of an end: while it lives, SIGINT, SIGTERM and
// SIGHUP only wake wait().
//
// Thread: the only one of the process.
class Interrupts {
 public:
  enum class Woken { Signal, Readable, Timeout };

  Interrupts();
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  // Waits for a signal, for `descriptor` to be readable (-1: none), or `timeout_s` (< 0: for ever).
  Woken wait(int descriptor, double timeout_s);

 private:
  int signals_;
};

}  // namespace thimble::cli
