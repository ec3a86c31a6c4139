#include "daemon/app/recording_book.hpp"

#include <utility>

namespace thimble::app {

void RecordingBook::note(const std::string& arm, const Fault& stop, std::string what) {
  std::vector<Entry>& entries = entries_[arm];
  if (entries.size() == kKept) entries.erase(entries.begin());
  entries.push_back({stop, std::move(what)});
}

std::string RecordingBook::find(const std::string& arm, const Fault& stop) const {
  const auto entries = entries_.find(arm);
  if (entries == entries_.end()) return "";
  for (const Entry& entry : entries->second) {
    if (entry.stop.number == stop.number && entry.stop.tick == stop.tick) return entry.what;
  }
  return "";
}

}  // namespace thimble::app
