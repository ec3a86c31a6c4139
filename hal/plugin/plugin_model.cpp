#include "hal/plugin/plugin_model.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "hal/plugin/abi_text.hpp"
#include "hal/plugin/plugin_check.hpp"

namespace thimble::plugin {
namespace {

constexpr Duration kLongestStep = std::chrono::milliseconds(10);

// Zero where one of them is not finite.
template <class Vector>
Vector vector_of(const double (&numbers)[3]) noexcept {
  if (!is_finite(numbers[0], numbers[1], numbers[2])) return {};
  return {numbers[0], numbers[1], numbers[2]};
}

class PluginModel final : public SimHidModel, public ArmBackend {
 public:
  PluginModel(const thimble_model& model, void* device, const thimble_model_facts& facts)
      : model_(&model),
        device_(device),
        facts_(facts),
        tip_load_{sizeof(tip_load_), 0, this, &force_on_tip, &is_button_pressed} {}
  ~PluginModel() override { model_->destroy(device_); }
  PluginModel(const PluginModel&) = delete;
  PluginModel& operator=(const PluginModel&) = delete;

  [[nodiscard]] bus::BusDeviceInfo describe() const override {
    bus::BusDeviceInfo info;
    info.address = {std::string(bus::kSimScheme) + text_of(model_->name)};
    info.kind = bus::BusKind::Hid;
    info.vendor_id = facts_.info.vendor_id;
    info.product_id = facts_.info.product_id;
    info.manufacturer = text_of(facts_.info.manufacturer);
    info.product = text_of(facts_.info.product);
    info.serial_number = text_of(facts_.info.serial_number);
    info.input_report_bytes = facts_.info.input_report_bytes;
    info.output_report_bytes = facts_.info.output_report_bytes;
    return info;
  }
  [[nodiscard]] Duration frame_period() const noexcept override {
    return Duration(facts_.frame_period_ns);
  }

