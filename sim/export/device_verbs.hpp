#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/sim_model.hpp"
#include "sim/export/export_hand.hpp"
#include "sim/export/plug.hpp"
#include "sim/export/verb.hpp"

namespace thimble::sim {

// Does to a model that hangs on a kernel what a person could do to a device, and tells what the
// model felt.
//
// Thread: that which runs the model's clock, between two runs of it. Not RT.
// Ownership: plug, faces and surroundings must outlive it; its hand holds the arm's tip.
class DeviceVerbs {
 public:
  struct Faces {
    plugin::ArmBackend* arm{nullptr};    // nullptr: it is no arm
    plugin::ModelPanel* panel{nullptr};  // nullptr: it has none
  };
  DeviceVerbs(bus::BusDeviceInfo info, Plug& plug, const Faces& faces,
              const PlugSurroundings& surroundings);

  // One line of a verb, any bytes. The reply comes in pieces, so that a long one does not hold up
  // the device: each call gives the next one, an empty one is the end. It is lines, the last of
  // which is {"ok":true,…} or {"ok":false,"error":"…"}; only `log` has others before it. This must
  // outlive the reply.
  using Reply = std::function<std::string()>;
  [[nodiscard]] Reply execute(std::string_view line);
  // Ours: a few kilobytes, made in well under a frame.
  static constexpr std::size_t kLogLinesOfAPiece = 32;

 private:
  [[nodiscard]] Result<void> apply(const Verb& verb);
  [[nodiscard]] Result<void> apply_to_arm(const Verb& verb);
  [[nodiscard]] Result<void> press(const Verb& verb);
  [[nodiscard]] Result<void> set_fault(const std::string& name, std::uint32_t number);
  [[nodiscard]] Result<void> halt(std::uint32_t transfers);
  [[nodiscard]] std::string status() const;
  [[nodiscard]] std::string felt(const Verb& verb) const;
  [[nodiscard]] Reply log_of_last(Duration duration) const;

  bus::BusDeviceInfo info_;
  Plug* plug_;
  Faces faces_;
  PlugSurroundings around_;
  std::optional<ExportHand> hand_;
};

}  // namespace thimble::sim
