#include <utility>

#include "daemon/link/in_process_link.hpp"
#include "daemon/session/arm_settings.hpp"
#include "daemon/session/rig_link.hpp"

namespace thimble::session {
namespace {

class InProcessRigLink final : public RigLink {
 public:
  InProcessRigLink(const link::InProcessLink::Settings& settings,
                   std::unique_ptr<coupling::WorldCoupling> world_half, rt::WakeSignal* wake)
      : world_half_(std::move(world_half)), link_(settings, *world_half_, wake) {}

  [[nodiscard]] coupling::ArmLink& arm_end() noexcept override { return link_.arm_end(); }
  std::optional<MonotonicTime> pump(MonotonicTime now) override { return link_.pump(now); }
  [[nodiscard]] link::LinkStatus status() const override { return link_.status(); }

 private:
  std::unique_ptr<coupling::WorldCoupling> world_half_;
  link::InProcessLink link_;
};

}  // namespace

std::unique_ptr<RigLink> make_in_process_link(const config::ArmConfig& arm,
                                              std::unique_ptr<coupling::WorldCoupling> world_half,
                                              bool hears_actions, rt::WakeSignal* wake) {
  link::InProcessLink::Settings settings;
  settings.mode = send_mode(arm);
  settings.hears_actions = hears_actions;
  settings.impairment = impairment_settings(arm.impairment);
  return std::make_unique<InProcessRigLink>(settings, std::move(world_half), wake);
}

}  // namespace thimble::session
