#include "hal/linux/gpio_transfers.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "hal/linux/gpiod_chip.hpp"
#include "hal/linux/system_error.hpp"

namespace thimble::linux {
namespace {

constexpr const char* kConsumer = "thimbled";  // shown by gpioinfo
// Of one line, as many as Linux 6.1 keeps (gpiolib-cdev.c, lineevent_state): it drops what comes
// then, and tells nobody.
constexpr int kEventsAtOnce = 16;

// Of its driver, which calls every such chip so.
constexpr const char* kWithoutEdges = "cp2112_gpio";

int pull_flags(bus::GpioPull pull) noexcept {
  switch (pull) {
    case bus::GpioPull::AsIs:
      return 0;
    case bus::GpioPull::Up:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case bus::GpioPull::Down:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
  }
  return 0;
}

std::vector<std::string> nodes_of(const std::string& folder) {
  std::vector<std::string> nodes;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.path().filename().string().starts_with("gpiochip")) {
      nodes.push_back(entry.path().string());
    }
  }
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

// gpiod_chip_open_by_label() gives up at the first node that it may not open, and takes the first
// of two with that label.
Result<GpiodChip> find_chip(const std::string& folder, const std::string& label) {
  GpiodChip found;
  std::optional<Error> refusal;
  for (const std::string& node : nodes_of(folder)) {
    GpiodChip chip(gpiod_chip_open(node.c_str()));
    if (chip == nullptr) {
      if (errno == EACCES || errno == EPERM) refusal = system_error(node, errno);
      continue;
    }
    if (gpiod_chip_label(chip.get()) != label) continue;
    if (found != nullptr) {
      return fail(Errc::InvalidArgument, label + ": there are two GPIO chips of this label");
    }
    found = std::move(chip);
  }
  if (found != nullptr) return found;
  if (refusal) return tl::unexpected(refusal->in(label));
  return fail(Errc::NotFound, label + ": there is no GPIO chip of this label");
}

std::optional<unsigned> offset_in(const std::string& name) {
  unsigned offset = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), offset);
  if (error != std::errc{} || end != name.data() + name.size()) return std::nullopt;
  return offset;
}

}  // namespace

Result<std::unique_ptr<GpioTransfers>> GpioTransfers::open(const std::string& folder,
                                                           const bus::GpioClaim& claim,
                                                           bus::GpioMailboxes& mail,
                                                           const Clock& clock) {
  if (const Result<void> good = check(claim); !good) return tl::unexpected(good.error());
  Result<GpiodChip> chip = find_chip(folder, claim.chip);
  if (!chip) return tl::unexpected(chip.error());
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<GpioTransfers> transfers(
      new GpioTransfers(chip->release(), claim.chip != kWithoutEdges, mail, clock));
  if (const Result<void> requested = transfers->request(claim); !requested) {
    return tl::unexpected(requested.error().in(claim.chip));
  }
  transfers->serve();
  return transfers;
}

GpioTransfers::~GpioTransfers() {
  for (gpiod_line* line : outputs_) {
    if (!mail_->is_disconnected()) gpiod_line_set_value(line, 0);
  }
  gpiod_chip_close(chip_);  // which releases the lines
}

Result<gpiod_line*> GpioTransfers::find(const std::string& name) {
  const std::optional<unsigned> offset = offset_in(name);
  gpiod_line* const line =
      offset ? gpiod_chip_get_line(chip_, *offset) : gpiod_chip_find_line(chip_, name.c_str());
  if (line == nullptr) return fail(Errc::NotFound, "it has no line " + name);
  return line;
}

Result<void> GpioTransfers::request(const bus::GpioClaim& claim) {
  for (const std::string& name : claim.outputs) {
    const Result<gpiod_line*> line = find(name);
    if (!line) return tl::unexpected(line.error());
    if (gpiod_line_request_output(*line, kConsumer, 0) != 0) {
      return tl::unexpected(system_error("line " + name, errno));
    }
    outputs_.push_back(*line);
  }
  for (const std::string& name : claim.inputs) {
    const Result<gpiod_line*> line = find(name);
    if (!line) return tl::unexpected(line.error());
    const int flags = pull_flags(claim.pull);
    const int refused = has_edges_
                            ? gpiod_line_request_both_edges_events_flags(*line, kConsumer, flags)
                            : gpiod_line_request_input_flags(*line, kConsumer, flags);
    if (refused != 0) {
      return tl::unexpected(system_error("line " + name, errno));
    }
    inputs_.push_back(*line);
  }
  return {};
}

