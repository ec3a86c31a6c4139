#include "daemon/link/serial_arm_link.hpp"
#include "daemon/session/arm_settings.hpp"
#include "daemon/session/rig_link.hpp"

namespace thimble::session {
namespace {

class SerialRigLink final : public RigLink {
 public:
  SerialRigLink(link::LinePorts& ports, const Clock& clock,
                const link::SerialArmLink::Settings& settings, rt::WakeSignal* wake)
      : link_(ports, clock, settings, wake) {}

  [[nodiscard]] coupling::ArmLink& arm_end() noexcept override { return link_.arm_end(); }
  // As of a link by UDP: only a wake brings work from outside.
  std::optional<MonotonicTime> pump(MonotonicTime) override {
    link_.on_wake();
    return std::nullopt;
  }
  [[nodiscard]] link::LinkStatus status() const override { return link_.status(); }

 private:
  link::SerialArmLink link_;
};

}  // namespace

Result<std::unique_ptr<RigLink>> make_serial_link(const config::ArmConfig& arm,
                                                  link::LinePorts& ports, const Clock& clock,
                                                  rt::WakeSignal* wake) {
  if (!arm.line) return fail(Errc::InvalidArgument, "arm.link is not set");
  const Result<link::ArmEndSettings> end = arm_end_settings(arm);
  if (!end) return tl::unexpected(end.error());
  return std::make_unique<SerialRigLink>(
      ports, clock, link::SerialArmLink::Settings{serial_line(*arm.line), *end}, wake);
}

}  // namespace thimble::session
