#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "daemon/devices/device_executor.hpp"
#include "daemon/session/plug_search.hpp"
#include "drivers/cambus/usb_port.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/bus/memory_window.hpp"

namespace thimble::session {

// Where boards of worlds are plugged in, and who looks for them, opens and closes them; both
// outlive whatever uses them.
struct BoardPlugs {
  bus::BusEnumerator* buses{nullptr};
  devices::DeviceExecutor* executor{nullptr};
  // The memory of the one in a slot of PCI. May wait.
  std::function<Result<std::unique_ptr<bus::MemoryWindow>>()> open_window{};
};

// A board that is open, of nobody else, and what is known of it.
struct ClaimedBoard {
  std::unique_ptr<bus::UsbDevice> device;
  cambus::UsbBoardMatch match;
  bus::DeviceAddress address;
};

// Looks for a CAM board on USB: the first that is known by its descriptors and can be had; those
// that were taken and never worked come last, the one taken longest ago first. Nobody waits for the
// kernel (PlugSearch), nor where the board's device ends, which `executor` does, too.
//
// Thread: one, that of the world, from which `executor` takes tasks. Not RT.
class BoardSearch {
 public:
  explicit BoardSearch(const BoardPlugs& plugs);

  // As PlugSearch::take(). Errors: Busy while it is looked for; NotFound, there is none; why the
  // first of those there are cannot be had, with its address in front.
  [[nodiscard]] Result<ClaimedBoard> take(MonotonicTime now);
  // The one taken last does what boards do.
  void note_works();

 private:
  // Addresses, in the order in which they were taken.
  using Doubted = std::vector<std::string>;
  // Ours: more than there are ports, and no more to be remembered.
  static constexpr std::size_t kMostDoubted = 64;

  [[nodiscard]] static PlugSearch<ClaimedBoard>::Find finder(bus::BusEnumerator& buses,
                                                             Doubted doubted);

  bus::BusEnumerator* buses_;
  Doubted doubted_;
  devices::DeviceExecutor* executor_;
  PlugSearch<ClaimedBoard> search_;
};

}  // namespace thimble::session
