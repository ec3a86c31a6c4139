#pragma once

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "hal/plugin/plugin_abi.h"

namespace thimble::plugin {

// What a plugin in this program does, as the test says, and what it was asked. Its tables reach it
// through `device`; match() and open() through the settings' model, which holds its address.
struct PluginScript {
  std::int32_t match = THIMBLE_OK;
  std::int32_t open = THIMBLE_OK;
  bool gives_device = true;
  std::string reason;
  std::function<void(thimble_capabilities&)> capabilities = [](thimble_capabilities&) {};
  std::int32_t decode = THIMBLE_OK;
  std::function<void(const thimble_hid_report&, thimble_sample&)> sample =
      [](const thimble_hid_report&, thimble_sample&) {};
  std::int32_t encode = THIMBLE_OK;

  std::vector<thimble_hid_report> decoded;
  std::vector<double> forces_x;
  int closed = 0;
  int forgotten = 0;

  // To be put into DriverSettings::model.
  [[nodiscard]] std::string address() const {
    return std::to_string(reinterpret_cast<std::uintptr_t>(this));
  }
};

inline PluginScript& script_at(const thimble_driver_settings& settings) {
  return *reinterpret_cast<PluginScript*>(std::stoull(settings.model));
}
inline PluginScript& script_of(void* device) { return *static_cast<PluginScript*>(device); }

inline thimble_driver scripted_driver() {
  thimble_driver driver{};
  driver.struct_bytes = sizeof(driver);
  std::strcpy(driver.name, "scripted");
  driver.match = [](const thimble_hid_info* info, const thimble_driver_settings* settings,
                    thimble_reason* reason) {
    if (info->vendor_id != 0x1234) return std::int32_t{THIMBLE_NOT_MINE};
    std::strcpy(reason->text, script_at(*settings).reason.c_str());
    return script_at(*settings).match;
  };
  driver.open = [](const thimble_hid_info*, const thimble_driver_settings* settings,
                   thimble_capabilities* capabilities, void** device, thimble_reason* reason) {
    PluginScript& script = script_at(*settings);
    std::strcpy(capabilities->model, "arm");
    std::strcpy(capabilities->calibration_instruction, "Press the button");
    capabilities->joint_count = 3;
    capabilities->peak_force_newton = 5;
    capabilities->continuous_force_newton = 2;
    capabilities->max_stiffness_newton_per_m = 1000;
    capabilities->workspace_radius_m = 0.1;
    for (double& current_a : capabilities->peak_current_a) current_a = 3;
    for (double& current_a : capabilities->continuous_current_a) current_a = 1;
    capabilities->sample_period_ns = 1'000'000;
    script.capabilities(*capabilities);
    std::strcpy(reason->text, script.reason.c_str());
    *device = script.gives_device ? &script : nullptr;
    return script.open;
  };
  driver.close = [](void* device) { ++script_of(device).closed; };
  driver.forget_calibration = [](void* device) { ++script_of(device).forgotten; };
  driver.decode = [](void* device, const thimble_hid_report* report, thimble_sample* sample) {
    PluginScript& script = script_of(device);
    script.decoded.push_back(*report);
    sample->calibration = THIMBLE_CALIBRATION_DONE;
    for (int i = 0; i < 3; ++i) sample->motor_current_a_per_newton[i][i] = 0.4;
    script.sample(*report, *sample);
    return script.decode;
  };
  driver.encode = [](void* device, const thimble_wrench* wrench, std::uint8_t* bytes) {
    script_of(device).forces_x.push_back(wrench->force_newton[0]);
    bytes[0] = 0xAB;
    return script_of(device).encode;
  };
  return driver;
}

}  // namespace thimble::plugin
