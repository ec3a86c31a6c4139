#include "hal/linux/hid_transfers.hpp"

#include <fcntl.h>
#include <hidapi.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>

#include "hal/linux/system_error.hpp"

namespace thimble::linux {
namespace {

constexpr const char* kRefused = " cannot be opened";

}  // namespace

Result<std::unique_ptr<HidTransfers>> HidTransfers::open(const std::string& node,
                                                         bool has_report_ids,
                                                         bus::HidMailboxes& mail,
                                                         const Clock& clock, std::mutex& hidapi,
                                                         std::optional<HiddevOutput> hiddev) {
  // Ours before hidapi's, and alone: a node that hangs when it is opened hangs here.
  const int lock = ::open(node.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
  if (lock < 0) return tl::unexpected(system_error(node + kRefused, errno));
  std::unique_ptr<HidTransfers> transfers(
      new HidTransfers(lock, has_report_ids, mail, clock, hiddev));
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return tl::unexpected(system_error(node + kRefused, errno));
    return fail(Errc::Busy, node + " is held by another daemon, or locked by another program");
  }
  const std::lock_guard guard(hidapi);
  transfers->reading_ = ::hid_open_path(node.c_str());
  const bool is_read = transfers->reading_ != nullptr;
  if (is_read && hiddev) return transfers;
  if (is_read) transfers->writing_ = ::hid_open_path(node.c_str());
  if (transfers->writing_ != nullptr) return transfers;
  return fail(Errc::System, node + " cannot be opened by hidapi: is it still plugged in?");
}

HidTransfers::~HidTransfers() {
  if (writing_ != nullptr) ::hid_close(writing_);
  if (reading_ != nullptr) ::hid_close(reading_);
  ::close(lock_);
}

bool HidTransfers::receive(int wait_ms) noexcept {
  // One byte more than we keep, so that a longer report is seen to be one.
  std::array<std::uint8_t, bus::kMaxHidReportBytes + 1> buffer;
  const int bytes = ::hid_read_timeout(reading_, buffer.data(), buffer.size(), wait_ms);
  // The kernel has no other reason to refuse a read: hidraw.c says EIO, or hangs up a poll.
  if (bytes < 0) mail_->disconnect();
  if (bytes <= 0) return false;
  mail_->deliver(std::span(buffer).first(static_cast<std::size_t>(bytes)), clock_->now());
  return true;
}

bool HidTransfers::send() noexcept {
  if (mail_->is_disconnected()) return false;
  const std::span<const std::uint8_t> report = mail_->take_out();
  if (report.empty()) return false;
  // That the device is gone, reading says.
  mail_->finish_out(hiddev_ ? hiddev_->write(report) : write_to_hidraw(report));
  return true;
}

bool HidTransfers::write_to_hidraw(std::span<const std::uint8_t> report) noexcept {
  // The first byte is the report's number for the kernel, 0 where reports have none.
  std::array<std::uint8_t, bus::kMaxHidReportBytes + 1> buffer{};
  const std::size_t prefix_bytes = has_report_ids_ ? 0 : 1;
  const std::size_t bytes = prefix_bytes + report.size();
  std::copy(report.begin(), report.end(),
            buffer.begin() + static_cast<std::ptrdiff_t>(prefix_bytes));
  // Why it fails cannot be told apart through hidapi.
  return ::hid_write(writing_, buffer.data(), bytes) == static_cast<int>(bytes);
}

}  // namespace thimble::linux
