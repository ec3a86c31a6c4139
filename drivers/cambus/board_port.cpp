#include "drivers/cambus/board_port.hpp"

namespace thimble::cambus {

std::string_view to_string(Gone why) noexcept {
  switch (why) {
    case Gone::No:
      return "is there";
    case Gone::Unplugged:
      return "was unplugged";
    case Gone::Silent:
      return "does not answer any more";
    case Gone::NewIncarnation:
      return "was reset by itself or by its power";
    case Gone::NoBeat:
      return "stands still: its beat does not change";
  }
  return "is gone";
}

}  // namespace thimble::cambus
