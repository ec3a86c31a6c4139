#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "daemon/session/arm_session.hpp"

namespace boost::asio {
class thread_pool;
}

namespace thimble::app {

// Writes flight recordings on a thread of its own, so that a slow disk delays nobody.
//
// Thread: write() and finished() from one control thread. Not RT.
// Ownership: the destructor waits until all is written.
class RecordingWriter {
 public:
  struct Outcome {
    std::string arm;
    FaultCode cause{};
    std::string path;        // empty when it could not be written
    std::string error;       // why
    std::size_t removed{0};  // older recordings that made room
  };

  explicit RecordingWriter(std::string directory);
  ~RecordingWriter();

  void write(session::Recording recording);
  // What has been finished since the last call.
  [[nodiscard]] std::vector<Outcome> finished();
  // Waits until all is written; more may be written afterwards.
  void flush();

 private:
  std::string directory_;
  std::mutex mutex_;
  std::vector<Outcome> finished_;
  std::unique_ptr<boost::asio::thread_pool> worker_;
};

}  // namespace thimble::app
