#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/gpio_lines.hpp"

namespace thimble::sim {

class SimGpioLines;

// A chip with lines, its wires in the hands of a test. Outputs reach their wires at once; edges are
// told when a wire changes, levels are those of the moment they are asked for.
//
// Thread: that of the lines' user. Ownership: the clock must outlive it; it may go before its
// lines, which are Disconnected then. Errors: a line that does not exist ends the process: a test's
// own mistake.
class SimGpioChip {
 public:
  // Lines are called by their place, and by `names` where those are not empty.
  SimGpioChip(const Clock& clock, std::string label, std::size_t lines,
              std::vector<std::string> names = {});
  ~SimGpioChip();
  SimGpioChip(const SimGpioChip&) = delete;
  SimGpioChip& operator=(const SimGpioChip&) = delete;

  // The wire of `line`, by place.
  void set_level(std::size_t line, bool is_high);
  [[nodiscard]] bool level(std::size_t line) const;
  // How often the wire changed, whoever did it.
  [[nodiscard]] std::uint64_t changes(std::size_t line) const;

  // Faults, each until the opposite is said. A chip that is gone comes back with its outputs low.
  void lose();
  void restore();
  // The request of a line that is open ends, as when its kernel driver is taken away.
  void lose_line(std::size_t line);
  // The next edges of any line are not told; their numbers are used up.
  void lose_edges(int edges) { edges_to_lose_ += edges; }
  // The wire stays as it is for whoever reads it.
  void stick(std::size_t line, bool is_stuck);
  // A contact that closes or opens as contacts do: `times` there and back before it stays.
  void bounce(std::size_t line, bool is_high, int times);
  // The chip answers nothing: levels get old, outputs are not taken.
  void hang(bool is_hanging) { is_hanging_ = is_hanging; }

  [[nodiscard]] const std::string& label() const noexcept { return label_; }
  // As bus::GpioChips; NotFound while it is gone.
  [[nodiscard]] Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                                             rt::WakeSignal* wake);

 private:
  friend class SimGpioLines;
  struct Wire {
    std::string name;
    bool is_high{false};       // really
    bool is_told_high{false};  // as whoever reads it sees it
    bool is_stuck{false};
    bool is_taken{false};
    std::uint64_t changes{0};
  };

  [[nodiscard]] Wire& wire(std::size_t line);
  [[nodiscard]] Result<std::vector<std::size_t>> find(const std::vector<std::string>& names) const;
  void tell(std::size_t line);
  void end(SimGpioLines& lines);

  const Clock* clock_;
  std::string label_;
  std::vector<Wire> wires_;
  std::vector<SimGpioLines*> open_;
  int edges_to_lose_{0};
  bool is_hanging_{false};
  bool is_gone_{false};
};

// The chips that a simulation has.
// Ownership: the chips must outlive it.
class SimGpioChips final : public bus::GpioChips {
 public:
  explicit SimGpioChips(std::vector<SimGpioChip*> chips) : chips_(std::move(chips)) {}
  [[nodiscard]] Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                                             rt::WakeSignal* wake) override;

 private:
  std::vector<SimGpioChip*> chips_;
};

}  // namespace thimble::sim
