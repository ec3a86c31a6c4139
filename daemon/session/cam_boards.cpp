#include "daemon/session/cam_boards.hpp"

#include <optional>
#include <utility>

#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "drivers/cambus/usb_port.hpp"
#include "sim/model/cam/sim_cam_board.hpp"

namespace thimble::session {
namespace {

using Opened = Result<std::unique_ptr<CamBoard>>;

// An opening takes several visits.
class UsbOpener {
 public:
  explicit UsbOpener(std::shared_ptr<sim::cam::SimUsbCamBoard> board) : board_(std::move(board)) {}

  Opened operator()(MonotonicTime now) {
    if (!opening_) {
      const auto match = cambus::match_usb_board(board_->info());
      if (!match) return tl::unexpected(match.error());
      auto device = board_->open(match->claim);
      if (!device) return tl::unexpected(device.error());
      opening_.emplace(*std::move(device), *match);
    }
    auto port = opening_->poll(now);
    if (!port && port.error().code == Errc::Busy) return tl::unexpected(port.error());
    opening_.reset();
    if (!port) return tl::unexpected(port.error());
    return std::make_unique<cambus::Board>(*std::move(port));
  }

 private:
  std::shared_ptr<sim::cam::SimUsbCamBoard> board_;
  std::optional<cambus::UsbOpening> opening_;  // before the board it is of goes
};

}  // namespace

world::cam::PieceBoard::Opener open_in_slot(const Clock& clock,
                                            const sim::cam::BoardOptions& options) {
  const auto slot = std::make_shared<sim::cam::SimCamBoard>(clock, options);
  return [slot](MonotonicTime now) -> Opened {
    auto port = cambus::PciPort::open(slot->open_window(), now);
    if (!port) return tl::unexpected(port.error());
    return std::make_unique<cambus::Board>(*std::move(port));
  };
}

world::cam::PieceBoard::Opener open_on_usb(std::shared_ptr<sim::cam::SimUsbCamBoard> board) {
  // A function can be copied, an opening cannot.
  const auto opener = std::make_shared<UsbOpener>(std::move(board));
  return [opener](MonotonicTime now) { return (*opener)(now); };
}

}  // namespace thimble::session
