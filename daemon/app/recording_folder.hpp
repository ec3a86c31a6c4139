#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/servo/flight_file.hpp"

namespace thimble::app {

// Of each arm; its oldest go (decisions 0112 and 0374).
inline constexpr std::size_t kMaxRecordings = 32;

// What the name of a recording says: "flight-ARM-NUMBER-FAULT.csv".
struct RecordingName {
  std::string arm;
  int number{0};
  bool operator==(const RecordingName&) const = default;
};

// Nothing for a name that format_name() cannot have made. Total.
[[nodiscard]] std::optional<RecordingName> parse_recording_name(std::string_view name);

// Whether recordings can lie there: InvalidArgument where a part of the path is there and is no
// folder. Thread: any, not RT.
[[nodiscard]] Result<void> check_recording_folder(const std::string& directory);

// Whether this process may make recordings there, or the folders that are missing: System, with the
// path and the system's word. Makes nothing; a full disk is seen when one is written. May wait for
// a disk. Thread: any, not RT.
[[nodiscard]] Result<void> check_recordings_can_be_made(const std::string& directory);

struct StoredRecording {
  std::string path;
  std::size_t removed{0};  // older recordings, to stay within kMaxRecordings
};

// Writes a recording into `directory`, which it makes if need be, under the next number of the
// arm: whole and on the disk, or not at all. Nothing is overwritten; then the arm's oldest
// recordings beyond kMaxRecordings are removed, and never a file whose name is not one of ours.
// Thread: any, one at a time in this process; other processes may use the folder, too. Not RT.
// Errors: System, with the path and the system's word.
[[nodiscard]] Result<StoredRecording> store_recording(const std::string& directory,
                                                      const servo::FlightHeader& header,
                                                      const std::vector<servo::ServoFrame>& frames);

}  // namespace thimble::app
