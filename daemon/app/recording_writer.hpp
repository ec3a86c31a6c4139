#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/app/recording_folder.hpp"
#include "daemon/session/arm_session.hpp"
#include "hal/linux/background_worker.hpp"

namespace thimble::app {

// Writes flight recordings on a thread of its own, so that a slow disk delays nobody, and one that
// hangs not even the end of the process.
//
// Thread: write(), finished() and flush() from one control thread. Not RT.
// Ownership: the destructor drops what is not written yet: flush() before.
class RecordingWriter {
 public:
  struct Outcome {
    std::string arm;
    Fault stop{};
    std::string path;        // empty when it could not be written
    std::string error;       // why
    std::size_t removed{0};  // older recordings that made room
  };
  // For as many arms as this, or more: one stop of all of them is recorded, and a disk that hangs
  // holds no more. Half a megabyte each at 1 kHz, 4 MB at 8 kHz, in memory that is locked; twice
  // that has each arm's recorder. Ours.
  static constexpr std::size_t kFewestWaiting = 4;
  using Store = std::function<Result<StoredRecording>(const session::Recording&)>;

  // Of so many arms.
  RecordingWriter(const std::string& directory, std::size_t arms);
  RecordingWriter(Store store, std::size_t arms);

  // When one for each arm, or kFewestWaiting, are not on the disk yet, this one is lost, and told
  // so by finished().
  void write(session::Recording recording);
  // What has been finished since the last call.
  [[nodiscard]] std::vector<Outcome> finished();
  // Once, why none will be: the folder was looked at when this was made.
  [[nodiscard]] std::optional<std::string> take_doubt();
  // Whether all is written within `patience`; more may be written afterwards.
  [[nodiscard]] bool flush(Duration patience) { return worker_.wait(patience); }

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;  // of the worker, too
  std::size_t most_waiting_;
  linux::BackgroundWorker worker_;
};

}  // namespace thimble::app
