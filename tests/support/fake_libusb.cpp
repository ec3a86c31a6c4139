// lint: long-file one library, whole
// libusb-1.0 at link level: see fake_libusb.hpp. A program that lists this file among its sources
// never calls the real library.
#include "tests/support/fake_libusb.hpp"

#include <fcntl.h>
#include <libusb.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <utility>

struct libusb_context {
  thimble::test::FakeUsbWire* wire{nullptr};
  bool is_in_callback{false};
};
struct libusb_device_handle {
  libusb_context* context{nullptr};
  thimble::test::FakeUsbWire* wire{nullptr};
  bool is_detaching{false};
  bool has_detached{false};
};

namespace thimble::test {

struct FakeLibusb {
  std::recursive_mutex lock;
  std::map<int, FakeUsbWire*> nodes;
  std::map<std::pair<dev_t, ino_t>, FakeUsbWire*> files;
  int alive{0};

  static FakeLibusb& instance() {
    static FakeLibusb fake;
    return fake;
  }

  static int submit(FakeUsbWire& wire, libusb_transfer& transfer) {
    if (wire.is_gone_) return LIBUSB_ERROR_NO_DEVICE;
    if (wire.submissions_to_refuse_ > 0) {
      --wire.submissions_to_refuse_;
      return LIBUSB_ERROR_NO_MEM;
    }
    if (wire.is_pending(transfer)) wire.breach("a transfer was submitted twice");
    if (transfer.timeout != 0) wire.breach("a transfer has a time-out");
    if (transfer.callback == nullptr) wire.breach("a transfer has no callback");
    for (const bus::UsbEndpointInfo& endpoint : wire.info_.endpoints) {
      if (endpoint.address != transfer.endpoint || !bus::is_usb_in(endpoint.address)) continue;
      if (transfer.length % endpoint.max_packet_bytes != 0) wire.breach("a read is no packet long");
    }
    transfer.actual_length = 0;
    wire.pending_.push_back(&transfer);
    return 0;
  }

  static int cancel(FakeUsbWire& wire, libusb_transfer& transfer) {
    if (!wire.is_pending(transfer)) return LIBUSB_ERROR_NOT_FOUND;
    wire.cancelled_.push_back(&transfer);
    ::eventfd_write(wire.event_, 1);
    return 0;
  }

  static int clear_halt(libusb_device_handle& handle, std::uint8_t endpoint) {
    FakeUsbWire& wire = *handle.wire;
    if (wire.is_gone_) return LIBUSB_ERROR_NO_DEVICE;
    if (handle.context->is_in_callback) wire.breach("a halt was cleared within a callback");
    wire.outputs_at_last_clearing_ = 0;
    for (const libusb_transfer* transfer : wire.pending_) {
      if (transfer->endpoint == endpoint) wire.breach("a halt was cleared under a transfer");
      if (transfer->endpoint != 0 && !bus::is_usb_in(transfer->endpoint)) {
        ++wire.outputs_at_last_clearing_;
      }
    }
    wire.halted_.erase(endpoint);
    ++wire.halts_cleared_;
    return 0;
  }

  static void handle_events(libusb_context& context) {
    if (context.wire == nullptr) return;
    FakeUsbWire& wire = *context.wire;
    if (wire.is_run_by_events_) wire.run_frame();
    eventfd_t events = 0;
    ::eventfd_read(wire.event_, &events);
    // Not at once: the kernel gives a cancelled transfer back in its own time.
    const std::vector<libusb_transfer*> cancelled = std::exchange(wire.cancelled_, {});
    for (libusb_transfer* transfer : cancelled) {
      if (wire.is_pending(*transfer)) wire.end(*transfer, LIBUSB_TRANSFER_CANCELLED, 0);
    }
    context.is_in_callback = true;
    while (!wire.ended_.empty()) {
      libusb_transfer* transfer = wire.ended_.front();
      wire.ended_.pop_front();
      transfer->callback(transfer);
    }
    context.is_in_callback = false;
  }

