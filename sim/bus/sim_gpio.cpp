#include "sim/bus/sim_gpio.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "hal/base/check.hpp"
#include "hal/bus/gpio_mailboxes.hpp"

namespace thimble::sim {

// The user's end. Edges go through the mailboxes of every bus; levels and outputs are the wires'.
class SimGpioLines final : public bus::GpioMailboxes {
 public:
  SimGpioLines(SimGpioChip& chip, std::vector<std::size_t> inputs, std::vector<std::size_t> outputs,
               rt::WakeSignal* wake)
      : GpioMailboxes(inputs.size(), outputs.size(), wake),
        chip_(&chip),
        input_lines_(std::move(inputs)),
        output_lines_(std::move(outputs)) {
    for (const std::size_t line : input_lines_) chip.wire(line).is_taken = true;
    for (const std::size_t line : output_lines_) chip.wire(line).is_taken = true;
    set_low();
    refresh();
  }
  ~SimGpioLines() override {
    if (chip_ == nullptr) return;
    if (!chip_->is_hanging_) set_low();
    chip_->end(*this);
  }
  SimGpioLines(const SimGpioLines&) = delete;
  SimGpioLines& operator=(const SimGpioLines&) = delete;

  IoStatus levels(bus::GpioLevels& out) noexcept override {
    if (chip_ != nullptr && !chip_->is_hanging_) refresh();
    return GpioMailboxes::levels(out);
  }
  IoStatus set(std::size_t output, bool is_high) noexcept override {
    const IoStatus status = GpioMailboxes::set(output, is_high);
    if (chip_ != nullptr) write();
    return status;
  }

  void write() noexcept {
    if (chip_->is_hanging_) return;
    if (const std::optional<bus::GpioWish> wish = wanted()) applied_ = *wish;
    for (std::size_t i = 0; i < output_lines_.size(); ++i) {
      chip_->set_level(output_lines_[i], ((applied_.high >> i) & 1U) != 0);
    }
    written(applied_);
  }
  // What the chip says now.
  void refresh() noexcept {
    bus::GpioLevels now{0, chip_->clock_->now()};
    for (std::size_t i = 0; i < input_lines_.size(); ++i) {
      if (chip_->wire(input_lines_[i]).is_told_high) now.high |= 1U << i;
    }
    deliver_levels(now);
  }
  void tell(std::size_t line, bool is_high, bool is_lost) noexcept {
    const auto found = std::find(input_lines_.begin(), input_lines_.end(), line);
    if (found == input_lines_.end()) return;
    const auto input = static_cast<std::size_t>(found - input_lines_.begin());
    if (!is_lost) deliver_edge(input, is_high, chip_->clock_->now());
  }
  [[nodiscard]] bool has(std::size_t line) const {
    const auto in = [line](const std::vector<std::size_t>& lines) {
      return std::find(lines.begin(), lines.end(), line) != lines.end();
    };
    return in(input_lines_) || in(output_lines_);
  }
  void set_low() noexcept {
    for (const std::size_t line : output_lines_) chip_->set_level(line, false);
  }
  void drop() noexcept {
    for (const std::size_t line : input_lines_) chip_->wire(line).is_taken = false;
    for (const std::size_t line : output_lines_) chip_->wire(line).is_taken = false;
    chip_ = nullptr;
    disconnect();
  }

 private:
  SimGpioChip* chip_;  // nullptr: gone
  std::vector<std::size_t> input_lines_;
  std::vector<std::size_t> output_lines_;
  bus::GpioWish applied_;
};

SimGpioChip::SimGpioChip(const Clock& clock, std::string label, std::size_t lines,
                         std::vector<std::string> names)
    : clock_(&clock), label_(std::move(label)), wires_(lines) {
  for (std::size_t i = 0; i < std::min(lines, names.size()); ++i) {
    wires_[i].name = std::move(names[i]);
  }
}

SimGpioChip::~SimGpioChip() { lose(); }

SimGpioChip::Wire& SimGpioChip::wire(std::size_t line) {
  THIMBLE_CHECK(line < wires_.size());
  return wires_[line];
}

void SimGpioChip::set_level(std::size_t line, bool is_high) {
  Wire& changed = wire(line);
  if (std::exchange(changed.is_high, is_high) == is_high) return;
  ++changed.changes;
  tell(line);
}

bool SimGpioChip::level(std::size_t line) const { return wires_.at(line).is_high; }

std::uint64_t SimGpioChip::changes(std::size_t line) const { return wires_.at(line).changes; }

void SimGpioChip::tell(std::size_t line) {
  Wire& changed = wire(line);
  if (changed.is_stuck || changed.is_told_high == changed.is_high) return;
  changed.is_told_high = changed.is_high;
  const bool is_lost = edges_to_lose_ > 0 && changed.is_taken;
  if (is_lost) --edges_to_lose_;
  for (SimGpioLines* lines : open_) lines->tell(line, changed.is_high, is_lost);
}

void SimGpioChip::lose() {
  for (SimGpioLines* lines : open_) lines->set_low();  // its power is gone
  is_gone_ = true;
  while (!open_.empty()) end(*open_.back());
}

void SimGpioChip::restore() { is_gone_ = false; }

void SimGpioChip::lose_line(std::size_t line) {
  const auto found = std::find_if(open_.begin(), open_.end(),
                                  [line](const auto* lines) { return lines->has(line); });
  if (found != open_.end()) end(**found);
}

void SimGpioChip::stick(std::size_t line, bool is_stuck) {
  wire(line).is_stuck = is_stuck;
  tell(line);
}

void SimGpioChip::bounce(std::size_t line, bool is_high, int times) {
  for (int i = 0; i < times; ++i) {
    set_level(line, is_high);
    set_level(line, !is_high);
  }
  set_level(line, is_high);
}

void SimGpioChip::end(SimGpioLines& lines) {
  std::erase(open_, &lines);
  lines.drop();
}

Result<std::vector<std::size_t>> SimGpioChip::find(const std::vector<std::string>& names) const {
  std::vector<std::size_t> found;
  for (const std::string& name : names) {
    std::size_t line = 0;
    while (line < wires_.size() && wires_[line].name != name && std::to_string(line) != name) {
      ++line;
    }
    if (line == wires_.size()) return fail(Errc::NotFound, label_ + ": it has no line " + name);
    if (wires_[line].is_taken) return fail(Errc::Busy, label_ + ": line " + name + " is taken");
    found.push_back(line);
  }
  return found;
}

Result<std::unique_ptr<bus::GpioLines>> SimGpioChip::open(const bus::GpioClaim& claim,
                                                          rt::WakeSignal* wake) {
  if (is_gone_) return fail(Errc::NotFound, label_ + ": there is no GPIO chip of this label");
  const Result<std::vector<std::size_t>> inputs = find(claim.inputs);
  if (!inputs) return tl::unexpected(inputs.error());
  const Result<std::vector<std::size_t>> outputs = find(claim.outputs);
  if (!outputs) return tl::unexpected(outputs.error());
  auto lines = std::make_unique<SimGpioLines>(*this, *inputs, *outputs, wake);
  open_.push_back(lines.get());
  return lines;
}

Result<std::unique_ptr<bus::GpioLines>> SimGpioChips::open(const bus::GpioClaim& claim,
                                                           rt::WakeSignal* wake) {
  if (const Result<void> good = check(claim); !good) return tl::unexpected(good.error());
  for (SimGpioChip* chip : chips_) {
    if (chip->label() == claim.chip) return chip->open(claim, wake);
  }
  return fail(Errc::NotFound, claim.chip + ": there is no GPIO chip of this label");
}

}  // namespace thimble::sim
