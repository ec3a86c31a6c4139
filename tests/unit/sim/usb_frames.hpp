#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "hal/plugin/sim_model.hpp"

namespace thimble::sim {

using Fields = std::array<std::int16_t, 7>;  // of one report, either way

inline std::array<std::uint8_t, 14> bytes_of(const Fields& fields) {
  std::array<std::uint8_t, 14> bytes{};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto value = static_cast<std::uint16_t>(fields[i]);
    bytes[2 * i] = static_cast<std::uint8_t>(value % 256);
    bytes[2 * i + 1] = static_cast<std::uint8_t>(value / 256);
  }
  return bytes;
}

inline Fields fields_of(std::span<const std::uint8_t> bytes) {
  Fields fields{};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto value = static_cast<std::uint16_t>(bytes[2 * i] + 256 * bytes[2 * i + 1]);
    fields[i] = static_cast<std::int16_t>(value);
  }
  return fields;
}

inline Fields currents(std::int16_t a, std::int16_t b, std::int16_t c) { return {a, b, c}; }
inline Fields set_counters(std::int16_t a, std::int16_t b, std::int16_t c) {
  return {0, 0, 0, 1, a, b, c};
}

// Runs a model's USB frames of 1 ms as the bus does: advance, then OUT, then IN.
class UsbFrames {
 public:
  explicit UsbFrames(plugin::SimHidModel& model)
      : model_(model), report_bytes_(model.describe().input_report_bytes) {}

  // One frame; returns what the device sent in it.
  std::optional<Fields> frame(std::optional<Fields> out = std::nullopt) {
    if (out.has_value()) {
      std::array<std::uint8_t, 64> padded{};
      const auto bytes = bytes_of(*out);
      std::copy(bytes.begin(), bytes.end(), padded.begin());
      return frame_of_bytes({padded.data(), report_bytes_});
    }
    return frame_of_bytes({});
  }
  std::optional<Fields> frame_of_bytes(std::span<const std::uint8_t> out) {
    time_ = time_ + Duration(1'000'000);
    model_.advance(time_);
    if (!out.empty()) model_.out_report(out);
    std::array<std::uint8_t, 64> in{};
    const std::size_t size = model_.in_report(in);
    if (size != report_bytes_) return std::nullopt;
    return fields_of(in);
  }
  // Repeats one report in every frame for that long; returns the last answer.
  Fields run_ms(int frames, const Fields& out) {
    Fields last{};
    for (int i = 0; i < frames; ++i) last = frame(out).value_or(last);
    return last;
  }
  void silence_ms(int frames) {
    for (int i = 0; i < frames; ++i) frame();
  }
  [[nodiscard]] MonotonicTime now() const { return time_; }

 private:
  plugin::SimHidModel& model_;
  std::size_t report_bytes_;
  MonotonicTime time_{Duration(7'000'000'000)};  // no clock starts at zero
};

}  // namespace thimble::sim
