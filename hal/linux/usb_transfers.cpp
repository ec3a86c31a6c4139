#include "hal/linux/usb_transfers.hpp"

#include <libusb.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "hal/linux/usb_pipe.hpp"

namespace thimble::linux {
namespace {

using bus::UsbOutcome;

constexpr std::size_t kPendingReads = 2;  // so that one is with the kernel while one is handled
constexpr Duration kRetryAfter = std::chrono::milliseconds(1);  // a full-speed frame
// Of an IN pipe within kRetryAfter. At full speed a frame has 19 (USB 2.0, table 5-9); as many as
// these, and those still under way, have room where they wait to be read.
constexpr std::size_t kMostReads = bus::kUsbQueuedPackets - kPendingReads;
constexpr int kRetryPoll_ms = 1;
// Clearing a halt may keep the kernel, and with it this thread, for 5 s (USB_CTRL_SET_TIMEOUT). An
// arm that nothing is heard of is let go meanwhile: by then its ramp and zero are out.
constexpr Duration kInputHaltRest = std::chrono::milliseconds(50);
// A cancelled transfer comes back within a frame; the rest is patience with a bad hub.
constexpr int kClosingPolls = 100;
constexpr int kClosingPoll_ms = 10;
// How long closing waits for a write, twice: one that the device takes ends within a frame or two.
constexpr int kLastPolls = 20;
constexpr int kLastPoll_ms = 1;
constexpr std::size_t kMostDescriptors = 8;  // libusb has three: node, wake-up, timer

Error usb_error(const char* what, int code) {
  Errc errc = Errc::System;
  if (code == LIBUSB_ERROR_ACCESS) errc = Errc::Permission;
  if (code == LIBUSB_ERROR_BUSY) errc = Errc::Busy;
  if (code == LIBUSB_ERROR_NO_DEVICE || code == LIBUSB_ERROR_NOT_FOUND) errc = Errc::NotFound;
  return {errc, std::string(what) + ": " + ::libusb_error_name(code)};
}

UsbOutcome outcome_of(libusb_transfer_status status) noexcept {
  switch (status) {
    case LIBUSB_TRANSFER_COMPLETED:
      return UsbOutcome::Done;
    case LIBUSB_TRANSFER_STALL:
      return UsbOutcome::Stalled;
    case LIBUSB_TRANSFER_OVERFLOW:
      return UsbOutcome::Babbled;
    case LIBUSB_TRANSFER_ERROR:
    case LIBUSB_TRANSFER_TIMED_OUT:
    case LIBUSB_TRANSFER_CANCELLED:
    case LIBUSB_TRANSFER_NO_DEVICE:
      return UsbOutcome::Failed;
  }
  return UsbOutcome::Failed;
}

}  // namespace

Result<std::unique_ptr<UsbTransfers>> UsbTransfers::open(int node, std::uint8_t interface_number,
                                                         bus::UsbMailboxes& mail,
                                                         const Clock& clock) {
  std::unique_ptr<UsbTransfers> transfers(new UsbTransfers(node, interface_number, mail, clock));
  const Result<void> started = transfers->start();
  if (!started.has_value()) return tl::unexpected(started.error());
  return transfers;
}

UsbTransfers::UsbTransfers(int node, std::uint8_t interface_number, bus::UsbMailboxes& mail,
                           const Clock& clock) noexcept
    : node_(node), interface_number_(interface_number), mail_(&mail), clock_(&clock) {}

Result<void> UsbTransfers::start() {
  // Until 1.0.27 the option is one of the process, and said before the context is made.
  ::libusb_set_option(nullptr, LIBUSB_OPTION_NO_DEVICE_DISCOVERY);
  int code = ::libusb_init(&context_);
  if (code != 0) {
    context_ = nullptr;
    return tl::unexpected(usb_error("libusb does not start", code));
  }
  code = ::libusb_wrap_sys_device(context_, node_, &handle_);
  if (code != 0) {
    handle_ = nullptr;
    return tl::unexpected(usb_error("the device's node cannot be used", code));
  }
  // Refused where the kernel cannot do it, and then there is no driver to detach.
  ::libusb_set_auto_detach_kernel_driver(handle_, 1);
  code = ::libusb_claim_interface(handle_, interface_number_);
  if (code != 0) {
    return tl::unexpected(usb_error("the device's interface cannot be claimed", code));
  }
  is_claimed_ = true;
  return allocate();
}

Result<void> UsbTransfers::allocate() {
  control_ = std::make_unique<Transfer>(*this, nullptr,
                                        LIBUSB_CONTROL_SETUP_SIZE + bus::kMaxUsbControlBytes);
  bool has_memory = control_->prepare(nullptr);
  for (std::size_t index = 0; index < mail_->pipe_count(); ++index) {
    auto pipe = std::make_unique<Pipe>();
    pipe->index = index;
    pipe->info = mail_->info(index);
    const std::size_t count = bus::is_usb_in(pipe->info.address) ? kPendingReads : 1;
    for (std::size_t i = 0; i < count; ++i) {
      pipe->transfers.push_back(std::make_unique<Transfer>(
          *this, pipe.get(), pipe->most_packets(*mail_) * pipe->info.max_packet_bytes));
      has_memory = pipe->transfers.back()->prepare(&pipe->info) && has_memory;
    }
    pipes_.push_back(std::move(pipe));
  }
  const libusb_pollfd** descriptors = ::libusb_get_pollfds(context_);
  for (std::size_t i = 0; descriptors != nullptr && descriptors[i] != nullptr; ++i) {
    watched_.push_back({descriptors[i]->fd, descriptors[i]->events});
  }
  ::libusb_free_pollfds(descriptors);
  if (!has_memory) return fail(Errc::System, "no memory for the device's transfers");
  if (watched_.size() > kMostDescriptors) {
    return fail(Errc::System, "libusb watches more files than one device has");
  }
  return {};
}

UsbTransfers::~UsbTransfers() {
  is_closing_ = true;
  if (under_way_ > 0) cancel_all();
  for (int i = 0; i < kClosingPolls && under_way_ > 0; ++i) {
    handle_events();
    if (under_way_ > 0) ::poll(nullptr, 0, kClosingPoll_ms);
  }
  if (is_claimed_) ::libusb_release_interface(handle_, interface_number_);
  if (handle_ != nullptr) ::libusb_close(handle_);
  control_.reset();
  pipes_.clear();
  if (context_ != nullptr) ::libusb_exit(context_);
  ::close(node_);
}

void UsbTransfers::serve() noexcept {
  serve_pipes(false);
  if (!mail_->is_disconnected()) serve_control();
  serve_pipes(true);
}

void UsbTransfers::serve_pipes(bool is_halted) noexcept {
  for (const bool is_in : {false, true}) {
    for (const std::unique_ptr<Pipe>& pipe : pipes_) {
      if (mail_->is_disconnected()) return;
      if (pipe->is_halted != is_halted || bus::is_usb_in(pipe->info.address) != is_in) continue;
      serve_pipe(*pipe);
    }
  }
}

void UsbTransfers::serve_pipe(Pipe& pipe) noexcept {
  if (pipe.is_halted) serve_halt(pipe);
  if (pipe.is_halted || clock_->now() < pipe.not_before) return;
  if (bus::is_usb_in(pipe.info.address)) {
    serve_in(pipe);
  } else {
    serve_out(pipe);
  }
}

void UsbTransfers::serve_halt(Pipe& pipe) noexcept {
  if (!pipe.is_idle() || clock_->now() < pipe.not_before) return;
  const int code = ::libusb_clear_halt(handle_, pipe.info.address);
  if (code == LIBUSB_ERROR_NO_DEVICE) mail_->disconnect();
  pipe.is_halted = code != 0;
  if (!pipe.is_halted) return;
  // Nothing leaves by a halted OUT pipe, so it waits no longer than it must.
  const Duration rest = bus::is_usb_in(pipe.info.address) ? kInputHaltRest : kRetryAfter;
  pipe.not_before = clock_->now() + rest;
}

void UsbTransfers::serve_in(Pipe& pipe) noexcept {
  for (const std::unique_ptr<Transfer>& transfer : pipe.transfers) {
    if (transfer->is_under_way || submit(*transfer)) continue;
    if (mail_->is_disconnected()) return;
    mail_->finish_in(pipe.index, UsbOutcome::Failed, {}, clock_->now());
    pipe.not_before = clock_->now() + kRetryAfter;
    return;
  }
}

void UsbTransfers::serve_out(Pipe& pipe) noexcept {
  Transfer& transfer = *pipe.transfers.front();
  if (transfer.is_under_way) return;
  const std::size_t bytes = fill_out(transfer);
  if (bytes == 0) return;
  transfer.raw().length = static_cast<int>(bytes);
  if (!submit(transfer)) mail_->finish_out(pipe.index, UsbOutcome::Failed, 0);
}

// A run of whole packets and the first short one behind them: into just these the bus cuts it.
std::size_t UsbTransfers::fill_out(Transfer& transfer) noexcept {
  const Pipe& pipe = *transfer.pipe();
  std::size_t bytes = 0;
  for (std::size_t nth = 0; bytes < transfer.buffer().size(); ++nth) {
    const std::span<const std::uint8_t> packet = mail_->take_out(pipe.index, nth);
    std::copy(packet.begin(), packet.end(),
              transfer.buffer().begin() + static_cast<std::ptrdiff_t>(bytes));
    bytes += packet.size();
    if (packet.size() < pipe.info.max_packet_bytes) break;
  }
  return bytes;
}

void UsbTransfers::serve_control() noexcept {
  if (control_->is_under_way) return;
  const bus::UsbControlRequest* request = mail_->take_control();
  if (request == nullptr) return;
  std::vector<std::uint8_t>& buffer = control_->buffer();
  ::libusb_fill_control_setup(buffer.data(), request->request_type, request->request,
                              request->value, request->index, request->length);
  std::copy_n(request->data.begin(), request->length, buffer.begin() + LIBUSB_CONTROL_SETUP_SIZE);
  control_->raw().length = static_cast<int>(LIBUSB_CONTROL_SETUP_SIZE + request->length);
  if (!submit(*control_)) mail_->finish_control({.outcome = UsbOutcome::Failed});
}

bool UsbTransfers::submit(Transfer& transfer) noexcept {
  transfer.raw().buffer = transfer.buffer().data();
  const int code = ::libusb_submit_transfer(&transfer.raw());
  if (code == LIBUSB_ERROR_NO_DEVICE) mail_->disconnect();
  if (code != 0) return false;
  transfer.is_under_way = true;
  ++under_way_;
  return true;
}

void UsbTransfers::ended(Transfer& transfer) noexcept {
  transfer.is_under_way = false;
  --under_way_;
  const libusb_transfer_status status = transfer.raw().status;
  if (status == LIBUSB_TRANSFER_NO_DEVICE) mail_->disconnect();
  if (is_closing_ || mail_->is_disconnected() || status == LIBUSB_TRANSFER_CANCELLED) return;
  const UsbOutcome outcome = outcome_of(status);
  if (transfer.pipe() == nullptr) return ended_control(transfer, outcome);
  if (bus::is_usb_in(transfer.pipe()->info.address)) return ended_in(transfer, outcome);
  ended_out(transfer, outcome);
}

void UsbTransfers::ended_in(Transfer& transfer, UsbOutcome outcome) noexcept {
  Pipe& pipe = *transfer.pipe();
  const MonotonicTime now = clock_->now();
  const std::span<const std::uint8_t> packet = transfer.swap_buffers();
  const bool goes_on = outcome == UsbOutcome::Done || outcome == UsbOutcome::Babbled;
  if (outcome == UsbOutcome::Stalled && !pipe.is_halted) {
    pipe.is_halted = true;
    pipe.not_before = now + kInputHaltRest;
    for (const std::unique_ptr<Transfer>& other : pipe.transfers) {
      if (other->is_under_way) ::libusb_cancel_transfer(&other->raw());
    }
  }
  if (outcome == UsbOutcome::Failed) {
    pipe.not_before = std::max(pipe.not_before, now + kRetryAfter);
  }
  if (pipe.count_read(now, kRetryAfter) >= kMostReads) pipe.not_before = now + kRetryAfter;
  const bool is_due = now >= pipe.not_before;
  if (goes_on && is_due && !pipe.is_halted && !submit(transfer)) {
    pipe.not_before = now + kRetryAfter;
  }
  if (!mail_->finish_in(pipe.index, outcome, packet, now)) pipe.not_before = now + kRetryAfter;
}

void UsbTransfers::ended_out(Transfer& transfer, UsbOutcome outcome) noexcept {
  Pipe& pipe = *transfer.pipe();
  if (outcome == UsbOutcome::Stalled) pipe.is_halted = true;
  auto taken = static_cast<std::size_t>(std::max(transfer.raw().actual_length, 0));
  // Those behind one that ended badly have not been tried.
  for (auto left = static_cast<std::size_t>(transfer.raw().length); left > 0;) {
    const std::size_t size = std::min(mail_->take_out(pipe.index).size(), left);
    const bool goes_on = size > 0 && size <= taken && size < left;
    mail_->finish_out(pipe.index, goes_on ? UsbOutcome::Done : outcome, std::min(taken, size));
    if (!goes_on) return;
    taken -= size;
    left -= size;
  }
}

void UsbTransfers::ended_control(Transfer& transfer, UsbOutcome outcome) noexcept {
  bus::UsbControlReply reply{.outcome = outcome};
  if (outcome == UsbOutcome::Done) {
    reply.size = std::min(static_cast<std::size_t>(std::max(transfer.raw().actual_length, 0)),
                          reply.data.size());
    if ((transfer.buffer()[0] & bus::kUsbInBit) != 0) {
      std::copy_n(transfer.buffer().begin() + LIBUSB_CONTROL_SETUP_SIZE, reply.size,
                  reply.data.begin());
    }
  }
  mail_->finish_control(reply);
}

void UsbTransfers::cancel_all() noexcept {
  if (control_->is_under_way) ::libusb_cancel_transfer(&control_->raw());
  for (const std::unique_ptr<Pipe>& pipe : pipes_) {
    for (const std::unique_ptr<Transfer>& transfer : pipe->transfers) {
      if (transfer->is_under_way) ::libusb_cancel_transfer(&transfer->raw());
    }
  }
}

// Whether something rests that no event will wake.
bool UsbTransfers::has_to_try_again() const noexcept {
  return std::any_of(pipes_.begin(), pipes_.end(), [](const std::unique_ptr<Pipe>& pipe) {
    if (pipe->is_halted) return pipe->is_idle();
    return bus::is_usb_in(pipe->info.address) &&
           std::any_of(pipe->transfers.begin(), pipe->transfers.end(),
                       [](const auto& transfer) { return !transfer->is_under_way; });
  });
}

UsbTransfers::Woken UsbTransfers::wait(int wake) noexcept {
  std::array<pollfd, kMostDescriptors + 1> polled{};
  std::size_t count = 0;
  polled[count++] = {wake, POLLIN, 0};
  // A node whose device is gone would be ready for ever.
  if (!mail_->is_disconnected()) {
    for (const Watched& watched : watched_) {
      polled[count++] = {watched.descriptor, watched.events, 0};
    }
  }
  const bool is_retry = !mail_->is_disconnected() && has_to_try_again();
  if (::poll(polled.data(), count, is_retry ? kRetryPoll_ms : -1) <= 0) return {};
  Woken woken{.is_signalled = polled[0].revents != 0};
  for (std::size_t i = 1; i < count; ++i) {
    woken.has_events = woken.has_events || polled[i].revents != 0;
    // What usbfs says of a device that is gone, also when no transfer is there to tell: it hangs up
    // at once, and is an error when all drivers have let go of it, which may last.
    if ((polled[i].revents & (POLLERR | POLLHUP)) != 0) mail_->disconnect();
  }
  return woken;
}

void UsbTransfers::send_last() noexcept {
  await_outputs();
  for (const std::unique_ptr<Pipe>& pipe : pipes_) {
    if (!mail_->is_disconnected() && !bus::is_usb_in(pipe->info.address)) serve_pipe(*pipe);
  }
  await_outputs();
}

void UsbTransfers::await_outputs() noexcept {
  const auto is_any_under_way = [&] {
    return std::any_of(pipes_.begin(), pipes_.end(), [](const std::unique_ptr<Pipe>& pipe) {
      return !bus::is_usb_in(pipe->info.address) && !pipe->is_idle();
    });
  };
  for (int i = 0; i < kLastPolls && is_any_under_way(); ++i) {
    handle_events();
    if (is_any_under_way()) ::poll(nullptr, 0, kLastPoll_ms);
  }
}

void UsbTransfers::handle_events() noexcept {
  timeval no_time{};
  ::libusb_handle_events_timeout_completed(context_, &no_time, nullptr);
}

}  // namespace thimble::linux
