#include "hal/plugin/plugin_check.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "hal/plugin/abi_text.hpp"

namespace thimble::plugin {
namespace {

constexpr std::uint32_t kMaxModels = 16;
constexpr std::uint32_t kRevisionWithoutUsb = 1;
constexpr std::uint32_t kRevisionWithoutFullRate = 2;
// Ranges of plugin_abi.h. Ours: what a desktop arm can have, with room; a number beyond is a slip
// or a lie, and would reach the limiter as a limit.
constexpr double kMaxForce_newton = 100;
constexpr double kMaxStiffness_newton_per_m = 20000;
constexpr double kMaxRadius_m = 2;
constexpr double kMaxCurrent_a = 100;
constexpr double kMaxJoint_rad = 1e6;
constexpr double kMaxGimbal_rad = 3.1415926536;  // pi, and a rounding
constexpr double kMaxTip_m = 10;
constexpr double kMaxCurrentPerForce = 1e4;
constexpr double kMinCurrentPerForce = 1e-6;
constexpr double kMinRate_hz = 500;
constexpr double kMaxRate_hz = 8000;
constexpr std::int64_t kMinPeriod_ns = 100'000;
constexpr std::int64_t kMinFrame_ns = 125'000;
constexpr std::int64_t kMaxPeriod_ns = 10'000'000;
constexpr std::int64_t kMaxWatchdog_ns = 10'000'000'000;

tl::unexpected<Error> refuse(std::string why) { return fail(Errc::Malformed, std::move(why)); }

// Another size with the same revision is a mistake of its maker: in version 0 nothing may grow.
tl::unexpected<Error> refuse_size(const std::string& what, std::size_t said, std::size_t has) {
  return refuse(what + " says " + std::to_string(said) + " bytes, but has " + std::to_string(has) +
                " in this version");
}

// One table of functions, whose functions and place can be judged before anything is called.
class TableCheck {
 public:
  TableCheck(std::string what, const IsInObject& is_in_object)
      : what_(std::move(what)), is_in_object_(&is_in_object) {}

  template <class Function>
  void has(const char* name, Function function) {
    if (!why_.empty()) return;
    if (function == nullptr) {
      why_ = what_ + " lacks the function " + name;
    } else if (!(*is_in_object_)(reinterpret_cast<const void*>(function), 1, Access::Execute)) {
      why_ = what_ + " has a function " + name + " that is not in the file";
    }
  }
  [[nodiscard]] Result<void> result() const {
    if (!why_.empty()) return refuse(why_);
    return {};
  }

