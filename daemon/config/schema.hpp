#pragma once

#include <filesystem>
#include <string_view>

#include "daemon/config/config.hpp"
#include "daemon/config/table_reader.hpp"

namespace thimble::config {

// What a table says beside the reader of its table, for complaints that need both.
template <class Item>
struct Entry {
  TableReader reader;
  Item value;
};

// Each reads one kind of table; a value that is wrong keeps its default. `folder` is that of
// the configuration file, for relative paths.
[[nodiscard]] Entry<DaemonConfig> read_daemon(TableReader reader,
                                              const std::filesystem::path& folder);
[[nodiscard]] ServoConfig read_servo(TableReader reader);
[[nodiscard]] Entry<SafetyConfig> read_safety(TableReader reader);
// A simulated chip keeps no real arm safe.
void check_real_arms(Entry<SafetyConfig>& safety, const std::vector<Entry<ArmConfig>>& arms);
[[nodiscard]] Entry<ArmConfig> read_arm(TableReader reader, const std::filesystem::path& folder);
[[nodiscard]] Entry<WorldConfig> read_world(TableReader reader,
                                            const std::filesystem::path& folder);

// The keys of an arm that say what its far end is, and those of a world that others come to.
void read_other_side(TableReader& reader, const std::filesystem::path& folder, ArmConfig& arm);
void read_listener(TableReader& reader, const std::filesystem::path& folder, WorldConfig& world);

// The keys of a world that say how its volume file is read.
void read_volume(TableReader& reader, WorldConfig& world);
// Whether `source` ends as the volume files do that can be read.
[[nodiscard]] bool is_volume_file(std::string_view source);

// The source that is no file and has no cells, and its keys.
inline constexpr std::string_view kSphereSource = "sphere";
void read_sphere(TableReader& reader, WorldConfig& world);

// A surface of triangles.
[[nodiscard]] bool is_mesh_file(std::string_view source);
// The table of a volume file whose numbers are distances, and of a mesh.
void read_field(TableReader& reader, WorldConfig& world);

// The source that is made of shapes, and its tables.
inline constexpr std::string_view kShapesSource = "shapes";
void read_shapes(TableReader& reader, WorldConfig& world);
// Likewise.
inline constexpr std::string_view kBlockSource = "block";
void read_block(TableReader& reader, WorldConfig& world);

// The source of pieces on a CAM board, and its keys.
inline constexpr std::string_view kPiecesSource = "pieces";
void read_pieces(TableReader& reader, const std::filesystem::path& folder, WorldConfig& world);

// The sources that are automata which run by themselves, and their keys.
inline constexpr std::string_view kLifeSource = "life";
inline constexpr std::string_view kCrystalSource = "crystal";
void read_automaton(TableReader& reader, WorldConfig& world);
// A number that must be a power of two.
void read_power(TableReader& reader, std::string_view key, Range range, int& out);

// A path; relative ones are to `folder`.
void read_path(TableReader& reader, std::string_view key, const std::filesystem::path& folder,
               std::optional<std::string>& out);

// How touch is made; `reader` is the arm's "coupling".
[[nodiscard]] CouplingConfig read_coupling(TableReader reader);
[[nodiscard]] std::string_view to_string(CouplingScheme scheme);
// Whether it has a world half of its own, which answers with more than planes.
[[nodiscard]] bool has_own_world_half(CouplingScheme scheme);
// Whether an arm of this scheme can be another one's far end, and is coupled by a stream; else the
// complaint; `reader` is the arm's.
void check_listening_arm(TableReader& reader, const ArmConfig& arm);
// Whether the arm's link, if it has one, carries what its scheme needs; `reader` is the arm's.
void check_carriage(TableReader& reader, const ArmConfig& arm);

// What no table can tell alone: names are unique, references resolve, addresses do not clash.
void check_relations(std::vector<Entry<ArmConfig>>& arms, std::vector<Entry<WorldConfig>>& worlds);

}  // namespace thimble::config
