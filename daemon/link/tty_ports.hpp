#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "daemon/link/line_port.hpp"
#include "hal/base/result.hpp"

namespace boost::asio {
class io_context;
}

namespace thimble::link {

// An opened serial port: the number of its file, closed with its last owner.
using LineNode = std::shared_ptr<const int>;
// Opens the device `node`, now or again; must not wait for what a line may never have. Errors: one
// sentence.
using OpenLine = std::function<Result<LineNode>(const std::string& node, std::uint32_t bit_per_s)>;

// The serial ports of this machine (TtyPort). Thread: the one that runs the io_context, which also
// calls `open`. RT: not. Ownership: the io_context must outlive it and its ports. Errors: none
// here.
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
