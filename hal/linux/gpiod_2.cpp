// libgpiod 2.
#include <gpiod.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "hal/linux/gpiod_chip.hpp"
#include "hal/linux/system_error.hpp"

namespace thimble::linux {
namespace {

constexpr const char* kConsumer = "thimbled";  // shown by gpioinfo

template <auto Release>
struct Free {
  template <class What>
  void operator()(What* what) const noexcept {
    Release(what);
  }
};
template <class What, auto Release>
using Owned = std::unique_ptr<What, Free<Release>>;

using Chip = Owned<gpiod_chip, &gpiod_chip_close>;
using ChipInfo = Owned<gpiod_chip_info, &gpiod_chip_info_free>;
using LineInfo = Owned<gpiod_line_info, &gpiod_line_info_free>;
using LineSettings = Owned<gpiod_line_settings, &gpiod_line_settings_free>;
using LineConfig = Owned<gpiod_line_config, &gpiod_line_config_free>;
using RequestConfig = Owned<gpiod_request_config, &gpiod_request_config_free>;
using Request = Owned<gpiod_line_request, &gpiod_line_request_release>;
using EdgeBuffer = Owned<gpiod_edge_event_buffer, &gpiod_edge_event_buffer_free>;

gpiod_line_bias bias_of(bus::GpioPull pull) noexcept {
  switch (pull) {
    case bus::GpioPull::AsIs:
      return GPIOD_LINE_BIAS_AS_IS;
    case bus::GpioPull::Up:
      return GPIOD_LINE_BIAS_PULL_UP;
    case bus::GpioPull::Down:
      return GPIOD_LINE_BIAS_PULL_DOWN;
  }
  return GPIOD_LINE_BIAS_AS_IS;
}

std::string text_of(const char* text) { return text == nullptr ? "" : text; }

// nullptr where it is refused: errno.
Request request(gpiod_chip* chip, unsigned offset, gpiod_line_settings* settings) {
  const LineConfig lines(gpiod_line_config_new());
  const RequestConfig config(gpiod_request_config_new());
  if (lines == nullptr || config == nullptr) return nullptr;
  gpiod_request_config_set_consumer(config.get(), kConsumer);
  if (gpiod_line_config_add_line_settings(lines.get(), &offset, 1, settings) != 0) return nullptr;
  return Request(gpiod_chip_request_lines(chip, config.get(), lines.get()));
}

}  // namespace

struct GpiodLine::State {
  Request request;
  unsigned offset;
  EdgeBuffer buffer;      // of an input with edges
  unsigned long last{0};  // number of the edge before; the kernel begins with 1
};
struct GpiodChip::State {
  Chip chip;
  std::string node;
  std::string label;
  std::size_t lines;
};

GpiodLine::GpiodLine(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
GpiodLine::~GpiodLine() = default;
GpiodLine::GpiodLine(GpiodLine&&) noexcept = default;
GpiodLine& GpiodLine::operator=(GpiodLine&&) noexcept = default;

int GpiodLine::fd() const noexcept { return gpiod_line_request_get_fd(state_->request.get()); }

std::optional<bool> GpiodLine::level() noexcept {
  const gpiod_line_value value =
      gpiod_line_request_get_value(state_->request.get(), state_->offset);
  if (value == GPIOD_LINE_VALUE_ERROR) return std::nullopt;
  return value == GPIOD_LINE_VALUE_ACTIVE;
}

bool GpiodLine::set(bool is_high) noexcept {
  const gpiod_line_value value = is_high ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  return gpiod_line_request_set_value(state_->request.get(), state_->offset, value) == 0;
}

bool GpiodLine::read_edges(GpiodEdges& out) noexcept {
  const int count = gpiod_line_request_read_edge_events(state_->request.get(), state_->buffer.get(),
                                                        GpiodEdges::kMost);
  if (count < 0) return false;
  out.count = std::min(static_cast<std::size_t>(count), GpiodEdges::kMost);
  for (std::size_t i = 0; i < out.count; ++i) {
    gpiod_edge_event* const event = gpiod_edge_event_buffer_get_event(state_->buffer.get(), i);
    const unsigned long number = gpiod_edge_event_get_line_seqno(event);
    const bool is_high = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE;
    // The kernel has 32 bits of it.
    const auto steps = static_cast<std::uint32_t>(number - state_->last);
    out.edges.at(i) = {is_high, steps != 1};
    state_->last = number;
  }
  return true;
}

GpiodChip::GpiodChip(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
GpiodChip::~GpiodChip() = default;
GpiodChip::GpiodChip(GpiodChip&&) noexcept = default;
GpiodChip& GpiodChip::operator=(GpiodChip&&) noexcept = default;

Result<GpiodChip> GpiodChip::open(const std::string& node) {
  Chip chip(gpiod_chip_open(node.c_str()));
  if (chip == nullptr) return tl::unexpected(system_error(node, errno));
  const ChipInfo info(gpiod_chip_get_info(chip.get()));
  if (info == nullptr) return tl::unexpected(system_error(node, errno));
  std::string label = text_of(gpiod_chip_info_get_label(info.get()));
  const std::size_t lines = gpiod_chip_info_get_num_lines(info.get());
  return GpiodChip(std::make_unique<State>(State{std::move(chip), node, std::move(label), lines}));
}

const std::string& GpiodChip::label() const noexcept { return state_->label; }

std::size_t GpiodChip::lines() const noexcept { return state_->lines; }

Result<GpioLineInfo> GpiodChip::line_info(std::size_t line) const {
  const LineInfo info(gpiod_chip_get_line_info(state_->chip.get(), static_cast<unsigned>(line)));
  if (info == nullptr) return tl::unexpected(system_error(state_->node, errno));
  return GpioLineInfo{text_of(gpiod_line_info_get_name(info.get())),
                      gpiod_line_info_is_used(info.get()),
                      text_of(gpiod_line_info_get_consumer(info.get()))};
}

std::optional<std::size_t> GpiodChip::find(const std::string& name) const {
  const int offset = gpiod_chip_get_line_offset_from_name(state_->chip.get(), name.c_str());
  if (offset < 0) return std::nullopt;
  return static_cast<std::size_t>(offset);
}

Result<GpiodLine> GpiodChip::request_output(std::size_t line, const std::string& name) const {
  const LineSettings settings(gpiod_line_settings_new());
  if (settings == nullptr) return tl::unexpected(system_error(name, errno));
  gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT);
  gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE);
  const auto offset = static_cast<unsigned>(line);
  Request taken = request(state_->chip.get(), offset, settings.get());
  if (taken == nullptr) return tl::unexpected(system_error(name, errno));
  return GpiodLine(
      std::make_unique<GpiodLine::State>(GpiodLine::State{std::move(taken), offset, nullptr}));
}

Result<GpiodLine> GpiodChip::request_input(std::size_t line, const std::string& name,
                                           const GpiodInput& input) const {
  const LineSettings settings(gpiod_line_settings_new());
  EdgeBuffer buffer(gpiod_edge_event_buffer_new(GpiodEdges::kMost));
  if (settings == nullptr || buffer == nullptr) {
    return tl::unexpected(system_error(name, errno));
  }
  gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
  gpiod_line_settings_set_bias(settings.get(), bias_of(input.pull));
  if (input.has_edges) {
    gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
  }
  const auto offset = static_cast<unsigned>(line);
  Request taken = request(state_->chip.get(), offset, settings.get());
  if (taken == nullptr) return tl::unexpected(system_error(name, errno));
  return GpiodLine(std::make_unique<GpiodLine::State>(
      GpiodLine::State{std::move(taken), offset, std::move(buffer)}));
}

}  // namespace thimble::linux
