#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "daemon/link/tty_ports.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace thimble::linux {
class BackgroundWorker;
}

namespace thimble::app {

// Opens and closes serial lines of links, each device's in a thread of its own, one after the
// other: an adapter that does not answer keeps the kernel for 5 s in each (USB_CTRL_SET_TIMEOUT)
// and for 30 s with bytes that do not leave, and nobody else with it.
//
// Thread: one; a line may be let go by any. Not RT; the threads have no priority. Ownership: may
// end before its lines. Its end does not wait for what hangs, and so may leave a line unclosed to
// the end of the process: who wants it closed asks late_after() before. Errors: those of `open`,
// and System where no more threads can be had.
class SerialLines {
 public:
  using Open =
      std::function<Result<link::LineNode>(const std::string& node, std::uint32_t bit_per_s)>;

  explicit SerialLines(Open open);  // which may wait, as may whatever ends with its last owner
  ~SerialLines();
  SerialLines(const SerialLines&) = delete;
  SerialLines& operator=(const SerialLines&) = delete;

  // As link::OpenLine.
  [[nodiscard]] std::future<Result<link::LineNode>> open(const std::string& node,
                                                         std::uint32_t bit_per_s);
  // Those devices of which not all is opened and closed after `patience`, for all of them together.
  [[nodiscard]] std::vector<std::string> late_after(Duration patience, const Clock& clock);

 private:
  Open open_;
  std::map<std::string, std::shared_ptr<linux::BackgroundWorker>> workers_;  // by node
};

}  // namespace thimble::app
