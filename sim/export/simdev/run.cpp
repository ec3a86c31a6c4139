#include "sim/export/simdev/run.hpp"

#include <fcntl.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hal/linux/monotonic_clock.hpp"
#include "hal/linux/system_error.hpp"
#include "hal/plugin/plugin_file.hpp"
#include "hal/plugin/plugin_loader.hpp"
#include "hal/plugin/sim_model.hpp"
#include "sim/bus/sim_usb_port.hpp"
#include "sim/export/acm_on_usb.hpp"
#include "sim/export/device_verbs.hpp"
#include "sim/export/hid_on_usb.hpp"
#include "sim/export/plug_pace.hpp"
#include "sim/export/uhid_plug.hpp"
#include "sim/export/usbip_plug.hpp"
#include "sim/export/verb_server.hpp"
#include "sim/export/vhci_controller.hpp"
#include "sim/export/vhci_plug.hpp"
#include "sim/model/arm/register_arm_models.hpp"
#include "sim/model/arm/text_arm_model.hpp"
#include "sim/model/cam/register_cam_model.hpp"
#include "sim/model/cp2112/cp2112_model.hpp"
#include "sim/model/falcon/register_falcon_model.hpp"
#include "sim/model/spacemouse/register_spacemouse_models.hpp"

namespace thimble::sim {
namespace {

constexpr const char* kUhidNode = "/dev/uhid";

// Of the drivers that they bring nobody asks here.
Result<void> add_plugins(const std::vector<std::string>& files, plugin::SimModelRegistry& models) {
  plugin::DriverRegistry drivers;
  for (const std::string& file : files) {
    const Result<std::string> path = plugin::absolute_plugin_path(file);
    if (!path) return tl::unexpected(path.error());
    const Result<const thimble_plugin*> loaded = plugin::load_plugin(*path);
    if (!loaded) return tl::unexpected(loaded.error());
    const Result<void> added = plugin::register_plugin(**loaded, drivers, models);
    if (!added) return tl::unexpected(added.error().in(*path));
  }
  return {};
}

Result<plugin::SimModel> make_model(const SimdevOptions& options) {
  plugin::SimModelRegistry models;
  register_arm_models(models);
  register_text_arm_models(models);
  register_falcon_model(models);
  register_spacemouse_models(models);
  register_cam_model(models);
  models.add({"cp2112", "Silicon Labs CP2112, eight lines (HID)",
              [](const plugin::SimModelSettings&) { return std::make_unique<Cp2112Model>(); }});
  if (Result<void> added = add_plugins(options.plugins, models); !added) {
    return tl::unexpected(added.error());
  }
  const plugin::SimModelEntry* entry = models.find(options.model);
  if (entry == nullptr) {
    std::string known;
    for (const plugin::SimModelEntry& model : models.entries()) {
      known += " " + model.name;
    }
    return fail(Errc::InvalidArgument,
                "no simulated device " + options.model + "; there are:" + known);
  }
  return entry->create({.amplifier_max_a = options.amplifier_max_a, .seed = options.seed});
}

Result<linux::Descriptor> open_uhid() {
  linux::Descriptor node(::open(kUhidNode, O_RDWR | O_CLOEXEC | O_NONBLOCK));
  if (node.get() < 0) {
    return tl::unexpected(
        linux::system_error(std::string(kUhidNode) + " cannot be opened (modprobe uhid?)", errno));
  }
  return node;
}

PlugPace::Grain grain_of(const SimdevOptions& options) {
  const Duration slice =
      options.slices_per_frame == 0 ? Duration(0) : kUsbFrame / options.slices_per_frame;
  return {.at_once = options.frames_at_once * kUsbFrame, .slice = slice};
}

// All that one device needs, in the order in which it may go.
class Simdev {
 public:
  Simdev(plugin::SimModel model, const SimdevOptions& options)
      : misbehaviour_(options.seed), model_(std::move(model)), info_(plugin::describe(model_)) {
    // Whatever the model calls itself, this is how it was asked for.
    info_.address = {std::string(bus::kSimScheme) + options.model};
    if (!options.serial_number.empty()) info_.serial_number = options.serial_number;
    signals_.async_wait([this](auto, int) { is_over_ = true; });
  }

