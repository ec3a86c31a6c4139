#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/bus/hid_device.hpp"
#include "hal/plugin/arm_backend.hpp"

namespace thimble::sim {

// When something happened: in the model's time, and on the machine's clock (CLOCK_BOOTTIME,
// decision 0410), so that it can be compared with what others saw there.
struct LogTime {
  MonotonicTime model{};
  MonotonicTime machine{};
};

// What a model itself felt and was told, for as long back as there is room: the truth by which a
// test judges a driver.
//
// Thread: one. Not RT: it allocates when it is made and when it is read.
// Units: SI. Errors: none; longer packets than a report are cut.
class ModelLog {
 public:
  enum class Direction : std::uint8_t {
    ToModel,    // an output report, or a packet to an endpoint
    ToHost,     // an input report, or a packet from one
    Requested,  // what a request to the control pipe brought: a feature report
  };
  static constexpr std::size_t kEntries = 65536;  // ours: some 20 s of an arm at 1 kHz

  explicit ModelLog(std::size_t entries = kEntries) : entries_(entries) {}

  void note_sample(const LogTime& time, const plugin::ArmTruth& truth) noexcept;
  void note_bytes(const LogTime& time, Direction direction,
                  std::span<const std::uint8_t> bytes) noexcept;

  // What the motors did in short, by the samples since `from`, of the model's time. All 0 where
  // there is none.
  struct Felt {
    std::uint64_t frames{0};  // with a sample
    MonotonicTime first{};    // of the model; later than `from` where the log has forgotten
    Duration lasted{};        // from the first of them to the last
    double least_newton{0};
    double most_newton{0};
    Duration
        longest_below{};  // between two that are above `above_newton`, or an end and the next one
  };
  [[nodiscard]] Felt felt(MonotonicTime from, double above_newton) const noexcept;

  // A way through what was noted since `from`, of the model's time, until now; what is overwritten
  // meanwhile is left out.
  struct Cursor {
    std::uint64_t next{0};
    std::uint64_t end{0};
    std::uint64_t told{0};
  };
  [[nodiscard]] Cursor since(MonotonicTime from) const noexcept;
  // Up to `most` entries, one JSON object a line, oldest first; empty when there are no more:
  //   {"t_s":1.5,"machine_s":90.1,"tip_m":[x,y,z],"force_newton":[x,y,z],"current_a":[a,b,c],"amplifier_on":true}
  //   {"t_s":1.5,"machine_s":90.1,"out":"HEX"}     ("in", "request" for the other directions)
  // Base frame of the arm; force_newton is what the motors exert at the tip.
  [[nodiscard]] std::string lines(Cursor& cursor, std::size_t most) const;

 private:
  struct Entry {
    LogTime time{};
    bool is_sample{false};
    Direction direction{};
    std::size_t size{0};
    std::array<std::uint8_t, bus::kMaxHidReportBytes> bytes{};
    plugin::ArmTruth truth{};
  };
  [[nodiscard]] Entry& next() noexcept;
  [[nodiscard]] const Entry& at(std::uint64_t number) const noexcept;
  [[nodiscard]] std::uint64_t oldest() const noexcept;
  static void append_line(std::string& lines, const Entry& entry);

  std::vector<Entry> entries_;  // a ring
  std::uint64_t noted_{0};
};

}  // namespace thimble::sim
