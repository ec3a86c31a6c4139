#include "board/board_bar.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <cerrno>

#include "drivers/cambus/cambus_page_wire.hpp"
#include "hal/linux/mapped_window.hpp"
#include "hal/linux/system_error.hpp"

namespace thimble::board {
namespace {

using linux::Descriptor;
using linux::system_error;

// Domain, bus, device and function; 0 stands for a hexadecimal digit.
constexpr std::string_view kSlot = "0000:00:00.0";

bool is_digit(char letter) noexcept {
  return (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'f');
}

bool is_slot(std::string_view text) noexcept {
  return std::equal(
      text.begin(), text.end(), kSlot.begin(), kSlot.end(),
      [](char letter, char form) { return form == '0' ? is_digit(letter) : letter == form; });
}

// The kernel counts: who enables what is enabled already would hold it so for ever.
Result<void> enable(const std::filesystem::path& file) {
  const Descriptor node(::open(file.c_str(), O_RDWR | O_CLOEXEC));
  char state = 0;
  if (node.get() < 0 || ::pread(node.get(), &state, 1, 0) != 1 ||
      (state == '0' && ::pwrite(node.get(), "1", 1, 0) != 1)) {
    return tl::unexpected(system_error(file.string(), errno));
  }
  return {};
}

// For as long as anybody has what was opened, open or mapped (flock(2)).
Result<void> lock(const Descriptor& node, const std::string& name) {
  if (::flock(node.get(), LOCK_EX | LOCK_NB) == 0) return {};
  if (errno == EWOULDBLOCK) return fail(Errc::Busy, name + ": somebody else has this board");
  return tl::unexpected(system_error(name, errno));
}

}  // namespace

Result<PciBar> parse_bar(std::string_view slot, std::string_view number) {
  if (!is_slot(slot)) {
    return fail(Errc::InvalidArgument, "expected a slot of PCI such as 0000:00:10.0");
  }
  if (number.size() != 1 || number[0] < '0' || number[0] > '5') {
    return fail(Errc::InvalidArgument, "expected the number of a BAR, 0 to 5");
  }
  return PciBar{std::string(slot), number[0] - '0'};
}

Result<Descriptor> open_board(const std::filesystem::path& devices, const PciBar& bar) {
  const std::filesystem::path device = devices / bar.slot;
  if (Result<void> enabled = enable(device / "enable"); !enabled) {
    return tl::unexpected(enabled.error());
  }
  const std::filesystem::path file = device / ("resource" + std::to_string(bar.number));
  Descriptor node(::open(file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW));
  if (node.get() < 0) return tl::unexpected(system_error(file.string(), errno));
  if (Result<void> locked = lock(node, file.string()); !locked) {
    return tl::unexpected(locked.error());
  }
  const auto window = linux::MappedWindow::map(node, file.string());
  if (!window) return tl::unexpected(window.error());
  std::uint32_t magic = 0;
  const IoStatus status = (*window)->read(cambus::page::kMagic, magic);
  if (status != IoStatus::Ok || magic != cambus::page::kMagicValue) {
    return fail(Errc::NotMine, file.string() + ": no CAM board answers");
  }
  return node;
}

}  // namespace thimble::board
