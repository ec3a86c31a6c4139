#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/falcon/boot_stream.hpp"
#include "sim/model/falcon/falcon_firmware.hpp"
#include "sim/model/falcon/serial_line.hpp"

namespace thimble::sim {

// The boot-loader's faults, by backend.
struct FalconBootFaults {
  std::optional<std::size_t> lost_echo;  // this byte of the next image, from 0, is not echoed
  std::uint64_t deaf_questions{0};       // so many questions are not answered
};

struct FalconProcessorCounters {
  std::uint64_t garbage_bytes{0};  // came in at another speed: dropped
  std::uint64_t ignored_bytes{0};  // nobody listens in that state
  std::uint64_t questions{0};      // the monitor's, answered or not
  std::uint64_t uploads{0};        // begun
  std::uint64_t starts{0};         // of a complete image
  std::uint64_t resets{0};
  bool operator==(const FalconProcessorCounters&) const = default;
};

// The signal processor of a Falcon, TMS320 2811: what is in its ROM, and the firmware that it was
// sent. It answers in the one order that is known to work (arms.md 1.4):
//
//   Deaf --DTR rises--> Monitor --0A 43 0D at 9600, RTS low--> answers 0A 44 2C 0D
//   Monitor, answered --DTR falls--> BootRom --41 at 142 857--> echoes it, Loading
//   Loading: echoes every byte --stream complete--> Starting --10 ms--> Running at 1.5 Mbaud
//
// Ours, where the sheet knows nothing: rising DTR resets it in every state, and what was loaded is
// lost; from a reset it takes 20 ms to listen; DTR that falls unanswered leaves it deaf; a stream
// with another key stops it, without an echo, until the next reset. The latency timer of the
// chip before it is no condition: what failed with less than 16 ms was one read for four bytes.
//
// Thread: one. RT: all. Errors: none: any bytes are taken.
class FalconProcessor {
 public:
  enum class State : std::uint8_t { Deaf, Monitor, BootRom, Loading, Stuck, Starting, Running };
  static constexpr Duration kListensAfter{20'000'000};
  static constexpr Duration kRunsAfter{10'000'000};

  // RAM and state are lost.
  THIMBLE_RT void power_up() noexcept;
  // As if that had been uploaded: for tests of what comes after it.
  THIMBLE_RT void start_firmware() noexcept;
  THIMBLE_RT void set_lines(MonotonicTime t, bool is_dtr_high, bool is_rts_high) noexcept;
  // A byte has arrived at `t`; `now` is where the cranks are.
  THIMBLE_RT void receive(MonotonicTime t, SerialByte byte, const CrankCounts& now) noexcept;
  [[nodiscard]] MonotonicTime next_arrival() const noexcept { return sender_.next_arrival(); }
  // At most so many bytes will arrive at the bridge of what is under way, and of its answers to
  // `heard` more bytes.
  [[nodiscard]] std::size_t most_to_arrive(std::size_t heard) const noexcept;
  THIMBLE_RT SerialByte take_arrived() noexcept { return sender_.take_arrived(); }

  // What the motors are told now; zero but in Running.
  [[nodiscard]] std::array<int, 3> motor_counts() const noexcept;
  [[nodiscard]] FalconFirmware& firmware() noexcept { return firmware_; }
  [[nodiscard]] const FalconFirmware& firmware() const noexcept { return firmware_; }
  [[nodiscard]] State state() const noexcept { return state_; }
  void set_faults(const FalconBootFaults& faults) noexcept { faults_ = faults; }
  // Those that are still to come.
  [[nodiscard]] const FalconBootFaults& faults() const noexcept { return faults_; }
  [[nodiscard]] const FalconProcessorCounters& counters() const noexcept { return counters_; }

 private:
  [[nodiscard]] double listens_at_baud() const noexcept;
  void reset(MonotonicTime t) noexcept;
  void hear_question(MonotonicTime t, std::uint8_t byte) noexcept;
  void load(MonotonicTime t, std::uint8_t byte) noexcept;
  void begin_to_run(const CrankCounts& now) noexcept;

  State state_{State::Deaf};
  bool is_dtr_high_{false};
  bool is_rts_high_{false};
  bool has_answered_{false};
  std::size_t question_bytes_{0};  // of the question that were heard in a row
  MonotonicTime ready_at_{};       // of Monitor and Starting
  SerialSender<256> sender_;
  BootStream stream_;
  FalconFirmware firmware_;
  FalconBootFaults faults_{};
  FalconProcessorCounters counters_{};
};

}  // namespace thimble::sim
