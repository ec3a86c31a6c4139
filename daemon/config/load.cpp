#include "daemon/config/load.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "daemon/config/report.hpp"
#include "daemon/config/schema.hpp"
#include "daemon/config/tree.hpp"

namespace thimble::config {
namespace {

template <class Item>
std::vector<Item> values_of(const std::vector<Entry<Item>>& entries) {
  std::vector<Item> out;
  out.reserve(entries.size());
  for (const auto& entry : entries) out.push_back(entry.value);
  return out;
}

// Each arm has threads, a servo's among them.
void check_count(TableReader& reader, const std::vector<Entry<ArmConfig>>& arms) {
  if (arms.size() <= kMaxArms) return;
  reader.reject("arm", "expected at most " + std::to_string(kMaxArms) + " [[arm]], found " +
                           std::to_string(arms.size()));
}

Config read_tree(const toml::table& root, const std::filesystem::path& file, Report& report,
                 const Inspector& inspect) {
  const std::filesystem::path folder = file.parent_path();
  TableReader reader(&root, "", "", {file.string(), 0, 0}, report);
  Config out;
  Entry<DaemonConfig> daemon = read_daemon(reader.table("daemon"), folder);
  out.daemon = daemon.value;
  out.servo = read_servo(reader.table("servo"));
  Entry<SafetyConfig> safety = read_safety(reader.table("safety"));
  if (safety.reader.is_present()) out.safety = safety.value;
  std::vector<Entry<ArmConfig>> arms;
  for (TableReader& arm : reader.tables("arm")) arms.push_back(read_arm(std::move(arm), folder));
  std::vector<Entry<WorldConfig>> worlds;
  for (TableReader& world : reader.tables("world")) {
    worlds.push_back(read_world(std::move(world), folder));
  }
  reader.finish();
  check_count(reader, arms);
  check_relations(arms, worlds);
  check_real_arms(safety, arms);
  if (arms.empty() && worlds.empty()) {
    reader.reject("", "expected at least one [[arm]] or [[world]], found neither");
  }
  if (out.safety && arms.empty()) {
    safety.reader.reject("", "expected an [[arm]] that it keeps safe, found none");
  }
  out.arms = values_of(arms);
  out.worlds = values_of(worlds);
  if (!inspect) return out;
  for (const Objection& objection : inspect(out)) {
    switch (objection.table) {
      case Objection::Table::Daemon:
        daemon.reader.object(objection.key, objection.message);
        break;
      case Objection::Table::Arm:
        arms.at(objection.index).reader.object(objection.key, objection.message);
        break;
      case Objection::Table::World:
        worlds.at(objection.index).reader.object(objection.key, objection.message);
        break;
    }
  }
  return out;
}

struct CloseFile {
  void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};

tl::unexpected<std::string> cannot(const std::string& verb) {
  return tl::unexpected<std::string>("cannot " + verb + ": " + std::strerror(errno));
}

tl::expected<std::string, std::string> read_file(const std::filesystem::path& path) {
  // Without O_NONBLOCK a FIFO that nobody writes to would be waited for.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (descriptor < 0) return cannot("open");
  const std::unique_ptr<std::FILE, CloseFile> file(::fdopen(descriptor, "rb"));
  if (!file) {
    ::close(descriptor);
    return tl::unexpected<std::string>("cannot open: out of memory");
  }
  struct stat found {};
  if (::fstat(descriptor, &found) != 0) return cannot("read");
  if (S_ISDIR(found.st_mode)) {
    return tl::unexpected<std::string>("expected a file, found a directory");
  }
  if (!S_ISREG(found.st_mode)) {
    return tl::unexpected<std::string>("expected a regular file, found a pipe or a device");
  }
  std::string text(kMaxFileBytes + 1, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  if (std::ferror(file.get()) != 0) {
    return cannot("read");
  }
  return text;
}

tl::unexpected<std::vector<ConfigError>> one_mistake(const std::filesystem::path& file,
                                                     std::string message) {
  return tl::unexpected<std::vector<ConfigError>>(
      std::vector<ConfigError>{{escaped(file.string()), 0, 0, "", std::move(message)}});
}

}  // namespace

ConfigResult parse(std::string_view text, const std::filesystem::path& file,
                   std::span<const std::string> overrides, const Inspector& inspect) {
  if (text.size() > kMaxFileBytes) {
    return one_mistake(file,
                       "expected at most " + std::to_string(kMaxFileBytes) + " bytes, found more");
  }
  Report report;
  std::optional<toml::table> root = parse_tree(text, file.string(), report);
  if (!root) return tl::unexpected<std::vector<ConfigError>>(report.take());
  for (const std::string& text_of : overrides) apply_override(*root, text_of, report);
  Config config = read_tree(*root, file, report, inspect);
  if (!report.is_empty()) return tl::unexpected<std::vector<ConfigError>>(report.take());
  return config;
}

tl::expected<std::string, std::vector<ConfigError>> read_text(const std::filesystem::path& file) {
  auto text = read_file(file);
  if (!text) return one_mistake(file, std::move(text.error()));
  return *std::move(text);
}

ConfigResult load(const std::filesystem::path& file, std::span<const std::string> overrides,
                  const Inspector& inspect) {
  auto text = read_text(file);
  if (!text) return tl::unexpected(std::move(text.error()));
  return parse(*text, file, overrides, inspect);
}

std::vector<std::string> schema_keys() {
  Report report;
  const auto root =
      parse_tree("arm = [{}]\nworld = [{material = [{}], shape = [{}]}]\n", "", report);
  static_cast<void>(read_tree(*root, "", report, {}));
  return {report.known_keys().begin(), report.known_keys().end()};
}

}  // namespace thimble::config
