#include "hal/linux/gpio_transfers.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

namespace thimble::linux {
namespace {

// Of its driver, which calls every such chip so.
constexpr const char* kWithoutEdges = "cp2112_gpio";

std::vector<std::string> nodes_of(const std::string& folder) {
  namespace fs = std::filesystem;
  std::vector<std::string> nodes;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    std::error_code ignored;
    // Raspberry Pi OS has a second name for a chip, which is no second chip.
    if (entry->is_symlink(ignored)) continue;
    if (entry->path().filename().string().starts_with("gpiochip")) {
      nodes.push_back(entry->path().string());
    }
  }
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

// Past nodes that it may not open, which say nothing of others.
Result<GpiodChip> find_chip(const std::string& folder, const std::string& label) {
  std::optional<GpiodChip> found;
  std::optional<Error> refusal;
  for (const std::string& node : nodes_of(folder)) {
    Result<GpiodChip> chip = GpiodChip::open(node);
    if (!chip) {
      if (chip.error().code == Errc::Permission) refusal = chip.error();
      continue;
    }
    if (chip->label() != label) continue;
    if (found) {
      return fail(Errc::InvalidArgument, label + ": there are two GPIO chips of this label");
    }
    found = *std::move(chip);
  }
  if (found) return *std::move(found);
  if (refusal) return tl::unexpected(refusal->in(label));
  return fail(Errc::NotFound, label + ": there is no GPIO chip of this label");
}

std::optional<std::size_t> place_in(const std::string& name) {
  std::size_t place = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), place);
  if (error != std::errc{} || end != name.data() + name.size()) return std::nullopt;
  return place;
}

Result<std::size_t> find_line(const GpiodChip& chip, const std::string& name) {
  std::optional<std::size_t> place = place_in(name);
  if (!place) place = chip.find(name);
  if (!place || *place >= chip.lines()) return fail(Errc::NotFound, "it has no line " + name);
  return *place;
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
      new GpioTransfers(claim.chip != kWithoutEdges, mail, clock));
  if (const Result<void> requested = transfers->request(*chip, claim); !requested) {
    return tl::unexpected(requested.error().in(claim.chip));
  }
  transfers->serve();
  return transfers;
}

GpioTransfers::~GpioTransfers() {
  for (GpiodLine& line : outputs_) {
    if (!mail_->is_disconnected()) static_cast<void>(line.set(false));
  }
}

Result<void> GpioTransfers::request(const GpiodChip& chip, const bus::GpioClaim& claim) {
  for (const std::string& name : claim.outputs) {
    const Result<std::size_t> place = find_line(chip, name);
    if (!place) return tl::unexpected(place.error());
    Result<GpiodLine> line = chip.request_output(*place, "line " + name);
    if (!line) return tl::unexpected(line.error());
    outputs_.push_back(*std::move(line));
  }
  for (const std::string& name : claim.inputs) {
    const Result<std::size_t> place = find_line(chip, name);
    if (!place) return tl::unexpected(place.error());
    Result<GpiodLine> line = chip.request_input(*place, "line " + name, {claim.pull, has_edges_});
    if (!line) return tl::unexpected(line.error());
    inputs_.push_back(*std::move(line));
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
  for (const GpiodLine& line : inputs_) {
    if (has_edges_) watched[count++] = {line.fd(), POLLIN, 0};
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
  pollfd watched{inputs_[input].fd(), POLLIN, 0};
  if (::poll(&watched, 1, 0) <= 0) return false;
  if ((watched.revents & POLLIN) == 0) {  // an error, or hung up: the line is gone
    mail_->disconnect();
    return false;
  }
  GpiodEdges edges;
  if (!inputs_[input].read_edges(edges)) {
    note(errno);
    return false;
  }
  const MonotonicTime now = clock_->now();
  for (std::size_t i = 0; i < edges.count; ++i) {
    const GpiodEdge& edge = edges.edges[i];
    if (edge.is_after_loss) mail_->count_lost_edge(input);
    mail_->deliver_edge(input, edge.is_high, now);
  }
  return edges.count == GpiodEdges::kMost;
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
    const std::optional<bool> level = inputs_[i].level();
    if (!level) note(errno);
    // Who says nothing for so long says nothing of the others either.
    if (mail_->is_disconnected() || clock_->now() - now > bus::kGpioReadPeriod) return;
    if (!level) continue;
    answered |= 1U << i;
    if (*level) levels.high |= 1U << i;
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

// Who does not take a level does not answer either.
bool GpioTransfers::write(GpiodLine& line, bool is_high) noexcept {
  return line.set(is_high) && line.level().has_value();
}

void GpioTransfers::note(int code) noexcept {
  if (code == ENODEV || code == ENXIO || code == EBADF) mail_->disconnect();
}

}  // namespace thimble::linux
