#include "daemon/app/service_notifier.hpp"

#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace thimble::app {
namespace {

std::string_view listener_of_environment() {
  const char* name = std::getenv("NOTIFY_SOCKET");
  return name == nullptr ? "" : name;
}

}  // namespace

ServiceNotifier::ServiceNotifier() : ServiceNotifier(listener_of_environment()) {
  std::uint64_t interval_us = 0;
  if (sd_watchdog_enabled(0, &interval_us) > 0 && interval_us > 0) {
    interval_ = std::chrono::microseconds(interval_us / 2);
  }
}

ServiceNotifier::ServiceNotifier(std::string_view socket_name) {
  const bool is_abstract = socket_name.starts_with('@');
  const bool is_path = socket_name.starts_with('/');
  if (!(is_abstract || is_path) || socket_name.size() >= sizeof address_.sun_path) return;
  socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  address_.sun_family = AF_UNIX;
  std::copy(socket_name.begin(), socket_name.end(), address_.sun_path);
  // unix(7): an abstract name begins with a zero byte and ends with the address's length.
  if (is_abstract) address_.sun_path[0] = '\0';
  address_bytes_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_name.size() +
                                          (is_abstract ? 0 : 1));
}

ServiceNotifier::~ServiceNotifier() {
  if (socket_ >= 0) ::close(socket_);
}

void ServiceNotifier::ready(const std::string& status) {
  owed_states_ += "READY=1\n";
  owed_status_ = status;
  retry();
}

void ServiceNotifier::status(const std::string& status) {
  owed_status_ = status;
  retry();
}

void ServiceNotifier::stopping() {
  owed_states_ += "STOPPING=1\n";
  owed_status_ = "the force ramps to zero";
  retry();
}

void ServiceNotifier::alive() {
  owes_alive_ = true;
  retry();
}

std::string ServiceNotifier::owed() const {
  std::string out = owed_states_;
  if (owes_alive_) out += "WATCHDOG=1\n";
  if (!owed_status_.empty()) out += "STATUS=" + owed_status_ + "\n";
  return out;
}

void ServiceNotifier::retry() {
  const std::string text = owed();
  if (text.empty()) return;
  if (socket_ >= 0) {
    const auto* address = reinterpret_cast<const sockaddr*>(&address_);
    const ssize_t sent = ::sendto(socket_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                                  address, address_bytes_);
    const bool has_no_room = sent < 0 && (errno == EAGAIN || errno == ENOBUFS || errno == EINTR);
    if (has_no_room) return;
  }
  owed_states_.clear();
  owed_status_.clear();
  owes_alive_ = false;
}

}  // namespace thimble::app
