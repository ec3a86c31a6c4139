#include "daemon/link/serial_line.hpp"

namespace thimble::link {

void tell_of_line(const SerialLine& line, const std::string& trouble, LinkStatus& out) {
  out.peer = line.name;
  const bool is_gibberish = out.counters.received == 0 && out.counters.receive_errors > 0;
  if (!trouble.empty()) {
    out.last_error = trouble;
  } else if (is_gibberish && out.last_error.empty()) {
    out.last_error = "nothing but damaged frames: does the other end run at " +
                     std::to_string(line.bit_per_s) + " bit/s?";
  }
}

}  // namespace thimble::link
