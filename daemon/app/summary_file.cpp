#include "daemon/app/summary_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "hal/base/contain.hpp"
#include "hal/linux/background_worker.hpp"
#include "hal/linux/replace_file.hpp"

namespace thimble::app {
namespace {

// Ours; with those of the daemon's end and of recordings, within TimeoutStopSec= of the unit.
constexpr std::chrono::seconds kPatience{2};

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
  const auto written = std::make_shared<Result<void>>();
  const Result<void> waited = contain([&]() -> Result<void> {
    linux::BackgroundWorker worker;  // there may be no thread for it
    worker.post([written, text, path = *path_] { *written = linux::replace_file(path, text); });
    if (worker.wait(kPatience)) return {};
    return fail(Errc::Timeout,
                "its disk did not take it in " + std::to_string(kPatience.count()) + " s");
  });
  if (!waited) return refused(": " + waited.error().message);
  if (!*written) return refused(": " + written->error().message);
  return {};
}

}  // namespace thimble::app
