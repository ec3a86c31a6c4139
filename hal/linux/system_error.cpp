#include "hal/linux/system_error.hpp"

#include <cerrno>
#include <cstring>
#include <string>

namespace thimble::linux {

Error system_error(std::string_view what, int code) {
  Errc errc = Errc::System;
  if (code == EACCES || code == EPERM) errc = Errc::Permission;
  if (code == ENOENT || code == ENODEV || code == ENXIO) errc = Errc::NotFound;
  if (code == EBUSY || code == EWOULDBLOCK) errc = Errc::Busy;
  return {errc, std::string(what) + ": " + std::strerror(code)};
}

}  // namespace thimble::linux
