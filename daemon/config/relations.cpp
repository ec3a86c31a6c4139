#include <algorithm>
#include <set>
#include <string>

#include "daemon/config/endpoint.hpp"
#include "daemon/config/peers.hpp"
#include "daemon/config/schema.hpp"

namespace thimble::config {
namespace {

template <class Item>
void check_names(std::vector<Entry<Item>>& entries) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::string& name = entries[i].value.name;
    const bool is_repeated =
        !name.empty() && std::any_of(entries.begin(), entries.begin() + static_cast<long>(i),
                                     [&](const auto& other) { return other.value.name == name; });
    if (!is_repeated) continue;
    entries[i].reader.reject("name",
                             "expected a name of its own, found " + in_quotes(name) + " again");
  }
}

void check_worlds(std::vector<Entry<ArmConfig>>& arms,
                  const std::vector<Entry<WorldConfig>>& worlds) {
  std::vector<std::string> names;
  names.reserve(worlds.size());
  for (const auto& entry : worlds) names.push_back(entry.value.name);
  for (auto& [reader, arm] : arms) {
    if (!arm.world || std::find(names.begin(), names.end(), *arm.world) != names.end()) continue;
    const std::string_view meant = nearest(*arm.world, names);
    reader.reject("world", "expected the name of a [[world]] of this configuration, found " +
                               in_quotes(*arm.world) +
                               (meant.empty() ? "" : "; did you mean " + in_quotes(meant) + "?"));
  }
}

// The printed callback has its stiffness printed; a zone and a map tell where cells are, not what
// of.
bool feels_materials(CouplingScheme scheme) {
  return scheme != CouplingScheme::ThesisLiteral && scheme != CouplingScheme::BufferZone &&
         scheme != CouplingScheme::Composite;
}

// What a world says is of no use to a scheme that cannot feel it.
void check_schemes(std::vector<Entry<ArmConfig>>& arms,
                   const std::vector<Entry<WorldConfig>>& worlds) {
  for (auto& [reader, said] : arms) {
    const ArmConfig& arm = said;  // clang 14 captures no structured binding
    if (!arm.world) continue;
    const auto world = std::find_if(worlds.begin(), worlds.end(), [&](const auto& entry) {
      return entry.value.name == *arm.world;
    });
    if (world == worlds.end()) continue;
    const CouplingScheme scheme = arm.coupling.scheme;
    // The arm's own table knows "coupling", not what is below it.
    if (!feels_materials(scheme) && !world->value.materials.empty()) {
      reader.reject("coupling", in_quotes(to_string(scheme)) + " feels no materials, and world " +
                                    in_quotes(*arm.world) +
                                    " has some; use \"ghost-point\", or leave the materials out");
    }
    const bool is_simple = world->value.constraint_model == ConstraintModel::Simple;
    if (is_simple && has_own_world_half(scheme)) {
      reader.reject("coupling", in_quotes(to_string(scheme)) +
                                    " works with the faces of the ghost point, and world " +
                                    in_quotes(*arm.world) +
                                    " has constraint_model = \"simple\"; use \"ghost-point\" for "
                                    "the scheme or for the model");
    }
  }
}

// Two arms are each other's far end, by schemes that fit (coupling/arm_pair.hpp).
void check_peers(std::vector<Entry<ArmConfig>>& arms) {
  for (auto& [reader, said] : arms) {
    const ArmConfig& arm = said;
    if (!arm.peer) continue;
    const auto peer = std::find_if(
        arms.begin(), arms.end(), [&](const auto& entry) { return entry.value.name == *arm.peer; });
    if (peer == arms.end() || peer->value.peer != arm.name || *arm.peer == arm.name) {
      reader.reject("peer",
                    "expected the name of another [[arm]] of this configuration whose peer "
                    "is " +
                        in_quotes(arm.name) + ", found " + in_quotes(*arm.peer));
      continue;
    }
    const bool fits = are_peers(arm.coupling.scheme, peer->value.coupling.scheme);
    if (fits && arm.coupling.mode == CouplingMode::Streamed) continue;
    reader.reject("coupling",
                  "two arms are coupled, streamed, by \"wave\" or \"spring-damper\" at both, or "
                  "\"ghost-point\" at the one that feels and \"spring-damper\" at the one that "
                  "follows; found " +
                      in_quotes(to_string(arm.coupling.scheme)) + " beside " +
                      in_quotes(to_string(peer->value.coupling.scheme)));
  }
}

// One piece of hardware serves one arm; of simulated models there are as many as wanted.
void check_devices(std::vector<Entry<ArmConfig>>& arms) {
  for (std::size_t i = 0; i < arms.size(); ++i) {
    const std::string& device = arms[i].value.device;
    if (device.empty() || device.starts_with("sim:")) continue;
    for (std::size_t j = 0; j < i; ++j) {
      if (arms[j].value.device != device) continue;
      arms[i].reader.reject("device",
                            "expected a device of its own, found " + in_quotes(device) + " again");
      break;
    }
  }
}

void check_listeners(std::vector<Entry<ArmConfig>>& arms, std::vector<Entry<WorldConfig>>& worlds) {
  std::set<std::string> places;
  const auto check = [&](auto& entries) {
    for (auto& [reader, value] : entries) {
      if (!value.listen || value.listen->port == 0) continue;
      const std::string place = to_string(*value.listen);
      if (places.insert(place).second) continue;
      reader.reject("listen",
                    "expected an address of its own, found " + in_quotes(place) + " again");
    }
  };
  check(arms);
  check(worlds);
}

// A port has two ends, and one of them is the cable.
void check_lines(std::vector<Entry<ArmConfig>>& arms, std::vector<Entry<WorldConfig>>& worlds) {
  std::set<std::string> nodes;
  const auto check = [&](auto& entries, const char* key, auto line_of) {
    for (auto& [reader, value] : entries) {
      const std::optional<SerialEndpoint>& line = value.*line_of;
      if (!line || nodes.insert(line->node).second) continue;
      reader.reject(key,
                    "expected a serial port of its own, found " + in_quotes(line->node) + " again");
    }
  };
  check(arms, "link", &ArmConfig::line);
  check(arms, "listen", &ArmConfig::listen_line);
  check(worlds, "listen", &WorldConfig::line);
}

// What root names is one slot: two worlds would ring the same doorbell.
void check_board_in_slot(std::vector<Entry<WorldConfig>>& worlds) {
  const WorldConfig* first = nullptr;
  for (auto& [reader, world] : worlds) {
    if (!world.pieces || world.pieces->board != PieceBoardKind::Pci) continue;
    if (first != nullptr) {
      // The world's own table knows "pieces", not what is below it.
      reader.reject("pieces", "expected board = \"pci\" of one world only, found it of " +
                                  in_quotes(first->name) + ", too; there is one board in a slot");
    } else {
      first = &world;
    }
  }
}

}  // namespace

void check_relations(std::vector<Entry<ArmConfig>>& arms, std::vector<Entry<WorldConfig>>& worlds) {
  check_names(arms);
  check_names(worlds);
  check_worlds(arms, worlds);
  check_schemes(arms, worlds);
  check_peers(arms);
  check_devices(arms);
  check_listeners(arms, worlds);
  check_lines(arms, worlds);
  check_board_in_slot(worlds);
}

}  // namespace thimble::config
