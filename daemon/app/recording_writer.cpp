#include "daemon/app/recording_writer.hpp"

#include <algorithm>
#include <mutex>
#include <string>
#include <utility>

#include "hal/base/contain.hpp"

namespace thimble::app {

struct RecordingWriter::Shared {
  Store store;
  std::mutex mutex;
  std::vector<Outcome> finished;
  std::optional<std::string> doubt;
  std::size_t waiting{0};  // also the one that is being written
};

RecordingWriter::RecordingWriter(const std::string& directory, std::size_t arms)
    : RecordingWriter(
          [directory](const session::Recording& recording) {
            return store_recording(directory, recording.header, recording.frames);
          },
          arms) {
  worker_.post([shared = shared_, directory] {
    const Result<void> checked = contain([&] { return check_recordings_can_be_made(directory); });
    if (checked) return;
    const std::lock_guard lock(shared->mutex);
    shared->doubt = checked.error().message;
  });
}

RecordingWriter::RecordingWriter(Store store, std::size_t arms)
    : shared_(std::make_shared<Shared>()), most_waiting_(std::max(arms, kFewestWaiting)) {
  shared_->store = std::move(store);
}

void RecordingWriter::write(session::Recording recording) {
  {
    const std::lock_guard lock(shared_->mutex);
    if (shared_->waiting == most_waiting_) {
      const servo::FlightHeader& header = recording.header;
      shared_->finished.push_back({header.arm, header.fault, "",
                                   "the disk still has not taken the " +
                                       std::to_string(most_waiting_) + " recordings before it",
                                   0});
      return;
    }
    ++shared_->waiting;
  }
  auto kept = std::make_shared<const session::Recording>(std::move(recording));
  worker_.post([shared = shared_, kept = std::move(kept)] {
    const Result<StoredRecording> stored = contain([&] { return shared->store(*kept); });
    const servo::FlightHeader& header = kept->header;
    const std::lock_guard lock(shared->mutex);
    --shared->waiting;
    if (stored) {
      shared->finished.push_back({header.arm, header.fault, stored->path, "", stored->removed});
    } else {
      shared->finished.push_back({header.arm, header.fault, "", stored.error().message, 0});
    }
  });
}

std::optional<std::string> RecordingWriter::take_doubt() {
  const std::lock_guard lock(shared_->mutex);
  return std::exchange(shared_->doubt, std::nullopt);
}

std::vector<RecordingWriter::Outcome> RecordingWriter::finished() {
  const std::lock_guard lock(shared_->mutex);
  return std::exchange(shared_->finished, {});
}

}  // namespace thimble::app
