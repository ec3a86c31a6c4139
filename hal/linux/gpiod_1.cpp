// libgpiod 1.6.
#include <gpiod.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "hal/linux/gpiod_chip.hpp"
#include "hal/linux/system_error.hpp"

namespace thimble::linux {
namespace {

constexpr const char* kConsumer = "thimbled";  // shown by gpioinfo

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

std::string text_of(const char* text) { return text == nullptr ? "" : text; }

}  // namespace

// Closing a chip releases its lines, so each line keeps it open.
struct GpiodLine::State {
  std::shared_ptr<gpiod_chip> chip;
  gpiod_line* line;
};
struct GpiodChip::State {
  std::shared_ptr<gpiod_chip> chip;
  std::string node;
  std::string label;

  [[nodiscard]] Result<gpiod_line*> line(std::size_t place, const std::string& name) const {
    gpiod_line* const line = gpiod_chip_get_line(chip.get(), static_cast<unsigned>(place));
    if (line == nullptr) return tl::unexpected(system_error(name, errno));
    return line;
  }
};

GpiodLine::GpiodLine(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
GpiodLine::~GpiodLine() = default;
GpiodLine::GpiodLine(GpiodLine&&) noexcept = default;
GpiodLine& GpiodLine::operator=(GpiodLine&&) noexcept = default;

int GpiodLine::fd() const noexcept { return gpiod_line_event_get_fd(state_->line); }

std::optional<bool> GpiodLine::level() noexcept {
  const int value = gpiod_line_get_value(state_->line);
  if (value < 0) return std::nullopt;
  return value > 0;
}

bool GpiodLine::set(bool is_high) noexcept {
  return gpiod_line_set_value(state_->line, is_high ? 1 : 0) == 0;
}

bool GpiodLine::read_edges(GpiodEdges& out) noexcept {
  std::array<gpiod_line_event, GpiodEdges::kMost> events{};
  const int count = gpiod_line_event_read_multiple(state_->line, events.data(), GpiodEdges::kMost);
  if (count < 0) return false;
  out.count = std::min(static_cast<std::size_t>(count), GpiodEdges::kMost);
  for (std::size_t i = 0; i < out.count; ++i) {
    out.edges.at(i) = {events.at(i).event_type == GPIOD_LINE_EVENT_RISING_EDGE, false};
  }
  // Told before them, not with the next edge: that one may never come.
  if (out.count == GpiodEdges::kMost) out.edges.front().is_after_loss = true;
  return true;
}

GpiodChip::GpiodChip(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
GpiodChip::~GpiodChip() = default;
GpiodChip::GpiodChip(GpiodChip&&) noexcept = default;
GpiodChip& GpiodChip::operator=(GpiodChip&&) noexcept = default;

Result<GpiodChip> GpiodChip::open(const std::string& node) {
  gpiod_chip* const chip = gpiod_chip_open(node.c_str());
  if (chip == nullptr) return tl::unexpected(system_error(node, errno));
  std::shared_ptr<gpiod_chip> owned(chip, [](gpiod_chip* open) { gpiod_chip_close(open); });
  std::string label = text_of(gpiod_chip_label(chip));
  return GpiodChip(std::make_unique<State>(State{std::move(owned), node, std::move(label)}));
}

const std::string& GpiodChip::label() const noexcept { return state_->label; }

std::size_t GpiodChip::lines() const noexcept { return gpiod_chip_num_lines(state_->chip.get()); }

Result<GpioLineInfo> GpiodChip::line_info(std::size_t line) const {
  const Result<gpiod_line*> found = state_->line(line, state_->node);
  if (!found) return tl::unexpected(found.error());
  return GpioLineInfo{text_of(gpiod_line_name(*found)), gpiod_line_is_used(*found),
                      text_of(gpiod_line_consumer(*found))};
}

std::optional<std::size_t> GpiodChip::find(const std::string& name) const {
  gpiod_line* const line = gpiod_chip_find_line(state_->chip.get(), name.c_str());
  if (line == nullptr) return std::nullopt;
  return gpiod_line_offset(line);
}

Result<GpiodLine> GpiodChip::request_output(std::size_t line, const std::string& name) const {
  const Result<gpiod_line*> found = state_->line(line, name);
  if (!found) return tl::unexpected(found.error());
  if (gpiod_line_request_output(*found, kConsumer, 0) != 0) {
    return tl::unexpected(system_error(name, errno));
  }
  return GpiodLine(std::make_unique<GpiodLine::State>(GpiodLine::State{state_->chip, *found}));
}

Result<GpiodLine> GpiodChip::request_input(std::size_t line, const std::string& name,
                                           const GpiodInput& input) const {
  const Result<gpiod_line*> found = state_->line(line, name);
  if (!found) return tl::unexpected(found.error());
  const int flags = pull_flags(input.pull);
  const int refused = input.has_edges
                          ? gpiod_line_request_both_edges_events_flags(*found, kConsumer, flags)
                          : gpiod_line_request_input_flags(*found, kConsumer, flags);
  if (refused != 0) return tl::unexpected(system_error(name, errno));
  return GpiodLine(std::make_unique<GpiodLine::State>(GpiodLine::State{state_->chip, *found}));
}

}  // namespace thimble::linux
