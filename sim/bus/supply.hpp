#pragma once

#include <cstdint>

namespace thimble::sim {

// What a device has left when its plug is pulled. Most arms have a supply of their own: it stays,
// their firmware goes on, and what their motors do then is the arm's own affair (its watchdog's, if
// it has one). Where it goes, the power is off at both ends of the time without the cable.
enum class Supply : std::uint8_t { Goes, Stays };

}  // namespace thimble::sim
