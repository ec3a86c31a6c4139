#include "daemon/config/schema.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "daemon/config/endpoint.hpp"
#include "daemon/config/name.hpp"

namespace thimble::config {
namespace {

// Beyond these a number is a slip of the pen, not a wish; DESIGN section 4 where it limits.
constexpr Range kAboveZero{0, kNoMax, true};   // the driver knows how much is too much
constexpr Range kSeed{0, 9007199254740992.0};  // 2^53: every one is exact as a double too
constexpr Range kRatio{0, 1};
constexpr Range kInjectedTime{0, 2};  // what the links take
constexpr std::size_t kMaxPlugins = 16;

constexpr std::array<Choice<Realtime>, 2> kRealtime{{
    {"best-effort", Realtime::BestEffort},
    {"required", Realtime::Required},
}};
constexpr std::array<Choice<HandMotion>, 6> kMotions{{
    {"still", HandMotion::Still},
    {"poke", HandMotion::Poke},
    {"sweep", HandMotion::Sweep},
    {"circle", HandMotion::Circle},
    {"tremor", HandMotion::Tremor},
    {"explore", HandMotion::Explore},
}};
constexpr std::array<Choice<ConstraintModel>, 2> kConstraintModels{{
    {"ghost-point", ConstraintModel::GhostPoint},
    {"simple", ConstraintModel::Simple},
}};
constexpr std::array<Choice<Fallback>, 2> kFallbacks{{
    {"none", Fallback::None},
    {"simulated", Fallback::Simulated},
}};

template <class Enum, std::size_t Count>
void read_choice(TableReader& reader, std::string_view key,
                 const std::array<Choice<Enum>, Count>& choices, Enum& out) {
  reader.read(key, std::span<const Choice<Enum>>(choices), out);
}

void read_seed(TableReader& reader, std::uint64_t& out) {
  std::int64_t seed = 0;
  if (reader.read_integer("seed", kSeed, seed)) out = static_cast<std::uint64_t>(seed);
}

void read_name(TableReader& reader, std::string& out) {
  reader.require("name", "a name");
  std::string name;
  if (!reader.read("name", name)) return;
  if (!is_name(name)) {
    return reader.reject("name", "expected 1 to " + std::to_string(kMaxNameBytes) +
                                     " of a-z, 0-9 and -, found " + in_quotes(name));
  }
  out = name;
}

void read_socket_mode(TableReader& reader, std::uint32_t& out) {
  std::string text;
  if (!reader.read("socket_mode", text)) return;
  std::uint32_t mode = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), mode, 8);
  const bool is_octal = error == std::errc{} && end == text.data() + text.size();
  // Who may write to the socket may move motors; the daemon itself has to.
  const bool is_good = is_octal && (mode & ~0770U) == 0 && (mode & 0600U) == 0600U;
  if (!is_good) {
    return reader.reject("socket_mode",
                         "expected octal permissions such as \"0660\", with reading "
                         "and writing for the owner and nothing for others, found " +
                             in_quotes(text));
  }
  out = mode;
}

std::optional<ImpairmentConfig> read_impairment(TableReader reader) {
  ImpairmentConfig out;
  reader.read("delay_s", kInjectedTime, out.delay_s);
  reader.read("jitter_s", kInjectedTime, out.jitter_s);
  reader.read("loss", kRatio, out.loss);
  reader.read("duplicate", kRatio, out.duplicate);
  reader.read("reorder", kRatio, out.reorder);
  read_seed(reader, out.seed);
  reader.finish();
  return reader.is_present() ? std::optional(out) : std::nullopt;
}

HandConfig read_hand(TableReader reader) {
  HandConfig out;
  read_choice(reader, "motion", kMotions, out.motion);
  read_seed(reader, out.seed);
  // As sim::check() has them: what a person has, and the model's step can follow.
  reader.read("speed_m_per_s", {0.001, 0.5}, out.speed_m_per_s);
  reader.read("reach_m", {0, 0.1}, out.reach_m);
  reader.read("stiffness_newton_per_m", {0, 2e4}, out.stiffness_newton_per_m);
  reader.read("damping_newton_s_per_m", {0, 100}, out.damping_newton_s_per_m);
  reader.read("mass_kg", {0.02, 5}, out.mass_kg);
  reader.finish();
  return out;
}

