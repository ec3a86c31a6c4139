#pragma once

#include <cstdint>
#include <string_view>

namespace thimble {

// Outcome of one per-tick exchange with a bus or a device. Never a reason to throw.
enum class IoStatus : std::uint8_t {
  Ok,
  NoData,         // nothing new since the last call; the outputs are untouched
  Backlogged,     // no write has arrived since the last one; the newest value waits its turn
  Disconnected,   // latched by the bus: every later call says the same
  ProtocolError,  // bytes arrived that the codec refuses; counted, outputs untouched
};

[[nodiscard]] constexpr std::string_view to_string(IoStatus status) noexcept {
  switch (status) {
    case IoStatus::Ok:
      return "ok";
    case IoStatus::NoData:
      return "no data";
    case IoStatus::Backlogged:
      return "backlogged";
    case IoStatus::Disconnected:
      return "disconnected";
    case IoStatus::ProtocolError:
      return "protocol error";
  }
  return "unknown";
}

}  // namespace thimble
