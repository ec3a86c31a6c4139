#pragma once

#include <optional>
#include <span>
#include <vector>

#include "daemon/coupling/world_coupling.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/serial_frame.hpp"
#include "daemon/link/thesis_world_end.hpp"
#include "daemon/link/thimble_world_end.hpp"

namespace thimble::link {

// The world's end of both protocols on a serial line, without the line: bytes in, frames out. One
// line, one arm. Every sample is served when it comes; of answers the line has no room for the
// newest wins. A key shuts the door to programs of 1999 here, too (decision 0427); without one
// nobody else can speak, since a line has two ends.
//
// Thread: one, the net plane's. RT: not; allocates when a session begins.
// Ownership: what is behind the worlds must outlive it. Errors: none end it; all are counted,
// damaged frames as receive errors, answers that had no room as withheld.
class LineWorldEnd {
 public:
  // `settings.key`: see above. `of_1999` may be nullptr, `make_half` empty: not spoken then.
  LineWorldEnd(const ThimbleWorldEnd::Settings& settings, coupling::WorldCoupling* of_1999,
               const ThimbleWorldEnd::MakeHalf& make_half, const RandomBytes& random,
               std::uint32_t bit_per_s);

  // What the line brought, however it was cut.
  void on_bytes(std::span<const std::byte> bytes, MonotonicTime now);
  // True and `out` set when a frame is to leave now.
  bool poll(MonotonicTime now, SerialFrame& out);
  // When to poll again at the latest; bytes come on top.
  [[nodiscard]] std::optional<MonotonicTime> next_due() const;
  [[nodiscard]] LinkStatus status() const;
  [[nodiscard]] std::vector<LinkStatus> sessions() const;

 private:
  void on_datagram(std::span<const std::byte> datagram, MonotonicTime now);
  void serve(MonotonicTime now);
  void keep(std::span<const std::byte> datagram);

  std::optional<ThesisWorldEnd> thesis_;
  std::optional<ThimbleWorldEnd> thimble_;
  Deframer deframer_;
  LinePace pace_;
  SerialFrame newest_{};
  bool has_newest_{false};
  LinkCounters counters_{};  // of the line, and of what nobody here understands
};

}  // namespace thimble::link
