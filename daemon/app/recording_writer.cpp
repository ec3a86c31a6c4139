#include "daemon/app/recording_writer.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>
#include <exception>
#include <future>
#include <utility>

#include "daemon/app/recording_folder.hpp"

namespace thimble::app {

RecordingWriter::RecordingWriter(std::string directory)
    : directory_(std::move(directory)), worker_(std::make_unique<boost::asio::thread_pool>(1)) {}

RecordingWriter::~RecordingWriter() { worker_->join(); }

namespace {

// An exception that left the worker would end the process, and with it every other arm's servo.
Result<StoredRecording> store(const std::string& directory, const session::Recording& recording) {
  try {
    return store_recording(directory, recording.header, recording.frames);
  } catch (const std::exception& error) {
    return fail(Errc::System, directory + ": " + error.what());
  }
}

}  // namespace

void RecordingWriter::write(session::Recording recording) {
  boost::asio::post(*worker_, [this, recording = std::move(recording)] {
    const Result<StoredRecording> stored = store(directory_, recording);
    const servo::FlightHeader& header = recording.header;
    const std::lock_guard lock(mutex_);
    if (stored) {
      finished_.push_back({header.arm, header.fault.code, stored->path, "", stored->removed});
    } else {
      finished_.push_back({header.arm, header.fault.code, "", stored.error().message, 0});
    }
  });
}

std::vector<RecordingWriter::Outcome> RecordingWriter::finished() {
  const std::lock_guard lock(mutex_);
  return std::exchange(finished_, {});
}

void RecordingWriter::flush() {
  std::promise<void> reached;
  boost::asio::post(*worker_, [&] { reached.set_value(); });
  reached.get_future().wait();
}

}  // namespace thimble::app