LimitsConfig read_limits(TableReader reader) {
  LimitsConfig out;
  reader.read("force_newton", {0, 100, true}, out.force_newton);
  reader.read("rise_newton_per_s", {0, 1000, true}, out.rise_newton_per_s);
  reader.read("ramp_s", {0.5, 60}, out.ramp_s);
  reader.read("overspeed_m_per_s", {0, 1.5, true}, out.overspeed_m_per_s);
  reader.finish();
  return out;
}

void read_device(TableReader& reader, ArmConfig& arm) {
  reader.require("device", "a device such as \"sim:phantom-vintage\" or \"hid:SERIAL\"");
  if (!reader.read("device", arm.device)) return;
  constexpr std::array<std::string_view, 5> kSchemeNames = {
      "sim:", "hid:", "usb:", "serial:", "pci:"};
  const bool is_good =
      std::any_of(kSchemeNames.begin(), kSchemeNames.end(), [&](std::string_view s) {
        return arm.device.starts_with(s) && arm.device.size() > s.size();
      });
  if (is_good) return;
  reader.reject("device",
                "expected sim:MODEL, or hid:SERIAL, hid:PORT, usb:SERIAL, usb:PORT, serial:SERIAL "
                "or serial:PORT as thimble devices lists it, found " +
                    in_quotes(arm.device));
  arm.device.clear();
}

void read_fallback(TableReader& reader, ArmConfig& arm) {
  read_choice(reader, "fallback", kFallbacks, arm.fallback);
  if (arm.fallback == Fallback::None || arm.device.empty()) return;
  if (arm.device.starts_with("sim:")) {
    return reader.reject("fallback",
                         "expected only for a real device, found beside " + in_quotes(arm.device));
  }
  if (arm.model) return;
  reader.reject("fallback", "expected only beside model, which says what is simulated");
}

// The simulated person holds simulated arms only.
void read_person(TableReader& reader, ArmConfig& arm) {
  const HandConfig hand = read_hand(reader.table("hand"));
  const bool may_be_simulated =
      arm.device.starts_with("sim:") || arm.fallback == Fallback::Simulated;
  if (may_be_simulated) arm.hand = hand;
  if (!may_be_simulated && !arm.device.empty() && reader.has("hand")) {
    reader.reject("hand",
                  "expected only for a \"sim:\" device, found beside " + in_quotes(arm.device));
  }
}

void read_place(TableReader& reader, ArmConfig& arm) {
  std::optional<std::array<double, 3>> place;
  if (reader.read("place_m", {-1, 1}, place)) arm.place_m = *place;
}

void read_source(TableReader& reader, const std::filesystem::path& folder, WorldConfig& world) {
  reader.require(
      "source",
      "\"box:N\", \"sphere\", \"block\", \"shapes\", \"pieces\", \"life\", \"crystal\" or "
      "the path of an .npy, .nrrd, .nhdr, .stl or .obj file");
  std::string source;
  if (!reader.read("source", source)) return;
  if (is_volume_file(source) || is_mesh_file(source)) {
    std::optional<std::string> path;
    read_path(reader, "source", folder, path);
    world.source = path.value_or(source);
    return;
  }
  if (source == kSphereSource || source == kBlockSource || source == kShapesSource ||
      source == kPiecesSource || source == kLifeSource || source == kCrystalSource) {
    world.source = source;
    return;
  }
  unsigned cells = 0;
  const std::string_view text =
      std::string_view(source).substr(std::min<std::size_t>(4, source.size()));
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), cells);
  const bool is_number = error == std::errc{} && end == text.data() + text.size();
  if (!source.starts_with("box:") || !is_number || cells < 3 || cells > 1024) {
    return reader.reject(
        "source",
        "expected \"box:N\" with N from 3 to 1024, \"sphere\", \"block\", \"shapes\", \"pieces\", "
        "\"life\", \"crystal\", or the path of an .npy, .nrrd, .nhdr, .stl or .obj file, found " +
            in_quotes(source));
  }
  world.source = source;
}