  THIMBLE_RT void advance(MonotonicTime t) noexcept override {
    if (t < now_) return;
    now_ = t;
    is_advancing_ = true;
    model_->advance(device_, t.since_epoch.count());
    is_advancing_ = false;
  }
  THIMBLE_RT void out_report(std::span<const std::uint8_t> bytes) noexcept override {
    model_->out_report(device_, bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  }
  THIMBLE_RT std::size_t in_report(std::span<std::uint8_t> out) noexcept override {
    std::array<std::uint8_t, THIMBLE_REPORT_BYTES> bytes{};
    const std::size_t size = model_->in_report(device_, bytes.data());
    if (size > std::min(out.size(), bytes.size())) return 0;
    std::copy_n(bytes.begin(), size, out.begin());
    return size;
  }
  THIMBLE_RT void power_cycle() noexcept override { model_->power_cycle(device_); }
  [[nodiscard]] ArmBackend* arm_backend() noexcept override { return this; }

  THIMBLE_RT void hold_tip(TipLoad* load) noexcept override {
    load_ = load;
    model_->hold_tip(device_, load == nullptr ? nullptr : &tip_load_);
  }
  THIMBLE_RT void push_tip(Force3 force) noexcept override {
    if (!is_finite(force)) force = {};
    const double force_newton[3] = {force.x, force.y, force.z};
    model_->push_tip(device_, force_newton);
  }
  THIMBLE_RT bool move_tip_to(Position3 tip) noexcept override {
    if (!is_finite(tip)) return false;
    const double tip_m[3] = {tip.x, tip.y, tip.z};
    return model_->move_tip_to(device_, tip_m) == THIMBLE_OK;
  }
  THIMBLE_RT void press_calibration_button(bool pressed) noexcept override {
    model_->press_calibration_button(device_, pressed ? 1 : 0);
  }
  THIMBLE_RT void press_stylus_button(bool pressed) noexcept override {
    model_->press_stylus_button(device_, pressed ? 1 : 0);
  }
  THIMBLE_RT void turn_stylus(const std::array<double, 3>& angle_rad) noexcept override {
    if (!is_finite(angle_rad[0], angle_rad[1], angle_rad[2])) return;
    model_->turn_stylus(device_, angle_rad.data());
  }
  [[nodiscard]] Position3 home_position() const noexcept override {
    return vector_of<Position3>(facts_.home_m);
  }
  THIMBLE_RT [[nodiscard]] ArmTruth truth() const noexcept override {
    thimble_arm_truth said{};
    said.struct_bytes = sizeof(said);
    model_->read_truth(device_, &said);
    ArmTruth truth;
    truth.tip = vector_of<Position3>(said.tip_m);
    truth.tip_velocity = vector_of<Velocity3>(said.tip_velocity_m_per_s);
    truth.motor_force = vector_of<Force3>(said.motor_force_newton);
    truth.motor_current_a = vector_of<std::array<double, 3>>(said.motor_current_a);
    truth.gimbal_rad = vector_of<std::array<double, 3>>(said.gimbal_rad);
    if (std::isfinite(said.mechanical_energy_j)) {
      truth.mechanical_energy_j = said.mechanical_energy_j;
    }
    truth.is_amplifier_on = said.is_amplifier_on != 0;
    return truth;
  }

 private:
  // The plugin's way to the load, which must not be asked anything that a plant would not ask.
  static void force_on_tip(void* context, std::int64_t t_ns, std::int64_t dt_ns,
                           const double tip_m[3], const double velocity_m_per_s[3],
                           double force_newton[3]) noexcept {
    auto& self = *static_cast<PluginModel*>(context);
    const Position3 tip{tip_m[0], tip_m[1], tip_m[2]};
    const Velocity3 velocity{velocity_m_per_s[0], velocity_m_per_s[1], velocity_m_per_s[2]};
    const Force3 force =
        self.ask_load(MonotonicTime{Duration(t_ns)}, Duration(dt_ns), tip, velocity);
    for (std::size_t axis = 0; axis < 3; ++axis) force_newton[axis] = force[axis];
  }
  static std::int32_t is_button_pressed(void* context, std::int64_t t_ns) noexcept {
    const auto& self = *static_cast<PluginModel*>(context);
    const MonotonicTime t{Duration(t_ns)};
    if (self.load_ == nullptr || !self.is_advancing_ || t < self.plant_time_ || t > self.now_) {
      return 0;
    }
    return self.load_->is_button_pressed(t) ? 1 : 0;
  }
  [[nodiscard]] Force3 ask_load(MonotonicTime t, Duration dt, Position3 tip,
                                Velocity3 velocity) noexcept {
    if (load_ == nullptr || !is_advancing_ || t < plant_time_ || t > now_) return {};
    if (dt <= Duration(0) || dt > kLongestStep) return {};
    if (!is_finite(tip) || !is_finite(velocity)) return {};
    plant_time_ = t;
    const Force3 force = load_->force_on_tip(t, dt, tip, velocity);
    return is_finite(force) ? force : Force3{};
  }

  const thimble_model* model_;
  void* device_;
  thimble_model_facts facts_;
  thimble_tip_load tip_load_;
  TipLoad* load_{nullptr};
  bool is_advancing_{false};
  MonotonicTime now_{Duration::min()};
  MonotonicTime plant_time_{Duration::min()};
};

Result<std::unique_ptr<SimHidModel>> create(const thimble_model& model,
                                            const SimModelSettings& settings) {
  const thimble_model_settings said{sizeof(thimble_model_settings), 0, settings.amplifier_max_a,
                                    settings.seed};
  thimble_model_facts facts{};
  facts.struct_bytes = sizeof(facts);
  facts.info.struct_bytes = sizeof(facts.info);
  void* device = nullptr;
  thimble_reason reason{};
  if (model.create(&said, &facts, &device, &reason) != THIMBLE_OK) {
    const std::string why = text_of(reason.text);
    return fail(Errc::InvalidArgument,
                why.empty() ? "the plugin makes none and does not say why" : why);
  }
  if (device == nullptr) return fail(Errc::Malformed, "the plugin made one and gave no device");
  const auto checked = check_facts(facts);
  if (!checked) {
    model.destroy(device);
    return tl::unexpected(checked.error().in("the plugin's model"));
  }
  return std::make_unique<PluginModel>(model, device, facts);
}

}  // namespace

SimModelEntry plugin_model_entry(const thimble_model& model) {
  return {text_of(model.name), text_of(model.description),
          [&model](const SimModelSettings& settings) { return create(model, settings); }};
}

}  // namespace thimble::plugin
