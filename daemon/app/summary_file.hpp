#pragma once

#include <optional>
#include <string>

#include "hal/base/result.hpp"

namespace thimble::app {

// Where a daemon leaves its final status. Without a path nothing is written anywhere.
// Thread: control thread. Not RT.
// Errors: System, with the path.
class SummaryFile {
 public:
  explicit SummaryFile(std::optional<std::string> path) : path_(std::move(path)) {}

  // Whether it can be written, before an experiment rather than after it: makes it where nothing
  // is, and leaves what an earlier one left there until there is something better.
  [[nodiscard]] Result<void> prepare();
  // There will be none: what prepare() made goes again.
  void leave_out() noexcept;
  // Replaces what is there. Gives up after 2 s: a place that takes nothing (a pipe that nobody
  // reads) would keep the process for ever.
  [[nodiscard]] Result<void> write(const std::string& text);

 private:
  [[nodiscard]] Result<void> refused(const std::string& why) const;

  std::optional<std::string> path_;
  bool is_made_{false};
};

}  // namespace thimble::app
