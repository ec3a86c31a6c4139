#pragma once

#include "daemon/api/status.hpp"

namespace thimble::api {

// Where the server gets the state of the daemon.
// Thread: the net thread. Must not block: it is called once for every request.
class StatusView {
 public:
  virtual ~StatusView() = default;
  [[nodiscard]] virtual Status status() const = 0;
};

}  // namespace thimble::api
