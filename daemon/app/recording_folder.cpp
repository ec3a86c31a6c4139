#include "daemon/app/recording_folder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <tuple>

#include "hal/linux/replace_file.hpp"

namespace thimble::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "flight-";
constexpr std::string_view kSuffix = ".csv";
constexpr std::string_view kPartPrefix = ".";
constexpr std::string_view kPartSuffix = ".part";
constexpr int kMaxNumber = 999'999'999;
constexpr int kMaxTries = 1000;  // names that others are writing, or were when they died
constexpr auto kStale = std::chrono::hours(1);

std::string file_name(const std::string& arm, int number, FaultCode code) {
  return std::string(kPrefix) + arm + "-" + std::to_string(number) + "-" +
         std::string(to_string(code)) + std::string(kSuffix);
}

std::string part_name(const std::string& name) {
  return std::string(kPartPrefix).append(name).append(kPartSuffix);
}

bool take_around(std::string_view& text, std::string_view prefix, std::string_view suffix) {
  if (text.size() < prefix.size() + suffix.size()) return false;
  if (!text.starts_with(prefix) || !text.ends_with(suffix)) return false;
  text.remove_prefix(prefix.size());
  text.remove_suffix(suffix.size());
  return true;
}

// As the configuration allows them.
bool is_arm_name(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  });
}

bool is_part(std::string_view name) {
  return take_around(name, kPartPrefix, kPartSuffix) && parse_recording_name(name).has_value();
}

tl::unexpected<Error> refused(const std::string& path, int error) {
  return fail(Errc::System, path + ": " + std::strerror(error));
}

// Takes the descriptor. 0, or the errno of what failed; a disk may tell only at the end.
int write_and_close(int descriptor, std::string_view text) {
  int error = linux::write_all(descriptor, text);
  if (error == 0 && ::fsync(descriptor) != 0) error = errno;
  if (::close(descriptor) != 0 && error == 0) error = errno;
  return error;
}

// The name, too, is to survive a loss of power. 0, or the errno.
int sync_folder(const std::string& directory) {
  const int descriptor = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int error = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return error;
}

struct Found {
  fs::file_time_type written;
  std::string path;
};

// Recordings of an arm, and what is left of anybody's unfinished ones. What cannot be read is not
// there.
struct Folder {
  std::vector<Found> recordings;
  std::vector<Found> parts;
  int next_number{1};
};

Folder list(const std::string& directory, const std::string& arm) {
  Folder out;
  std::error_code error;
  for (fs::directory_iterator it(directory, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const auto recording = parse_recording_name(name);
    if (recording ? recording->arm != arm : !is_part(name)) continue;
    if (recording) {
      out.next_number = std::max(out.next_number, std::min(recording->number, kMaxNumber - 1) + 1);
    }
    std::error_code ignored;
    if (it->symlink_status(ignored).type() != fs::file_type::regular) continue;
    const fs::file_time_type written = it->last_write_time(ignored);
    if (ignored) continue;
    (recording ? out.recordings : out.parts).push_back({written, it->path().string()});
  }
  return out;
}

// `kept` is the one of the arm just written: whatever the clocks say, it is the newest.
std::size_t remove_oldest(const std::string& directory, const std::string& arm,
                          const std::string& kept) {
  Folder folder = list(directory, arm);
  std::error_code ignored;
  const fs::file_time_type now = fs::last_write_time(kept, ignored);
  for (const Found& part : folder.parts) {
    if (!ignored && now - part.written > kStale) ::unlink(part.path.c_str());
  }
  auto& all = folder.recordings;
  all.erase(std::remove_if(all.begin(), all.end(), [&](const Found& f) { return f.path == kept; }),
            all.end());
  if (all.size() < kMaxRecordings) return 0;
  std::sort(all.begin(), all.end(), [](const Found& a, const Found& b) {
    return std::tie(a.written, a.path) < std::tie(b.written, b.path);
  });
  all.resize(all.size() - (kMaxRecordings - 1));
  return static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [](const Found& f) { return ::unlink(f.path.c_str()) == 0; }));
}

}  // namespace

std::optional<RecordingName> parse_recording_name(std::string_view name) {
  if (!take_around(name, kPrefix, kSuffix)) return std::nullopt;
  for (std::size_t code = 0; code < kFaultCodeCount; ++code) {
    const std::string word = "-" + std::string(to_string(static_cast<FaultCode>(code)));
    if (!name.ends_with(word)) continue;
    const std::string_view rest = name.substr(0, name.size() - word.size());
    const std::size_t dash = rest.rfind('-');
    if (dash == std::string_view::npos || !is_arm_name(rest.substr(0, dash))) continue;
    RecordingName out{std::string(rest.substr(0, dash)), 0};
    const std::string_view digits = rest.substr(dash + 1);
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), out.number);
    const bool is_whole = error == std::errc{} && end == digits.data() + digits.size();
    if (!is_whole || out.number < 1 || std::to_string(out.number) != digits) continue;
    return out;
  }
  return std::nullopt;
}

Result<void> check_recording_folder(const std::string& directory) {
  std::error_code error;
  fs::path path = fs::absolute(directory, error);
  for (; !error && path.has_relative_path(); path = path.parent_path()) {
    const fs::file_status found = fs::status(path, error);
    if (fs::is_directory(found)) return {};
    if (fs::exists(found)) {
      return fail(Errc::InvalidArgument, path.string() + " is no folder for recordings");
    }
    error.clear();  // it is not there, or beneath what is no folder
  }
  return {};
}

Result<void> check_recordings_can_be_made(const std::string& directory) {
  std::error_code error;
  fs::path path = fs::absolute(directory, error);
  if (error) return fail(Errc::System, directory + ": " + error.message());
  while (path.has_relative_path() && ::access(path.c_str(), F_OK) != 0 && errno == ENOENT) {
    path = path.parent_path();
  }
  if (::access((path / ".").c_str(), W_OK | X_OK) != 0) return refused(path, errno);
  return {};
}

Result<StoredRecording> store_recording(const std::string& directory,
                                        const servo::FlightHeader& header,
                                        const std::vector<servo::ServoFrame>& frames) {
  std::error_code made;
  fs::create_directories(directory, made);
  if (made) return fail(Errc::System, directory + ": " + made.message());
  const int first = list(directory, header.arm).next_number;
  for (int number = first; number < first + kMaxTries; ++number) {
    const std::string name = file_name(header.arm, number, header.fault.code);
    const std::string path = fs::path(directory) / name;
    const std::string part = fs::path(directory) / part_name(name);
    // Who has the part has the name: another process takes the next one.
    const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (descriptor < 0 && errno == EEXIST) continue;
    if (descriptor < 0) return refused(path, errno);
    std::error_code ignored;
    const bool is_taken = fs::symlink_status(path, ignored).type() != fs::file_type::not_found;
    int error = write_and_close(descriptor, is_taken ? "" : servo::format_flight(header, frames));
    if (error == 0 && !is_taken && ::rename(part.c_str(), path.c_str()) != 0) error = errno;
    if (error != 0 || is_taken) ::unlink(part.c_str());
    if (error == 0 && !is_taken) error = sync_folder(directory);
    if (error != 0) return refused(path, error);
    if (!is_taken) return StoredRecording{path, remove_oldest(directory, header.arm, path)};
  }
  return fail(Errc::System, directory + ": holds too many unfinished recordings, remove them");
}

}  // namespace thimble::app