// Code is named in full: what runs must not depend on where a file lies or a command is typed.
void read_plugins(TableReader& reader, std::vector<std::string>& out) {
  std::vector<std::string> paths;
  if (!reader.read("plugins", kMaxPlugins, paths)) return;
  for (const std::string& path : paths) {
    if (path.starts_with('/')) continue;
    return reader.reject("plugins", "expected absolute paths, found " + in_quotes(path));
  }
  out = std::move(paths);
}

}  // namespace

Entry<DaemonConfig> read_daemon(TableReader reader, const std::filesystem::path& folder) {
  DaemonConfig out;
  read_path(reader, "socket", folder, out.socket);
  read_socket_mode(reader, out.socket_mode);
  reader.read("group", out.group);
  read_path(reader, "flight_directory", folder, out.flight_directory);
  read_plugins(reader, out.plugins);
  reader.finish();
  return {std::move(reader), std::move(out)};
}

ServoConfig read_servo(TableReader reader) {
  ServoConfig out;
  reader.read("rate_hz", {500, 8000}, out.rate_hz);
  read_choice(reader, "realtime", kRealtime, out.realtime);
  std::int64_t number = 0;
  if (reader.read_integer("priority", {1, kMaxServoPriority}, number))
    out.priority = static_cast<int>(number);
  if (reader.read_integer("cpu", {0, 1023}, number)) out.cpu = static_cast<int>(number);
  reader.finish();
  return out;
}

void read_sha256(TableReader& reader, std::optional<std::string>& out) {
  constexpr std::size_t kDigits = 64;
  std::string said;
  if (!reader.read("firmware_sha256", said)) return;
  if (said.size() != kDigits ||
      said.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos) {
    return reader.reject(
        "firmware_sha256",
        "expected 64 hexadecimal digits, as sha256sum says them; found " + in_quotes(said));
  }
  out = std::move(said);
}

Entry<ArmConfig> read_arm(TableReader reader, const std::filesystem::path& folder) {
  ArmConfig out;
  read_name(reader, out.name);
  read_device(reader, out);
  reader.read("model", out.model);
  reader.read("amplifier_max_a", kAboveZero, out.amplifier_max_a);
  read_path(reader, "firmware", folder, out.firmware);
  read_sha256(reader, out.firmware_sha256);
  reader.read("newton_per_count", kAboveZero, out.newton_per_count);
  read_fallback(reader, out);
  read_other_side(reader, folder, out);
  read_place(reader, out);
  reader.read("activate", out.activate);
  read_person(reader, out);
  out.limits = read_limits(reader.table("limits"));
  out.coupling = read_coupling(reader.table("coupling"));
  out.impairment = read_impairment(reader.table("impairment"));
  check_carriage(reader, out);
  check_listening_arm(reader, out);
  reader.finish();
  return {std::move(reader), std::move(out)};
}

Entry<WorldConfig> read_world(TableReader reader, const std::filesystem::path& folder) {
  WorldConfig out;
  read_name(reader, out.name);
  read_source(reader, folder, out);
  read_volume(reader, out);
  read_field(reader, out);
  read_sphere(reader, out);
  read_shapes(reader, out);
  read_block(reader, out);
  read_pieces(reader, folder, out);
  read_automaton(reader, out);
  read_choice(reader, "constraint_model", kConstraintModels, out.constraint_model);
  read_listener(reader, folder, out);
  out.impairment = read_impairment(reader.table("impairment"));
  if (out.constraint_model == ConstraintModel::Simple && !out.materials.empty()) {
    reader.object("material",
                  "expected only with constraint_model = \"ghost-point\": the simple model tells "
                  "no surface");
  }
  reader.finish();
  return {std::move(reader), std::move(out)};
}

}  // namespace thimble::config
