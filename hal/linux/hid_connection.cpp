#include "hal/linux/hid_connection.hpp"

#include <fcntl.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "hal/linux/system_error.hpp"

namespace thimble::linux {
namespace {

// How long closing waits for a device that says nothing; one that speaks ends the wait.
constexpr int kReadWait_ms = 10;
// udevd gives each node its rights when it comes to it, and hiddev's may come after hidraw's. Ours:
// within HidHost::kPatience.
constexpr Duration kNodePatience = std::chrono::milliseconds(150);
constexpr Duration kNodeLook = std::chrono::milliseconds(5);
// No device of full speed takes a report in less: the kernel put it into its queue, as it does
// while the device is reset, and would fill that with what is old by then. Ours: beside 10 µs that
// the two calls take by themselves.
constexpr Duration kNobodyTakesIn = std::chrono::microseconds(30);
constexpr int kFrame_ms = 1;

}  // namespace

Result<std::unique_ptr<HidConnection>> HidConnection::start(HidNodes nodes,
                                                            const bus::BusDeviceInfo& info,
                                                            const BusSettings& settings,
                                                            std::mutex& opening,
                                                            DeviceCalls& calls) {
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<HidConnection> connection(
      new HidConnection(std::move(nodes), info, settings, opening, calls));
  const Result<void> started = connection->start();
  if (!started.has_value()) return tl::unexpected(started.error());
  return connection;
}

HidConnection::HidConnection(HidNodes nodes, const bus::BusDeviceInfo& info,
                             const BusSettings& settings, std::mutex& opening, DeviceCalls& calls)
    : nodes_(std::move(nodes)),
      address_(info.address),
      has_report_ids_(info.has_report_ids),
      output_report_bytes_(info.output_report_bytes),
      settings_(&settings),
      opening_(&opening),
      calls_(&calls),
      mail_(info.output_report_bytes) {}

HidConnection::~HidConnection() {
  if (thread_ != nullptr) end();
  thread_.reset();
}

Result<void> HidConnection::start() {
  for (std::unique_ptr<WakeEvent>* event : {&wake_, &changed_}) {
    Result<std::unique_ptr<WakeEvent>> created = WakeEvent::create();
    if (!created.has_value()) return tl::unexpected(created.error());
    *event = std::move(created.value());
  }
  auto thread = RealtimeThread::start(settings_->thread, settings_->process, [this] { run(); });
  if (!thread.has_value()) return tl::unexpected(thread.error());
  thread_ = std::move(thread.value());
  return {};
}

Result<void> HidConnection::opened(Duration patience) {
  if (!has_reached(State::Open, patience)) {
    return tl::unexpected(Error{Errc::Timeout, {}});
  }
  if (state_.load() == State::Refused) return tl::unexpected(refusal_);
  return {};
}

void HidConnection::end() noexcept {
  is_over_.store(true);
  wake_->signal();
}

bool HidConnection::has_ended(Duration patience) { return has_reached(State::Refused, patience); }

bool HidConnection::has_reached(State state, Duration patience) {
  const MonotonicTime deadline = settings_->clock.now() + patience;
  for (;;) {
    if (state_.load() >= state) return true;
    const Duration rest = deadline - settings_->clock.now();
    if (rest <= Duration(0)) return false;
    changed_->wait_at_most(rest);
  }
}

void HidConnection::reach(State state) noexcept {
  state_.store(state);
  changed_->signal();
}

void HidConnection::run() noexcept {
  const Result<void> opened = open();
  if (!opened.has_value()) {
    close();
    refusal_ = opened.error();
    return reach(State::Refused);
  }
  reach(State::Open);
  while (!is_over_.load()) {
    send();
    wake_->wait();
  }
  // The last is the newest that the servo wanted, zero after a fault: an older one that the kernel
  // was slow to deliver must not be what the arm is left with.
  transfers_->send();
  close();
  reach(State::Closed);
}

// After one that only waits in the kernel's queue no more than one a frame: of 64 that it holds
// some must be left for the zeros that come after a fault (docs/decisions/0488).
void HidConnection::send() noexcept {
  const MonotonicTime began = settings_->clock.now();
  const bool is_sent = transfers_->send();
  if (!is_sent || shared_->way != NodeWay::Hiddev) return;
  if (settings_->clock.now() - began < kNobodyTakesIn) ::poll(nullptr, 0, kFrame_ms);
}

void HidConnection::close() noexcept {
  reader_.reset();
  transfers_.reset();
  shared_.reset();
  hiddev_ = Descriptor();
}

Result<void> HidConnection::open() {
  if (Result<void> node = open_hiddev_node(); !node.has_value()) return node;
  const std::optional<HiddevOutput> hiddev = hiddev_output();
  auto transfers = HidTransfers::open(nodes_.hidraw, has_report_ids_, mail_, settings_->clock,
                                      *opening_, hiddev);
  if (!transfers.has_value()) return tl::unexpected(transfers.error());
  transfers_ = std::move(transfers.value());
  if (Result<void> shared = open_for_guard(hiddev.has_value()); !shared.has_value()) return shared;
  auto reader = RealtimeThread::start(settings_->thread, settings_->process, [this] { read(); });
  if (!reader.has_value()) return tl::unexpected(reader.error());
  reader_ = std::move(reader.value());
  return {};
}

// One that is there and may not be opened is a refusal: over hidraw the arm could be held up by
// any other HID device, and nobody would know.
Result<void> HidConnection::open_hiddev_node() {
  if (nodes_.hiddev.empty()) return {};
  const MonotonicTime deadline = settings_->clock.now() + kNodePatience;
  for (;;) {
    hiddev_ = Descriptor(::open(nodes_.hiddev.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    const int code = errno;
    if (hiddev_.get() >= 0 || !wants_hiddev()) return {};
    if (code == ENOENT || code == ENODEV || code == ENXIO) return {};
    const bool may_come = code == EACCES || code == EPERM;
    if (!may_come || is_over_.load() || settings_->clock.now() >= deadline) {
      return tl::unexpected(system_error(nodes_.hiddev + " cannot be opened", code));
    }
    wake_->wait_at_most(kNodeLook);
  }
}

// Of pucks, whose reports have numbers and to which nothing is sent, it is nobody's by our rules.
bool HidConnection::wants_hiddev() const noexcept {
  return !has_report_ids_ && output_report_bytes_ > 0;
}

std::optional<HiddevOutput> HidConnection::hiddev_output() {
  if (hiddev_.get() < 0 || !wants_hiddev()) return std::nullopt;
  if (!takes_plain_bytes(hiddev_.get(), output_report_bytes_, *calls_)) return std::nullopt;
  // Before hidraw is opened, where the answers would be read as samples.
  have_reports_asked_for(hiddev_.get(), *calls_);
  return HiddevOutput(hiddev_.get(), *calls_);
}

// Here and now, since a guard is asked for when nobody may wait for the kernel.
Result<void> HidConnection::open_for_guard(bool has_hiddev) {
  auto shared = has_hiddev ? share_node(hiddev_.get(), NodeWay::Hiddev)
                           : open_hidraw_to_share(nodes_.hidraw, has_report_ids_);
  if (!shared.has_value()) return tl::unexpected(shared.error());
  shared_ = std::make_shared<const SharedDevice>(std::move(shared.value()));
  return {};
}

void HidConnection::read() noexcept {
  while (!is_over_.load() && !mail_.is_disconnected()) transfers_->receive(kReadWait_ms);
}

}  // namespace thimble::linux
