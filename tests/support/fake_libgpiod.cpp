// libgpiod 1.6 at link level: see fake_libgpiod.hpp. A program that lists this file among its
// sources never calls the real library.
#include "tests/support/fake_libgpiod.hpp"

#include <fcntl.h>
#include <gpiod.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <utility>

namespace thimble::test {

struct FakeGpioChip::Line {
  std::string name;
  bool is_high{false};
  bool is_output{false};
  bool is_failing{false};
  int flags{0};
  std::deque<bool> events;
  std::array<int, 2> pipe{-1, -1};  // a byte for each event; empty: not requested for events
  bool is_taken{false};
  std::string consumer;
};

}  // namespace thimble::test

using thimble::test::FakeGpioChip;

// libgpiod's own names. A line outlives its chip's plug, not its closing.
struct gpiod_line {
  gpiod_chip* chip;
  std::size_t offset;
  bool is_mine;
};
struct gpiod_chip {
  FakeGpioChip* fake;
  std::uint64_t generation;
  std::vector<std::unique_ptr<gpiod_line>> lines;
};

namespace thimble::test {

struct FakeLibgpiod {
  using Line = FakeGpioChip::Line;

  mutable std::recursive_mutex lock;
  std::map<std::string, FakeGpioChip*> nodes;
  int alive{0};

  static FakeLibgpiod& instance() {
    static FakeLibgpiod fake;
    return fake;
  }
  static int refuse(int code) {
    errno = code;
    return -1;
  }
  gpiod_chip* open(const char* path) {
    const std::lock_guard guard(lock);
    const auto found = nodes.find(std::filesystem::weakly_canonical(path).string());
    if (found == nodes.end() || !found->second->is_plugged_ || found->second->is_forbidden_) {
      errno = found != nodes.end() && found->second->is_forbidden_ ? EACCES : ENOENT;
      return nullptr;
    }
    ++alive;
    return new gpiod_chip{found->second, found->second->generation_, {}};
  }
  void close(gpiod_chip* chip) {
    const std::lock_guard guard(lock);
    for (const auto& line : chip->lines) {
      if (line->is_mine) release(state_of(*line));
    }
    delete chip;
    --alive;
  }
  static void release(Line& line) {
    line.is_taken = line.is_output = false;
    line.consumer.clear();
    line.events.clear();
    for (int& end : line.pipe) {
      if (end >= 0) ::close(end);
      end = -1;
    }
  }
  static const char* label(gpiod_chip* chip) { return chip->fake->label_.c_str(); }
  static unsigned size(gpiod_chip* chip) {
    return static_cast<unsigned>(chip->fake->lines_.size());
  }
  static Line& state_of(const gpiod_line& line) { return line.chip->fake->lines_[line.offset]; }
  static bool is_dead(const gpiod_line& line) {
    return line.chip->generation != line.chip->fake->generation_;
  }
  static bool fails(const gpiod_line& line) {
    return line.chip->fake->is_failing_ || state_of(line).is_failing;
  }
  static gpiod_line* line(gpiod_chip* chip, std::size_t offset) {
    if (offset >= chip->fake->lines_.size()) {
      errno = EINVAL;
      return nullptr;
    }
    chip->lines.push_back(std::make_unique<gpiod_line>(gpiod_line{chip, offset, false}));
    return chip->lines.back().get();
  }
  static gpiod_line* find(gpiod_chip* chip, const std::string& name) {
    for (std::size_t i = 0; i < chip->fake->lines_.size(); ++i) {
      if (chip->fake->lines_[i].name == name) return line(chip, i);
    }
    errno = ENOENT;
    return nullptr;
  }
  enum class As { Output, Input, Edges };
  int request(gpiod_line& line, const char* consumer, As what, int flags) {
    const std::lock_guard guard(lock);
    Line& state = state_of(line);
    if (is_dead(line)) return refuse(ENODEV);
    if (state.is_taken) return refuse(EBUSY);
    state.is_taken = line.is_mine = true;
    state.consumer = consumer;
    state.is_output = what == As::Output;
    state.flags = flags;
    if (state.is_output) state.is_high = false;
    if (what == As::Edges && ::pipe2(state.pipe.data(), O_NONBLOCK | O_CLOEXEC) != 0) return -1;
    return 0;
  }
  int events(gpiod_line& line, gpiod_line_event* out, unsigned room) {
    const std::lock_guard guard(lock);
    Line& state = state_of(line);
    unsigned count = 0;
    char byte = 0;
    while (count < room && !state.events.empty() && ::read(state.pipe[0], &byte, 1) == 1) {
      out[count++].event_type =
          state.events.front() ? GPIOD_LINE_EVENT_RISING_EDGE : GPIOD_LINE_EVENT_FALLING_EDGE;
      state.events.pop_front();
    }
    return static_cast<int>(count);
  }
  int get(gpiod_line& line) {
    const std::lock_guard guard(lock);
    if (is_dead(line)) return refuse(ENODEV);
    if (line.chip->fake->before_answers_) line.chip->fake->before_answers_(line.offset);
    if (fails(line) || line.chip->fake->is_failing_questions_) return refuse(EIO);
    return state_of(line).is_high ? 1 : 0;
  }
  int set(gpiod_line& line, bool is_high) {
    const std::lock_guard guard(lock);
    if (is_dead(line)) return refuse(ENODEV);
    if (!fails(line)) state_of(line).is_high = is_high;
    return 0;
  }
};

FakeGpioChip::FakeGpioChip(std::string node, std::string label, std::vector<std::string> names)
    : node_(std::move(node)), label_(std::move(label)), lines_(names.size()) {
  std::ofstream(node_) << "";
  for (std::size_t i = 0; i < names.size(); ++i) lines_[i].name = std::move(names[i]);
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  node_ = std::filesystem::weakly_canonical(node_).string();
  FakeLibgpiod::instance().nodes[node_] = this;
}

FakeGpioChip::~FakeGpioChip() {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  FakeLibgpiod::instance().nodes.erase(node_);
}

void FakeGpioChip::tell(Line& line, bool is_high) {
  constexpr std::size_t kKernelEvents = 16;  // GPIO v1 of Linux 6.1: the FIFO of a line
  if (line.pipe[1] < 0 || line.events.size() == kKernelEvents) return;
  if (edges_to_lose_ > 0) {
    --edges_to_lose_;
    return;
  }
  line.events.push_back(is_high);
  static_cast<void>(::write(line.pipe[1], "e", 1) == 1);
}

void FakeGpioChip::set_wire(std::size_t line, bool is_high) {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  if (std::exchange(lines_.at(line).is_high, is_high) != is_high) tell(lines_[line], is_high);
}

bool FakeGpioChip::wire(std::size_t line) const {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  return lines_.at(line).is_high;
}

void FakeGpioChip::before_answers(std::function<void(std::size_t)> what) {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  before_answers_ = std::move(what);
}

void FakeGpioChip::lose_next_edges(int edges) {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  edges_to_lose_ += edges;
}

void FakeGpioChip::unplug() {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  is_plugged_ = false;
  ++generation_;
  for (Line& line : lines_) {
    if (line.is_output) line.is_high = false;  // no power, no level
    line.is_taken = false;
  }
}

void FakeGpioChip::replug() {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  is_plugged_ = true;
}

bool FakeGpioChip::is_told_of_edges(std::size_t line) const {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  return lines_.at(line).pipe[0] >= 0;
}

void FakeGpioChip::end_request(std::size_t line) {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  int& end = lines_.at(line).pipe[1];
  if (end >= 0) ::close(end);
  end = -1;
}

void FakeGpioChip::fail_transfers(bool is_failing) {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  is_failing_ = is_failing;
}

void FakeGpioChip::fail_line(std::size_t line, bool is_failing) {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  lines_.at(line).is_failing = is_failing;
}

void FakeGpioChip::fail_questions(bool is_failing) {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  is_failing_questions_ = is_failing;
}

void FakeGpioChip::forbid(bool is_forbidden) {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  is_forbidden_ = is_forbidden;
}

int FakeGpioChip::flags(std::size_t line) const {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  return lines_.at(line).flags;
}

void FakeGpioChip::take(std::size_t line, std::string consumer) {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  lines_.at(line).is_taken = true;
  lines_.at(line).consumer = std::move(consumer);
}

int FakeGpioChip::alive() {
  const std::lock_guard guard(FakeLibgpiod::instance().lock);
  return FakeLibgpiod::instance().alive;
}

}  // namespace thimble::test