  static void close(libusb_device_handle& handle) {
    for (const libusb_transfer* transfer : handle.wire->pending_) {
      if (transfer->dev_handle == &handle) handle.wire->breach("closed with transfers under way");
    }
    handle.context->wire = nullptr;
  }

  static int claim(libusb_device_handle& handle) {
    FakeUsbWire& wire = *handle.wire;
    if (wire.is_gone_) return LIBUSB_ERROR_NO_DEVICE;
    if (wire.is_claimed_) return LIBUSB_ERROR_BUSY;
    if (wire.is_kernel_driver_bound_ && !handle.is_detaching) return LIBUSB_ERROR_BUSY;
    handle.has_detached = std::exchange(wire.is_kernel_driver_bound_, false);
    wire.is_claimed_ = true;
    ++instance().alive;
    return 0;
  }

  static void release(libusb_device_handle& handle) {
    handle.wire->is_claimed_ = false;
    handle.wire->is_kernel_driver_bound_ = std::exchange(handle.has_detached, false);
    --instance().alive;
  }

  FakeUsbWire* wire_at(int node) {
    if (nodes.contains(node)) return nodes[node];
    struct stat file {};
    const bool is_there = ::fstat(node, &file) == 0;
    const auto found = is_there ? files.find({file.st_dev, file.st_ino}) : files.end();
    return found == files.end() ? nullptr : found->second;
  }

  static int event_of(const libusb_context& context) { return context.wire->event_; }
  static int device_of(const libusb_context& context) { return context.wire->device_[0]; }
};

namespace {

using Guard = std::lock_guard<std::recursive_mutex>;
FakeLibusb& fake() { return FakeLibusb::instance(); }

}  // namespace

FakeUsbWire::FakeUsbWire(std::unique_ptr<plugin::SimUsbModel> model)
    : model_(std::move(model)),
      info_(model_->describe()),
      event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  static_cast<void>(::pipe2(device_.data(), O_CLOEXEC));
}

FakeUsbWire::~FakeUsbWire() {
  const Guard guard(fake().lock);
  const auto leads_here = [this](const auto& node) { return node.second == this; };
  std::erase_if(fake().nodes, leads_here);
  std::erase_if(fake().files, leads_here);
  ::close(event_);
  for (const int end : device_) {
    if (end >= 0) ::close(end);
  }
}

void FakeUsbWire::hang_up() {
  const Guard guard(fake().lock);
  ::close(std::exchange(device_[1], -1));
}

int FakeUsbWire::open_node() {
  const Guard guard(fake().lock);
  const int node = ::eventfd(0, EFD_CLOEXEC);
  fake().nodes[node] = this;
  return node;
}

void FakeUsbWire::attach(const std::string& path) {
  const Guard guard(fake().lock);
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return;
  fake().files.insert_or_assign({file.st_dev, file.st_ino}, this);
}

void FakeUsbWire::run_frame() {
  const Guard guard(fake().lock);
  now_ = now_ + std::chrono::milliseconds(1);
  model_->advance(now_);
  const std::vector<libusb_transfer*> offered = pending_;
  for (libusb_transfer* transfer : offered) {
    if (is_pending(*transfer) && !halted_.contains(transfer->endpoint)) serve(*transfer);
  }
}