void GpioTransfers::wait(int wake) noexcept {
  std::array<pollfd, bus::kMaxGpioLines + 1> watched{};
  std::size_t count = 0;
  watched[count++] = {wake, POLLIN, 0};
  // What is to be written waits for no edges.
  if (const Duration pause = pause_.after_wake(clock_->now()); pause > Duration(0)) {
    const timespec most{0, pause.count()};
    ::ppoll(watched.data(), count, &most, nullptr);
    return;
  }
  for (gpiod_line* line : inputs_) {
    if (has_edges_) watched[count++] = {gpiod_line_event_get_fd(line), POLLIN, 0};
  }
  const Duration rest = std::max(next_read_ - clock_->now(), Duration(0));
  const auto rest_ms = std::chrono::ceil<std::chrono::milliseconds>(rest).count();
  ::poll(watched.data(), count, static_cast<int>(rest_ms));
}

void GpioTransfers::serve() noexcept {
  if (mail_->is_disconnected()) return;
  if (has_edges_) take_edges();
  if (clock_->now() >= next_read_) read_levels();
  write_outputs();
}

void GpioTransfers::take_edges() noexcept {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    // Bounded: a line that chatters must not keep the others from being served.
    for (int burst = 0; burst < 4 && take_edges_of(i); ++burst) {
    }
  }
}

// False when no more wait.
bool GpioTransfers::take_edges_of(std::size_t input) noexcept {
  pollfd watched{gpiod_line_event_get_fd(inputs_[input]), POLLIN, 0};
  if (::poll(&watched, 1, 0) <= 0) return false;
  if ((watched.revents & POLLIN) == 0) {  // an error, or hung up: the line is gone
    mail_->disconnect();
    return false;
  }
  std::array<gpiod_line_event, kEventsAtOnce> events{};
  const int count = gpiod_line_event_read_multiple(inputs_[input], events.data(), kEventsAtOnce);
  if (count < 0) {
    note(errno);
    return false;
  }
  const MonotonicTime now = clock_->now();
  // The queue was full, and more may have come. Told before them, not with the next edge: that one
  // may never come.
  const bool was_full = count >= kEventsAtOnce;
  if (was_full) mail_->count_lost_edge(input);
  for (int i = 0; i < std::min(count, kEventsAtOnce); ++i) {
    const int type = events.at(static_cast<std::size_t>(i)).event_type;
    mail_->deliver_edge(input, type == GPIOD_LINE_EVENT_RISING_EDGE, now);
  }
  return was_full;
}

// A chip that does not answer leaves the old levels to grow old.
void GpioTransfers::read_levels() noexcept {
  const MonotonicTime now = clock_->now();
  next_read_ = now + bus::kGpioReadPeriod;
  bus::GpioLevels levels{0, now};
  std::uint32_t answered = 0;
  // Behind USB each takes a transfer. A stop's channels are first in a claim: what opens while
  // others are asked is seen now, not a period later.
  for (std::size_t i = inputs_.size(); i-- > 0;) {
    const int value = gpiod_line_get_value(inputs_[i]);
    if (value < 0) note(errno);
    // Who says nothing for so long says nothing of the others either.
    if (mail_->is_disconnected() || clock_->now() - now > bus::kGpioReadPeriod) return;
    if (value < 0) continue;
    answered |= 1U << i;
    if (value > 0) levels.high |= 1U << i;
  }
  if (!has_edges_) make_edges(levels.high, answered, clock_->now());
  const bool is_whole = answered == (1U << inputs_.size()) - 1;
  if (is_whole) mail_->deliver_levels(levels);
}

void GpioTransfers::make_edges(std::uint32_t high, std::uint32_t answered,
                               MonotonicTime at) noexcept {
  const std::uint32_t changed = (high ^ read_) & answered & known_;
  read_ = (read_ & ~answered) | high;
  known_ |= answered;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const std::uint32_t bit = 1U << i;
    if ((changed & bit) != 0) mail_->deliver_edge(i, (high & bit) != 0, at);
  }
}

void GpioTransfers::write_outputs() noexcept {
  const std::optional<bus::GpioWish> wish = mail_->wanted();
  if (!wish) return;
  int code = 0;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const std::uint32_t bit = 1U << i;
    const bool is_high = (wish->high & bit) != 0;
    if ((((wish->high ^ written_) | unsure_) & bit) == 0) continue;
    unsure_ |= bit;
    if (!write(outputs_[i], is_high)) {
      code = errno;
      continue;  // a refused one must not keep the others waiting
    }
    unsure_ &= ~bit;
    written_ = is_high ? written_ | bit : written_ & ~bit;
  }
  if (code != 0) return note(code);
  mail_->written(*wish);
}

// That the chip refused a level nobody is told (Linux 6.1: a driver's set() returns nothing), so it
// is asked something, too, which who refuses refuses as well.
bool GpioTransfers::write(gpiod_line* line, bool is_high) noexcept {
  return gpiod_line_set_value(line, is_high ? 1 : 0) == 0 && gpiod_line_get_value(line) >= 0;
}

void GpioTransfers::note(int code) noexcept {
  if (code == ENODEV || code == ENXIO || code == EBADF) mail_->disconnect();
}

}  // namespace thimble::linux
