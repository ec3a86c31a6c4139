#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hal/base/io_status.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/wake_signal.hpp"

namespace thimble::bus {

inline constexpr std::size_t kMaxGpioLines = 8;  // inputs, and as many outputs; ours

// What the chip ties an input to where nothing else does.
enum class GpioPull : std::uint8_t { AsIs, Up, Down };

// Lines of one chip, taken together. A line is named as the chip names it, or by its place from 0
// ("3"); levels are those of the wire.
struct GpioClaim {
  std::string chip;                  // its label: "cp2112_gpio"
  std::vector<std::string> inputs;   // edges both ways are told; of a polled chip, of its levels
  std::vector<std::string> outputs;  // low from the opening to the first set()
  GpioPull pull{GpioPull::AsIs};     // of the inputs; a chip without such resistors ignores it
};

struct GpioEdge {
  std::uint8_t input{0};       // place in GpioClaim::inputs
  bool is_high{false};         // after it
  MonotonicTime arrived_at{};  // here, by the clock of the bus
  std::uint64_t sequence{0};   // of this input: 1, 2, 3…; one that is left out was lost
  bool operator==(const GpioEdge&) const = default;
};

// What the chip answered when it was last asked, which is every kGpioReadPeriod: of one input after
// the other, the first of the claim last, so that its level is the newest.
struct GpioLevels {
  std::uint32_t high{0};  // bit i: input i is high
  // When that reading began, by the clock of the bus: what is made of it, as the edges of a polled
  // chip, is younger.
  MonotonicTime read_at{};
  [[nodiscard]] bool is_high(std::size_t input) const noexcept {
    return ((high >> input) & 1U) != 0;
  }
  bool operator==(const GpioLevels&) const = default;
};

// Ours. A chip that was pulled out tells no edge of it (Linux 6.1), so it is asked; one behind USB
// takes a transfer for each line.
inline constexpr Duration kGpioReadPeriod = std::chrono::milliseconds(20);

// Lines of an opened chip. Edges and levels are two tellings of the same wires: a chip that is
// polled by its kernel driver shows a level before the edge, and tells of an input that is high
// when the driver first looks at it as if it rose then.
//
// Thread: one, which may wait; never a servo: a chip behind USB or I2C sleeps.
// Ownership: closing is the destructor's; outputs go low before.
// Errors: IoStatus::Disconnected when the chip or one line of it is gone; it latches.
class GpioLines {
 public:
  virtual ~GpioLines() = default;
  // The next edge in the order of arrival, or NoData, Disconnected; ProtocolError, once, where
  // edges were lost because nobody took them.
  virtual IoStatus next_edge(GpioEdge& out) noexcept = 0;
  // Ok, NoData before the chip has answered for the first time, Disconnected. There is no time-out:
  // a chip that hangs or refuses leaves the last answer, and Ok; who needs it fresh looks at
  // read_at.
  virtual IoStatus levels(GpioLevels& out) noexcept = 0;
  // The newest level wins. Ok; Backlogged when the ones before have not reached the chip, and none
  // has since the last call; Disconnected; ProtocolError for an output that was not claimed.
  virtual IoStatus set(std::size_t output, bool is_high) noexcept = 0;
};

// Opens the lines of the chips that there are.
// Thread: one. Not RT: it waits for the kernel.
class GpioChips {
 public:
  virtual ~GpioChips() = default;
  // `wake`, which may be nullptr and must outlive the lines, is signalled when an edge or another
  // level arrived. InvalidArgument for a claim that cannot be (none or too many lines, one twice,
  // or two chips of that label), NotFound for a chip or a line, Busy for a line that is taken,
  // Permission, System.
  [[nodiscard]] virtual Result<std::unique_ptr<GpioLines>> open(const GpioClaim& claim,
                                                                rt::WakeSignal* wake) = 0;
};

// What no chip could give: InvalidArgument.
[[nodiscard]] Result<void> check(const GpioClaim& claim);

}  // namespace thimble::bus