void FakeUsbWire::serve(libusb_transfer& transfer) {
  const auto length = static_cast<std::size_t>(transfer.length);
  plugin::UsbAnswer answer;
  if (transfer.type == LIBUSB_TRANSFER_TYPE_CONTROL) {
    bus::UsbControlRequest request;
    request.request_type = transfer.buffer[0];
    request.request = transfer.buffer[1];
    request.value = static_cast<std::uint16_t>(transfer.buffer[2] + 256 * transfer.buffer[3]);
    request.index = static_cast<std::uint16_t>(transfer.buffer[4] + 256 * transfer.buffer[5]);
    request.length = static_cast<std::uint16_t>(transfer.buffer[6] + 256 * transfer.buffer[7]);
    std::uint8_t* data = transfer.buffer + LIBUSB_CONTROL_SETUP_SIZE;
    const bool is_in = bus::asks_for_data(request);
    if (!is_in) std::copy_n(data, request.length, request.data.begin());
    answer = model_->control(request, {data, is_in ? request.length : std::size_t{0}});
    if (!is_in) answer.size = request.length;
    if (answer.size > request.length) return end(transfer, LIBUSB_TRANSFER_OVERFLOW, 0);
  } else if (!bus::is_usb_in(transfer.endpoint)) {
    return serve_out(transfer);
  } else if (reads_to_spoil_ > 0) {
    --reads_to_spoil_;
    return end(transfer, LIBUSB_TRANSFER_ERROR, 0);
  } else {
    answer = model_->in_packet(transfer.endpoint, {transfer.buffer, length});
    if (answer.size > length) return end(transfer, LIBUSB_TRANSFER_OVERFLOW, transfer.length);
  }
  if (answer.handshake == plugin::UsbHandshake::Nak) return;
  if (answer.handshake == plugin::UsbHandshake::Ack) {
    return end(transfer, LIBUSB_TRANSFER_COMPLETED, static_cast<int>(answer.size));
  }
  if (transfer.endpoint != 0) halted_.insert(transfer.endpoint);
  end(transfer, LIBUSB_TRANSFER_STALL, 0);
}

void FakeUsbWire::serve_out(libusb_transfer& transfer) {
  const auto endpoint = std::find_if(
      info_.endpoints.begin(), info_.endpoints.end(),
      [&](const bus::UsbEndpointInfo& info) { return info.address == transfer.endpoint; });
  for (int i = 0; i < kMostPacketsInFrame && transfer.actual_length < transfer.length; ++i) {
    const int rest = transfer.length - transfer.actual_length;
    const int size = std::min<int>(rest, endpoint->max_packet_bytes);
    const plugin::UsbHandshake handshake = model_->out_packet(
        transfer.endpoint,
        {transfer.buffer + transfer.actual_length, static_cast<std::size_t>(size)});
    if (handshake == plugin::UsbHandshake::Nak) return;
    if (handshake == plugin::UsbHandshake::Stall) {
      halted_.insert(transfer.endpoint);
      return end(transfer, LIBUSB_TRANSFER_STALL, transfer.actual_length);
    }
    transfer.actual_length += size;
  }
  if (transfer.actual_length < transfer.length) return;
  end(transfer, LIBUSB_TRANSFER_COMPLETED, transfer.length);
}

void FakeUsbWire::end(libusb_transfer& transfer, int status, int actual_bytes) {
  std::erase(pending_, &transfer);
  transfer.status = static_cast<libusb_transfer_status>(status);
  transfer.actual_length = actual_bytes;
  ended_.push_back(&transfer);
  ::eventfd_write(event_, 1);
}

bool FakeUsbWire::is_pending(const libusb_transfer& transfer) const {
  return std::find(pending_.begin(), pending_.end(), &transfer) != pending_.end();
}

void FakeUsbWire::unplug() {
  const Guard guard(fake().lock);
  is_gone_ = true;
  while (!pending_.empty()) end(*pending_.front(), LIBUSB_TRANSFER_NO_DEVICE, 0);
}

void FakeUsbWire::run_frames_by_events() {
  const Guard guard(fake().lock);
  is_run_by_events_ = true;
}

void FakeUsbWire::spoil_next_reads(int reads) {
  const Guard guard(fake().lock);
  reads_to_spoil_ = reads;
}

void FakeUsbWire::refuse_next_submissions(int submissions) {
  const Guard guard(fake().lock);
  submissions_to_refuse_ = submissions;
}

std::vector<std::string> FakeUsbWire::breaches() const {
  const Guard guard(fake().lock);
  return breaches_;
}

int FakeUsbWire::alive() {
  const Guard guard(fake().lock);
  return fake().alive;
}

std::size_t FakeUsbWire::pending() const {
  const Guard guard(fake().lock);
  return pending_.size();
}

