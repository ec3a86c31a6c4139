#pragma once

#include <cstdint>

#include "hal/base/io_status.hpp"
#include "hal/plugin/plugin_abi.h"

namespace thimble::plugin {

// How an exchange went, in the words of the ABI, and back. What the ABI has no word for is a
// protocol error. Any thread. RT.
[[nodiscard]] constexpr std::int32_t abi_status(IoStatus status) noexcept {
  switch (status) {
    case IoStatus::Ok:
      return THIMBLE_OK;
    case IoStatus::NoData:
      return THIMBLE_NO_DATA;
    case IoStatus::Backlogged:
      return THIMBLE_BACKLOGGED;
    case IoStatus::Disconnected:
      return THIMBLE_DISCONNECTED;
    case IoStatus::ProtocolError:
      break;
  }
  return THIMBLE_PROTOCOL_ERROR;
}
[[nodiscard]] constexpr IoStatus io_status(std::int32_t said) noexcept {
  switch (said) {
    case THIMBLE_OK:
      return IoStatus::Ok;
    case THIMBLE_NO_DATA:
      return IoStatus::NoData;
    case THIMBLE_BACKLOGGED:
      return IoStatus::Backlogged;
    case THIMBLE_DISCONNECTED:
      return IoStatus::Disconnected;
    default:
      return IoStatus::ProtocolError;
  }
}

}  // namespace thimble::plugin