 private:
  std::string what_;
  const IsInObject* is_in_object_;
  std::string why_;
};

template <class Table>
Result<void> check_place(const Table* table, const std::string& what,
                         const IsInObject& is_in_object) {
  const bool is_aligned = reinterpret_cast<std::uintptr_t>(table) % alignof(Table) == 0;
  if (table == nullptr || !is_aligned || !is_in_object(table, sizeof(Table), Access::Read)) {
    return refuse(what + " is not in the file");
  }
  if (table->struct_bytes != sizeof(Table)) {
    return refuse_size(what, table->struct_bytes, sizeof(Table));
  }
  if (!is_name(table->name)) {
    return refuse(what + " has the name '" + text_of(table->name) +
                  "', which is not 1 to 31 of a-z, 0-9 and -");
  }
  return {};
}

Result<void> check_driver(const thimble_driver* driver, const IsInObject& is_in_object) {
  auto placed = check_place(driver, "its driver", is_in_object);
  if (!placed) return placed;
  TableCheck table("its driver", is_in_object);
  table.has("match", driver->match);
  table.has("open", driver->open);
  table.has("close", driver->close);
  table.has("forget_calibration", driver->forget_calibration);
  table.has("decode", driver->decode);
  table.has("encode", driver->encode);
  return table.result();
}

bool is_claim(const thimble_usb_claim& claim) noexcept {
  if (claim.pipe_count < 1 || claim.pipe_count > THIMBLE_USB_PIPES) return false;
  return std::all_of(claim.pipes, claim.pipes + claim.pipe_count,
                     [](const thimble_usb_pipe& pipe) { return pipe.is_queued <= 1; });
}

Result<void> check_usb_driver(const thimble_usb_driver* driver, const IsInObject& is_in_object) {
  auto placed = check_place(driver, "its USB driver", is_in_object);
  if (!placed) return placed;
  if (!is_claim(driver->claim)) return refuse("its USB driver claims what no device has");
  TableCheck table("its USB driver", is_in_object);
  table.has("match", driver->match);
  table.has("open", driver->open);
  table.has("close", driver->close);
  table.has("forget_calibration", driver->forget_calibration);
  table.has("read", driver->read);
  table.has("write", driver->write);
  table.has("read_instruction", driver->read_instruction);
  return table.result();
}

Result<void> check_drivers(const thimble_plugin& plugin, const IsInObject& is_in_object) {
  if (plugin.driver != nullptr) {
    auto checked = check_driver(plugin.driver, is_in_object);
    if (!checked) return checked;
  }
  const thimble_usb_driver* usb = usb_driver_of(plugin);
  if (usb == nullptr) return {};
  auto checked = check_usb_driver(usb, is_in_object);
  if (!checked || plugin.driver == nullptr) return checked;
  if (text_of(plugin.driver->name) != text_of(usb->name)) return {};
  return refuse("has two drivers of the name '" + text_of(usb->name) + "'");
}

Result<void> check_model(const thimble_model* model, std::uint32_t number,
                         const IsInObject& is_in_object) {
  const std::string what = "its model " + std::to_string(number + 1);
  auto placed = check_place(model, what, is_in_object);
  if (!placed) return placed;
  TableCheck table(what, is_in_object);
  table.has("create", model->create);
  table.has("destroy", model->destroy);
  table.has("advance", model->advance);
  table.has("out_report", model->out_report);
  table.has("in_report", model->in_report);
  table.has("power_cycle", model->power_cycle);
  table.has("hold_tip", model->hold_tip);
  table.has("push_tip", model->push_tip);
  table.has("move_tip_to", model->move_tip_to);
  table.has("press_calibration_button", model->press_calibration_button);
  table.has("press_stylus_button", model->press_stylus_button);
  table.has("turn_stylus", model->turn_stylus);
  table.has("read_truth", model->read_truth);
  return table.result();
}

Result<void> check_models(const thimble_plugin& plugin, const IsInObject& is_in_object) {
  if (plugin.model_count > kMaxModels) {
    return refuse("has " + std::to_string(plugin.model_count) + " models, of at most " +
                  std::to_string(kMaxModels));
  }
  if (plugin.model_count == 0) return {};
  const std::size_t bytes = plugin.model_count * sizeof(void*);
  const bool is_aligned =
      reinterpret_cast<std::uintptr_t>(plugin.models) % alignof(decltype(*plugin.models)) == 0;
  if (plugin.models == nullptr || !is_aligned ||
      !is_in_object(plugin.models, bytes, Access::Read)) {
    return refuse("its list of models is not in the file");
  }
  for (std::uint32_t i = 0; i < plugin.model_count; ++i) {
    auto checked = check_model(plugin.models[i], i, is_in_object);
    if (!checked) return checked;
    for (std::uint32_t j = 0; j < i; ++j) {
      if (text_of(plugin.models[i]->name) == text_of(plugin.models[j]->name)) {
        return refuse("has two models of the name '" + text_of(plugin.models[i]->name) + "'");
      }
    }
  }
  return {};
}

bool is_within(double value, double max) { return value > 0 && value <= max; }

bool is_small(const double* values, std::size_t count, double max) noexcept {
  // NaN is not at most anything.
  return std::all_of(values, values + count, [max](double v) { return std::abs(v) <= max; });
}

tl::unexpected<Error> no_arm_has(const std::string& what) {
  return refuse("claims " + what + " that no arm has");
}

// What a plugin of that revision exports; 0: no revision that this host takes.
std::size_t plugin_bytes(std::uint32_t version, std::uint32_t revision) noexcept {
  if (version != THIMBLE_PLUGIN_ABI_VERSION) return 0;
  if (revision == kRevisionWithoutUsb) return offsetof(thimble_plugin, usb_driver);
  const bool is_known =
      revision == THIMBLE_PLUGIN_ABI_REVISION || revision == kRevisionWithoutFullRate;
  return is_known ? sizeof(thimble_plugin) : 0;
}

}  // namespace

const thimble_usb_driver* usb_driver_of(const thimble_plugin& plugin) noexcept {
  return plugin.abi_revision == kRevisionWithoutUsb ? nullptr : plugin.usb_driver;
}

Result<void> check_plugin(const thimble_plugin& plugin, std::size_t bytes,
                          const IsInObject& is_in_object) {
  if (!is_in_object(&plugin, std::min(bytes, sizeof(plugin)), Access::Read)) {
    return refuse("is no plugin: its " THIMBLE_PLUGIN_SYMBOL " is not in the file");
  }
  // What every version begins with.
  if (bytes < sizeof(plugin.magic) + sizeof(plugin.abi_version) + sizeof(plugin.abi_revision) ||
      plugin.magic != THIMBLE_PLUGIN_MAGIC) {
    return refuse("is not a plugin's: the magic number is wrong");
  }
  const std::size_t known_bytes = plugin_bytes(plugin.abi_version, plugin.abi_revision);
  if (known_bytes == 0) {
    return fail(Errc::Unsupported, "was built for version " + std::to_string(plugin.abi_version) +
                                       " revision " + std::to_string(plugin.abi_revision) +
                                       " of the plugin ABI; this daemon has " +
                                       std::to_string(THIMBLE_PLUGIN_ABI_VERSION) + " revision " +
                                       std::to_string(THIMBLE_PLUGIN_ABI_REVISION) +
                                       ": build it anew against the header of this daemon");
  }
  if (bytes < known_bytes) return refuse("is too small to be a plugin's of this version");
  if (plugin.struct_bytes != known_bytes) {
    return refuse_size("it", plugin.struct_bytes, known_bytes);
  }
  const bool has_driver = plugin.driver != nullptr || usb_driver_of(plugin) != nullptr;
  if (!has_driver && plugin.model_count == 0) return refuse("has neither a driver nor a model");
  auto checked = check_drivers(plugin, is_in_object);
  if (!checked) return checked;
  return check_models(plugin, is_in_object);
}

Result<HapticCapabilities> read_capabilities(const thimble_capabilities& said) {
  if (!is_name(said.model)) return refuse("gives a model's name that is not a name");
  if (said.joint_count != kFirstGimbalJoint && said.joint_count != kMaxJoints)
    return no_arm_has("joints");
  if (!is_within(said.peak_force_newton, kMaxForce_newton) ||
      !is_within(said.continuous_force_newton, said.peak_force_newton)) {
    return no_arm_has("a force");
  }
  if (!is_within(said.max_stiffness_newton_per_m, kMaxStiffness_newton_per_m)) {
    return no_arm_has("a stiffness");
  }
  if (!is_within(said.workspace_radius_m, kMaxRadius_m)) return no_arm_has("a workspace");
  HapticCapabilities out;
  for (std::size_t i = 0; i < THIMBLE_MOTORS; ++i) {
    if (!is_within(said.peak_current_a[i], kMaxCurrent_a) ||
        !is_within(said.continuous_current_a[i], said.peak_current_a[i])) {
      return no_arm_has("a current");
    }
    out.peak_current_a[i] = said.peak_current_a[i];
    out.continuous_current_a[i] = said.continuous_current_a[i];
    const double most = said.most_current_a_per_newton[i];
    const bool is_sound = most >= kMinCurrentPerForce && most <= kMaxCurrentPerForce;
    if (most != 0 && !is_sound) return no_arm_has("a current");
    out.most_current_a_per_newton[i] = most;
  }
  if (said.sample_period_ns < kMinPeriod_ns || said.sample_period_ns > kMaxPeriod_ns) {
    return no_arm_has("a sample period");
  }
  if (said.device_watchdog_ns < 0 || said.device_watchdog_ns > kMaxWatchdog_ns) {
    return no_arm_has("a watchdog");
  }
  if (said.full_rate_hz != 0 &&
      !(said.full_rate_hz >= kMinRate_hz && said.full_rate_hz <= kMaxRate_hz)) {
    return no_arm_has("a rate");
  }
  if (said.full_rate_hz != 0) out.full_rate_hz = said.full_rate_hz;
  out.model = text_of(said.model);
  out.joint_count = said.joint_count;
  out.peak_force_newton = said.peak_force_newton;
  out.continuous_force_newton = said.continuous_force_newton;
  out.max_stiffness_newton_per_m = said.max_stiffness_newton_per_m;
  out.workspace_radius_m = said.workspace_radius_m;
  out.sample_period = Duration(said.sample_period_ns);
  out.device_watchdog = Duration(said.device_watchdog_ns);
  return out;
}

bool is_sound(const thimble_sample& sample) noexcept {
  if (sample.calibration < THIMBLE_CALIBRATION_UNKNOWN ||
      sample.calibration > THIMBLE_CALIBRATION_DONE) {
    return false;
  }
  bool has_current = false;
  for (const auto& motor : sample.motor_current_a_per_newton) {
    if (!is_small(motor, 3, kMaxCurrentPerForce)) return false;
    has_current = has_current || motor[0] != 0 || motor[1] != 0 || motor[2] != 0;
  }
  // Without a current for any force there would be nothing to limit it by.
  if (sample.calibration == THIMBLE_CALIBRATION_DONE && !has_current) return false;
  constexpr std::size_t kGimbal = kFirstGimbalJoint;
  return is_small(sample.joint_position_rad, kGimbal, kMaxJoint_rad) &&
         is_small(sample.joint_position_rad + kGimbal, THIMBLE_JOINTS - kGimbal, kMaxGimbal_rad) &&
         is_small(sample.tip_m, 3, kMaxTip_m);
}

Result<void> check_report_bytes(std::size_t input, std::size_t output) {
  if (input < 1 || input > THIMBLE_REPORT_BYTES || output < 1 || output > THIMBLE_REPORT_BYTES) {
    return refuse("has reports that are not 1 to " + std::to_string(THIMBLE_REPORT_BYTES) +
                  " bytes long");
  }
  return {};
}

Result<void> check_facts(const thimble_model_facts& facts) {
  if (facts.frame_period_ns < kMinFrame_ns || facts.frame_period_ns > kMaxPeriod_ns) {
    return refuse("has a frame period that is not 125 us to 10 ms");
  }
  if (!is_small(facts.home_m, 3, kMaxTip_m)) return refuse("has its home out of reach");
  return check_report_bytes(facts.info.input_report_bytes, facts.info.output_report_bytes);
}

}  // namespace thimble::plugin
