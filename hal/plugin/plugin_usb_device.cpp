#include "hal/plugin/plugin_usb_device.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "hal/plugin/abi_status.hpp"
#include "hal/plugin/plugin_check.hpp"
#include "hal/plugin/sample_state.hpp"

namespace thimble::plugin {
namespace {

static_assert(THIMBLE_PACKET_BYTES == bus::kMaxUsbPacketBytes);
static_assert(THIMBLE_CONTROL_BYTES == bus::kMaxUsbControlBytes);

bus::UsbDevice& pipes(void* context) noexcept {
  return static_cast<PluginUsbBus*>(context)->below();
}

std::int32_t read_packet(void* context, std::uint8_t endpoint, thimble_usb_packet* out) {
  bus::UsbPacket packet;
  const IoStatus status = pipes(context).read(endpoint, packet);
  if (status != IoStatus::Ok) return abi_status(status);
  static_cast<PluginUsbBus*>(context)->note(packet.arrived_at);
  out->struct_bytes = sizeof(*out);
  out->size = static_cast<std::uint32_t>(packet.size);
  out->arrived_at_ns = packet.arrived_at.since_epoch.count();
  out->sequence = packet.sequence;
  std::copy_n(packet.bytes.begin(), packet.size, out->bytes);
  return THIMBLE_OK;
}

std::int32_t submit_packet(void* context, std::uint8_t endpoint, const std::uint8_t* bytes,
                           std::uint32_t size) {
  if (bytes == nullptr) return THIMBLE_PROTOCOL_ERROR;
  return abi_status(pipes(context).submit(endpoint, {bytes, size}));
}

std::int32_t start_control(void* context, const thimble_usb_request* said) {
  bus::UsbControlRequest request;
  request.request_type = said->request_type;
  request.request = said->request;
  request.value = said->value;
  request.index = said->index;
  request.length = said->length;
  std::copy_n(said->data, THIMBLE_CONTROL_BYTES, request.data.begin());
  return abi_status(pipes(context).start_control(request));
}

std::int32_t read_control(void* context, thimble_usb_reply* out) {
  bus::UsbControlReply reply;
  const IoStatus status = pipes(context).read_control(reply);
  if (status != IoStatus::Ok) return abi_status(status);
  out->struct_bytes = sizeof(*out);
  out->outcome = static_cast<std::int32_t>(reply.outcome);
  out->size = static_cast<std::uint32_t>(reply.size);
  std::copy(reply.data.begin(), reply.data.end(), out->data);
  return THIMBLE_OK;
}

}  // namespace

PluginUsbBus::PluginUsbBus(std::unique_ptr<bus::UsbDevice> below) : below_(std::move(below)) {
  table_.struct_bytes = sizeof(table_);
  table_.context = this;
  table_.read = &read_packet;
  table_.submit = &submit_packet;
  table_.start_control = &start_control;
  table_.read_control = &read_control;
}

// A plugin may close without a zero, and may take an arm for gone that is there.
PluginUsbDevice::~PluginUsbDevice() {
  if (may_hold_force_) static_cast<void>(submit_zero());
  parts_.driver->close(parts_.device);
  // The newest wins, and that may have been one of the plugin's.
  if (may_hold_force_) static_cast<void>(submit_zero());
}

// False: the plugin named none, or it waits.
bool PluginUsbDevice::submit_zero() noexcept {
  if (!parts_.zero) return false;
  bus::UsbDevice& below = parts_.bus->below();
  return below.submit(parts_.zero->endpoint, std::span(parts_.zero->bytes)) == IoStatus::Ok;
}

// Of an arm that is gone nobody would take the force away. So a plugin is believed when its bus
// says the same, or when there is no force to be taken: it may have given up an arm that is there
// and does not answer, which is opened anew then.
bool PluginUsbDevice::is_gone() noexcept {
  // To no pipe: the bus says whether it is there, and sends nothing.
  const bool says_bus = parts_.bus->below().submit(0, {}) == IoStatus::Disconnected;
  if (says_bus || !may_hold_force_ || !parts_.zero) return true;
  if (submit_zero() && ++zeros_taken_ >= kOksOfAZeroThatArrived) may_hold_force_ = false;
  return !may_hold_force_;
}

std::string_view PluginUsbDevice::calibration_instruction() const noexcept {
  instruction_ = {};
  parts_.driver->read_instruction(parts_.device, &instruction_);
  const char* const end =
      std::find(instruction_.text, instruction_.text + THIMBLE_TEXT_BYTES, '\0');
  // Whatever a terminal would take for more than a letter is shown as a question mark.
  std::replace_if(
      instruction_.text, instruction_.text + (end - instruction_.text),
      [](char c) { return c < ' ' || c > '~'; }, '?');
  return {instruction_.text, static_cast<std::size_t>(end - instruction_.text)};
}

DeviceCounters PluginUsbDevice::counters() const noexcept {
  DeviceCounters out;
  out.malformed = malformed_.load(std::memory_order_relaxed);
  const thimble_usb_claim& claim = parts_.driver->claim;
  for (std::size_t i = 0; i < claim.pipe_count; ++i) {
    const bus::UsbCounters on_bus = parts_.bus->below().counters(claim.pipes[i].endpoint);
    out.reports_in += on_bus.packets_in;
    out.reports_skipped += on_bus.packets_skipped;
    out.commands_out += on_bus.packets_out;
    out.commands_superseded += on_bus.writes_superseded;
  }
  return out;
}

void PluginUsbDevice::forget_calibration() noexcept {
  calibration_.store(CalibrationState::Unknown, std::memory_order_relaxed);
  is_done_doubted_ = true;
  parts_.driver->forget_calibration(parts_.device);
}

IoStatus PluginUsbDevice::status_of(std::int32_t said) noexcept {
  IoStatus status = io_status(said);
  if (status == IoStatus::Disconnected && !is_gone()) status = IoStatus::ProtocolError;
  if (status == IoStatus::ProtocolError) malformed_.fetch_add(1, std::memory_order_relaxed);
  return status;
}

bool PluginUsbDevice::is_credible(const thimble_usb_sample& sample) const noexcept {
  const MonotonicTime at{Duration(sample.sampled_at_ns)};
  return is_sound(sample.state) && sample.sequence > last_sequence_ && at <= parts_.bus->newest();
}

IoStatus PluginUsbDevice::read(HapticState& out) noexcept {
  thimble_usb_sample sample{};
  sample.state.struct_bytes = sizeof(sample.state);
  const IoStatus status = status_of(parts_.driver->read(parts_.device, &sample));
  if (status == IoStatus::Disconnected) forget_calibration();
  if (status == IoStatus::Backlogged) return IoStatus::NoData;  // no answer to a read
  if (status != IoStatus::Ok) return status;
  if (!is_credible(sample)) {
    forget_calibration();
    return status_of(THIMBLE_PROTOCOL_ERROR);
  }
  last_sequence_ = sample.sequence;
  doubt_calibration(sample.state, is_done_doubted_);
  copy_sample(sample.state, parts_.capabilities.joint_count, out);
  out.sampled_at = {Duration(sample.sampled_at_ns)};
  out.sample_sequence = sample.sequence;
  calibration_.store(out.calibration, std::memory_order_relaxed);
  return IoStatus::Ok;
}

IoStatus PluginUsbDevice::write(const LimitedWrench& wrench) noexcept {
  const bool is_calibrated = calibration_.load(std::memory_order_relaxed) == CalibrationState::Ok;
  const Force3 force = is_calibrated ? wrench.force() : Force3{};
  const thimble_wrench limited{sizeof(thimble_wrench), 0, {force.x, force.y, force.z}};
  if (force != Force3{}) {
    may_hold_force_ = true;
    zeros_taken_ = 0;
  }
  const IoStatus status = status_of(parts_.driver->write(parts_.device, &limited));
  return status == IoStatus::NoData ? IoStatus::Ok : status;
}

}  // namespace thimble::plugin