  Result<void> plug_in(const SimdevOptions& options) {
    plugin::SimHidModel* hid = face<plugin::SimHidModel>();
    if (hid != nullptr) panel_ = hid->panel();
    if (auto* usb = face<plugin::SimUsbModel>()) panel_ = usb->panel();
    return options.is_uhid ? offer_through_uhid(hid) : offer_as_usb(options);
  }
  Result<void> take_verbs_at(const std::string& path) {
    verbs_ = std::make_unique<DeviceVerbs>(
        info_, *plug_, DeviceVerbs::Faces{plugin::arm_backend(model_), panel_}, surroundings());
    if (path.empty()) return {};
    auto server = VerbServer::listen(
        io_, path, [this](std::string_view line) { return verbs_->execute(line); });
    if (!server) return tl::unexpected(server.error());
    server_ = *std::move(server);
    return {};
  }
  // Until a signal, or until the kernel let go of it.
  void run(PlugPace::Grain grain) {
    // A device may have longer frames of its own.
    if (grain.at_once <= plug_->round_period()) grain.at_once = {};
    PlugPace pace(clock_, machine_, *plug_, grain);
    while (!is_over_ && !plug_->is_broken()) {
      pace.run_next();
      io_.poll_one();  // one piece of a reply, and the next frame is due
    }
    server_.reset();
  }
  [[nodiscard]] const std::string& way() const noexcept { return way_; }
  [[nodiscard]] const bus::BusDeviceInfo& info() const noexcept { return info_; }

 private:
  Result<void> offer_through_uhid(plugin::SimHidModel* hid) {
    if (hid == nullptr) {
      return fail(Errc::InvalidArgument, info_.address.text + " is no HID device");
    }
    Result<linux::Descriptor> node = open_uhid();
    if (!node) return tl::unexpected(node.error());
    way_ = "through uhid";
    plug_ = std::make_unique<UhidPlug>(*std::move(node), *hid, info_, surroundings());
    return plug_->plug();
  }
  Result<void> offer_as_usb(const SimdevOptions& options) {
    UsbPersona persona{info_, {}};
    plugin::SimUsbModel* usb = face<plugin::SimUsbModel>();
    const auto wrap = [&](auto wrapped) {
      persona = wrapped->persona(info_);
      usb = wrapped.get();
      wrapped_ = std::move(wrapped);
    };
    if (auto* hid = face<plugin::SimHidModel>()) wrap(std::make_unique<HidOnUsb>(*hid));
    if (auto* serial = face<plugin::SimSerialModel>()) wrap(std::make_unique<AcmOnUsb>(*serial));
    return options.usbip_port ? listen_for_usbip(*options.usbip_port, *usb, std::move(persona))
                              : plug_into_vhci(*usb, std::move(persona));
  }
  Result<void> plug_into_vhci(plugin::SimUsbModel& usb, UsbPersona persona) {
    way_ = "as a USB device";
    plug_ = std::make_unique<VhciPlug>(
        io_, usb, std::move(persona), surroundings(),
        [](int socket, std::uint32_t id) { return VhciController().attach(socket, id); });
    return plug_->plug();
  }
  Result<void> listen_for_usbip(std::uint16_t port, plugin::SimUsbModel& usb, UsbPersona persona) {
    auto plug = UsbipPlug::listen(io_, port, usb, std::move(persona), surroundings());
    if (!plug) return tl::unexpected(plug.error());
    way_ = "over USB/IP at port " + std::to_string((*plug)->port());
    plug_ = *std::move(plug);
    return plug_->plug();
  }
  // nullptr: it has another one.
  template <class Face>
  [[nodiscard]] Face* face() noexcept {
    auto* model = std::get_if<std::unique_ptr<Face>>(&model_);
    return model == nullptr ? nullptr : model->get();
  }
  [[nodiscard]] PlugSurroundings surroundings() noexcept {
    return {&clock_, &machine_, &log_, &misbehaviour_};
  }

  linux::MonotonicClock machine_;
  VirtualClock clock_;
  boost::asio::io_context io_;
  // From the beginning on: who has read that it is plugged in may end it at once.
  boost::asio::signal_set signals_{io_, SIGTERM, SIGINT};
  bool is_over_{false};
  ModelLog log_;
  Misbehaviour misbehaviour_;
  plugin::SimModel model_;
  bus::BusDeviceInfo info_;
  plugin::ModelPanel* panel_{nullptr};
  std::string way_;                               // to the kernel
  std::unique_ptr<plugin::SimUsbModel> wrapped_;  // on USB/IP, what is no bare USB device
  std::unique_ptr<Plug> plug_;
  std::unique_ptr<DeviceVerbs> verbs_;
  std::unique_ptr<VerbServer> server_;
};

}  // namespace

Result<void> run_simdev(const SimdevOptions& options) {
  if (int{options.is_uhid} + int{options.is_vhci} + int{options.usbip_port.has_value()} != 1) {
    return fail(Errc::InvalidArgument,
                "say how it is to be offered: --uhid, --vhci, or --usbip PORT");
  }
  Result<plugin::SimModel> model = make_model(options);
  if (!model) return tl::unexpected(model.error());
  Simdev device(*std::move(model), options);
  Result<void> done = device.plug_in(options);
  if (done) done = device.take_verbs_at(options.socket);
  if (!done) return done;
  std::printf("thimble-simdev: %s is plugged in %s, serial number %s\n",
              device.info().address.text.c_str(), device.way().c_str(),
              device.info().serial_number.c_str());
  std::fflush(stdout);
  device.run(grain_of(options));
  return {};
}

}  // namespace thimble::sim
