#include "hal/base/result.hpp"

namespace thimble {

std::string_view to_string(Errc code) noexcept {
  switch (code) {
    case Errc::InvalidArgument:
      return "invalid argument";
    case Errc::NotFound:
      return "not found";
    case Errc::NotMine:
      return "not mine";
    case Errc::Permission:
      return "permission";
    case Errc::Busy:
      return "busy";
    case Errc::Disconnected:
      return "disconnected";
    case Errc::Timeout:
      return "timeout";
    case Errc::Malformed:
      return "malformed";
    case Errc::TooLarge:
      return "too large";
    case Errc::Unsupported:
      return "unsupported";
    case Errc::System:
      return "system";
  }
  return "unknown";
}

}  // namespace thimble