int FakeUsbWire::halts_cleared() const {
  const Guard guard(fake().lock);
  return halts_cleared_;
}

std::size_t FakeUsbWire::outputs_at_last_clearing() const {
  const Guard guard(fake().lock);
  return outputs_at_last_clearing_;
}

}  // namespace thimble::test

using thimble::test::fake;
using thimble::test::FakeLibusb;
using thimble::test::Guard;

extern "C" {

int libusb_set_option(libusb_context* /*context*/, enum libusb_option /*option*/, ...) { return 0; }

int libusb_init(libusb_context** context) {
  const Guard guard(fake().lock);
  *context = new libusb_context;
  ++fake().alive;
  return 0;
}

void libusb_exit(libusb_context* context) {
  const Guard guard(fake().lock);
  delete context;
  --fake().alive;
}

int libusb_wrap_sys_device(libusb_context* context, intptr_t node, libusb_device_handle** handle) {
  const Guard guard(fake().lock);
  auto* const wire = fake().wire_at(static_cast<int>(node));
  if (wire == nullptr) return LIBUSB_ERROR_NO_DEVICE;
  context->wire = wire;
  *handle = new libusb_device_handle{.context = context, .wire = wire};
  ++fake().alive;
  return 0;
}

void libusb_close(libusb_device_handle* handle) {
  const Guard guard(fake().lock);
  FakeLibusb::close(*handle);
  delete handle;
  --fake().alive;
}

int libusb_set_auto_detach_kernel_driver(libusb_device_handle* handle, int enable) {
  const Guard guard(fake().lock);
  handle->is_detaching = enable != 0;
  return 0;
}

int libusb_claim_interface(libusb_device_handle* handle, int /*interface_number*/) {
  const Guard guard(fake().lock);
  return FakeLibusb::claim(*handle);
}

int libusb_release_interface(libusb_device_handle* handle, int /*interface_number*/) {
  const Guard guard(fake().lock);
  FakeLibusb::release(*handle);
  return 0;
}

struct libusb_transfer* libusb_alloc_transfer(int /*iso_packets*/) {
  const Guard guard(fake().lock);
  ++fake().alive;
  return new libusb_transfer{};
}

void libusb_free_transfer(struct libusb_transfer* transfer) {
  const Guard guard(fake().lock);
  if (transfer == nullptr) return;
  delete transfer;
  --fake().alive;
}

int libusb_submit_transfer(struct libusb_transfer* transfer) {
  const Guard guard(fake().lock);
  return FakeLibusb::submit(*transfer->dev_handle->wire, *transfer);
}

int libusb_cancel_transfer(struct libusb_transfer* transfer) {
  const Guard guard(fake().lock);
  return FakeLibusb::cancel(*transfer->dev_handle->wire, *transfer);
}

int libusb_clear_halt(libusb_device_handle* handle, unsigned char endpoint) {
  const Guard guard(fake().lock);
  return FakeLibusb::clear_halt(*handle, endpoint);
}

int libusb_handle_events_timeout_completed(libusb_context* context, struct timeval* /*timeout*/,
                                           int* /*completed*/) {
  const Guard guard(fake().lock);
  FakeLibusb::handle_events(*context);
  return 0;
}

const struct libusb_pollfd** libusb_get_pollfds(libusb_context* context) {
  const Guard guard(fake().lock);
  auto* pollfds = new const libusb_pollfd* [3] {};
  pollfds[0] = new libusb_pollfd{FakeLibusb::event_of(*context), POLLIN};
  pollfds[1] = new libusb_pollfd{FakeLibusb::device_of(*context), POLLOUT};
  return pollfds;
}

void libusb_free_pollfds(const struct libusb_pollfd** pollfds) {
  if (pollfds == nullptr) return;
  delete pollfds[0];
  delete pollfds[1];
  delete[] pollfds;
}

const char* libusb_error_name(int code) {
  return code == LIBUSB_ERROR_BUSY ? "LIBUSB_ERROR_BUSY" : "LIBUSB_ERROR_OTHER";
}

}  // extern "C"
