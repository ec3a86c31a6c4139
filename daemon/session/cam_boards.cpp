#include "daemon/session/cam_boards.hpp"

#include <functional>
#include <optional>
#include <utility>

#include "daemon/session/proven_board.hpp"
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
  // Errors: why there is none now.
  using Claim = std::function<Result<ClaimedBoard>(MonotonicTime now)>;
  // `when_it_works`: as ProvenBoard's, of the board claimed last.
  explicit UsbOpener(Claim claim, std::function<void()> when_it_works = nullptr)
      : claim_(std::move(claim)), when_it_works_(std::move(when_it_works)) {}

  Opened operator()(MonotonicTime now) {
    if (!opening_) {
      auto board = claim_(now);
      if (!board) return tl::unexpected(board.error());
      opening_.emplace(std::move(board->device), board->match);
    }
    auto port = opening_->poll(now);
    if (!port && port.error().code == Errc::Busy) return tl::unexpected(port.error());
    opening_.reset();
    if (!port) return tl::unexpected(port.error());
    return std::make_unique<ProvenBoard>(std::make_unique<cambus::Board>(*std::move(port)),
                                         when_it_works_);
  }

 private:
  Claim claim_;
  std::function<void()> when_it_works_;
  std::optional<cambus::UsbOpening> opening_;  // before what the claim keeps goes
};

Opened open_window(std::unique_ptr<bus::MemoryWindow> window, MonotonicTime now,
                   const cambus::PciTurn& turn) {
  auto port = cambus::PciPort::open(std::move(window), now, turn);
  if (!port) return tl::unexpected(port.error());
  return std::make_unique<cambus::Board>(*std::move(port));
}

// A function can be copied, an opening cannot.
world::cam::PieceBoard::Opener opener_of(UsbOpener::Claim claim,
                                         std::function<void()> when_it_works = nullptr) {
  const auto opener = std::make_shared<UsbOpener>(std::move(claim), std::move(when_it_works));
  return [opener](MonotonicTime now) { return (*opener)(now); };
}

}  // namespace

world::cam::PieceBoard::Opener open_in_slot(const Clock& clock,
                                            const sim::cam::BoardOptions& options) {
  const auto slot = std::make_shared<sim::cam::SimCamBoard>(clock, options);
  return [slot](MonotonicTime now) {
    return open_window(slot->open_window(), now, cambus::kMemoryTurn);
  };
}

world::cam::PieceBoard::Opener open_on_usb(std::shared_ptr<sim::cam::SimUsbCamBoard> board) {
  return opener_of([board = std::move(board)](MonotonicTime) -> Result<ClaimedBoard> {
    const auto match = cambus::match_usb_board(board->info());
    if (!match) return tl::unexpected(match.error());
    auto device = board->open(match->claim);
    if (!device) return tl::unexpected(device.error());
    return ClaimedBoard{*std::move(device), *match, board->info().address};
  });
}

world::cam::PieceBoard::Opener open_plugged_in(const BoardPlugs& plugs) {
  const auto search = std::make_shared<BoardSearch>(plugs);
  return opener_of([search](MonotonicTime now) { return search->take(now); },
                   [search] { search->note_works(); });
}

world::cam::PieceBoard::Opener open_in_real_slot(const BoardPlugs& plugs) {
  using Search = PlugSearch<std::unique_ptr<bus::MemoryWindow>>;
  const auto search = std::make_shared<Search>(*plugs.executor, plugs.open_window,
                                               "the CAM board in its slot is looked for");
  return [search](MonotonicTime now) -> Opened {
    auto window = search->take(now);
    if (!window) return tl::unexpected(window.error());
    auto board = open_window(*std::move(window), now, cambus::kBusTurn);
    if (!board) return board;
    return std::make_unique<ProvenBoard>(*std::move(board), [search] { search->note_works(); });
  };
}

}  // namespace thimble::session
