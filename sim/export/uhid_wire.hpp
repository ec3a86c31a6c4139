#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/sim_model.hpp"

// Events of /dev/uhid, both ways, in the machine's byte order. Numbers and layout: linux/uhid.h.
namespace thimble::sim::uhid {

inline constexpr std::size_t kEventBytes = 4380;      // sizeof(struct uhid_event)
inline constexpr std::size_t kMaxReportBytes = 4096;  // UHID_DATA_MAX

// What the kernel says. Spans point into the bytes that were parsed.
struct Start {
  bool has_feature_numbers{false};
  bool has_output_numbers{false};
  bool has_input_numbers{false};
};
struct Stop {};
struct Open {};
struct Close {};
struct Output {
  plugin::HidReportKind kind{};
  std::span<const std::uint8_t> bytes;
};
struct GetReport {
  std::uint32_t id{0};
  plugin::HidReportKind kind{};
  std::uint8_t number{0};
};
struct SetReport {
  std::uint32_t id{0};
  plugin::HidReportKind kind{};
  std::uint8_t number{0};
  std::span<const std::uint8_t> bytes;
};
using Event = std::variant<Start, Stop, Open, Close, Output, GetReport, SetReport>;

// Total: nothing for bytes that are no event of those above, whole and with lengths that can be.
// Thread: any. Pure.
[[nodiscard]] std::optional<Event> parse(std::span<const std::uint8_t> bytes) noexcept;

// What the kernel is told. Texts that are too long are cut; a descriptor or report must not be
// longer than kMaxReportBytes (checked). Not RT: they allocate. Thread: any. Pure.
using Bytes = std::vector<std::uint8_t>;
[[nodiscard]] Bytes create(const bus::BusDeviceInfo& device,
                           std::span<const std::uint8_t> descriptor);
[[nodiscard]] Bytes destroy();
[[nodiscard]] Bytes input(std::span<const std::uint8_t> report);
// `error` is an errno; with one, `report` is empty.
[[nodiscard]] Bytes get_report_reply(std::uint32_t id, std::uint16_t error,
                                     std::span<const std::uint8_t> report);
[[nodiscard]] Bytes set_report_reply(std::uint32_t id, std::uint16_t error);

}  // namespace thimble::sim::uhid
