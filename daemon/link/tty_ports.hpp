#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <string>

#include "daemon/link/line_port.hpp"
#include "hal/base/result.hpp"

namespace boost::asio {
class io_context;
}

namespace thimble::link {

// An opened serial port: the number of its file, closed with its last owner. As an adapter may keep
// the kernel for seconds in both, neither may wait for it: whoever opens says how it is closed.
using LineNode = std::shared_ptr<const int>;
// Asks for the device `node` to be opened, now or again, and returns at once; the answer may come
// from another thread. Errors: one sentence; an answer that was given up is one, too.
using OpenLine =
    std::function<std::future<Result<LineNode>>(const std::string& node, std::uint32_t bit_per_s)>;

// The serial ports of this machine (TtyPort). Thread: the one that runs the io_context, which also
// calls `open`, and looks for its answers. RT: not. Ownership: the io_context must outlive it and
// its ports. Errors: none here.
class TtyPorts final : public LinePorts {
 public:
  TtyPorts(boost::asio::io_context& io, OpenLine open);
  [[nodiscard]] std::unique_ptr<LinePort> make_port(const std::string& node,
                                                    std::uint32_t bit_per_s) override;

 private:
  boost::asio::io_context* io_;
  OpenLine open_;
};

}  // namespace thimble::link
