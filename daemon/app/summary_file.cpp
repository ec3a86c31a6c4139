#include "daemon/app/summary_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <memory>
#include <utility>

#include "hal/base/time.hpp"
#include "hal/linux/background_worker.hpp"

namespace thimble::app {
namespace {

// Ours; with those of the daemon's end and of recordings, within TimeoutStopSec= of the unit.
constexpr Duration kPatience = std::chrono::seconds(2);

bool replace(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::trunc);
  file << text;
  file.close();
  return !file.fail();
}

}  // namespace

Result<void> SummaryFile::refused(const std::string& why) const {
  return fail(Errc::System, "the summary could not be written to " + path_.value_or("") + why);
}

// Not a pipe that nobody reads: opening it would last for ever.
Result<void> SummaryFile::prepare() {
  if (!path_) return {};
  constexpr int kHow = O_WRONLY | O_APPEND | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;
  int file = ::open(path_->c_str(), kHow | O_CREAT | O_EXCL, 0666);
  is_made_ = file >= 0;
  if (file < 0) file = ::open(path_->c_str(), kHow | O_CREAT, 0666);
  if (file < 0) return refused(std::string(": ") + std::strerror(errno));
  ::close(file);
  return {};
}

void SummaryFile::leave_out() noexcept {
  if (std::exchange(is_made_, false)) ::unlink(path_->c_str());
}

Result<void> SummaryFile::write(const std::string& text) {
  if (!path_) return {};
  const auto is_written = std::make_shared<std::atomic<bool>>(false);
  linux::BackgroundWorker worker;
  worker.post([=, path = *path_] { *is_written = replace(path, text); });
  if (worker.wait(kPatience) && *is_written) return {};
  return refused("");
}

}  // namespace thimble::app