using thimble::test::FakeLibgpiod;

namespace {
// The library has no empty words.
const char* text_of(const std::string& text) { return text.empty() ? nullptr : text.c_str(); }
}  // namespace

extern "C" {

gpiod_chip* gpiod_chip_open(const char* path) { return FakeLibgpiod::instance().open(path); }
void gpiod_chip_close(gpiod_chip* chip) { FakeLibgpiod::instance().close(chip); }
const char* gpiod_chip_label(gpiod_chip* chip) { return FakeLibgpiod::label(chip); }
unsigned int gpiod_chip_num_lines(gpiod_chip* chip) { return FakeLibgpiod::size(chip); }
const char* gpiod_line_name(gpiod_line* line) {
  return text_of(FakeLibgpiod::state_of(*line).name);
}
const char* gpiod_line_consumer(gpiod_line* line) {
  return text_of(FakeLibgpiod::state_of(*line).consumer);
}
bool gpiod_line_is_used(gpiod_line* line) { return FakeLibgpiod::state_of(*line).is_taken; }
gpiod_line* gpiod_chip_get_line(gpiod_chip* chip, unsigned int offset) {
  return FakeLibgpiod::line(chip, offset);
}
gpiod_line* gpiod_chip_find_line(gpiod_chip* chip, const char* name) {
  return FakeLibgpiod::find(chip, name);
}
unsigned int gpiod_line_offset(gpiod_line* line) { return static_cast<unsigned>(line->offset); }
int gpiod_line_request_output(gpiod_line* line, const char* consumer, int) {
  return FakeLibgpiod::instance().request(*line, consumer, FakeLibgpiod::As::Output, 0);
}
int gpiod_line_request_input_flags(gpiod_line* line, const char* consumer, int flags) {
  return FakeLibgpiod::instance().request(*line, consumer, FakeLibgpiod::As::Input, flags);
}
int gpiod_line_request_both_edges_events_flags(gpiod_line* line, const char* consumer, int flags) {
  return FakeLibgpiod::instance().request(*line, consumer, FakeLibgpiod::As::Edges, flags);
}
int gpiod_line_event_get_fd(gpiod_line* line) { return FakeLibgpiod::state_of(*line).pipe[0]; }
int gpiod_line_event_read_multiple(gpiod_line* line, gpiod_line_event* events,
                                   unsigned int num_events) {
  return FakeLibgpiod::instance().events(*line, events, num_events);
}
int gpiod_line_get_value(gpiod_line* line) { return FakeLibgpiod::instance().get(*line); }
int gpiod_line_set_value(gpiod_line* line, int value) {
  return FakeLibgpiod::instance().set(*line, value != 0);
}

}  // extern "C"
