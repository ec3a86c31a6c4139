#include "sim/model/cam/register_cam_model.hpp"

#include <memory>

#include "sim/model/cam/cam_usb_model.hpp"

namespace thimble::sim {
namespace {

// Ours: sites for all spaces of the thesis, 512 x 512 and 64 x 64 x 64, twice; a window for all of
// them there, or back, and a table.
const cam::BoardOptions kBoard{.shape = {{2, 2, 2}, 16}, .window_bytes = std::size_t{1} << 21};

}  // namespace

void register_cam_model(plugin::SimModelRegistry& registry) {
  plugin::SimModelEntry entry;
  entry.name = "cam-8";
  entry.description = "CAM board of eight modules, for worlds (USB)";
  entry.create_usb = [](const plugin::SimModelSettings&) {
    return std::make_unique<cam::CamUsbModel>(kBoard);
  };
  registry.add(std::move(entry));
}

}  // namespace thimble::sim
