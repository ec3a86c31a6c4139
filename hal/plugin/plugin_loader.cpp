#include "hal/plugin/plugin_loader.hpp"

#include <dlfcn.h>
#include <link.h>

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "hal/plugin/abi_text.hpp"
#include "hal/plugin/loaded_object.hpp"
#include "hal/plugin/plugin_check.hpp"
#include "hal/plugin/plugin_driver.hpp"
#include "hal/plugin/plugin_file.hpp"
#include "hal/plugin/plugin_model.hpp"
#include "hal/plugin/plugin_usb_driver.hpp"
#include "hal/plugin/plugin_whole.hpp"

namespace thimble::plugin {
namespace {

// The object that has `address` in one of its segments, or nullptr.
const link_map* object_of(const void* address) {
  Dl_info info{};
  void* object = nullptr;
  if (dladdr1(address, &info, &object, RTLD_DL_LINKMAP) == 0) return nullptr;
  return static_cast<const link_map*>(object);
}

// The linker's own word for what the symbol is and how large; nullptr when it has none.
const ElfW(Sym) * symbol_at(const void* address) {
  Dl_info info{};
  void* symbol = nullptr;
  if (dladdr1(address, &info, &symbol, RTLD_DL_SYMENT) == 0) return nullptr;
  const bool is_ours = info.dli_saddr == address && info.dli_sname != nullptr &&
                       std::string_view(info.dli_sname) == THIMBLE_PLUGIN_SYMBOL;
  return is_ours ? static_cast<const ElfW(Sym)*>(symbol) : nullptr;
}

std::string reason_of(const char* said, const std::string& path) {
  std::string reason = said == nullptr ? "no reason given" : said;
  if (reason.starts_with(path + ": ")) reason.erase(0, path.size() + 2);
  return reason;
}

// The linker's chain is in the order of loading: behind an object come the libraries that it
// brought, and what came later.
Result<void> check_libraries(void* handle) {
  const link_map* object = nullptr;
  if (dlinfo(handle, RTLD_DI_LINKMAP, &object) != 0) return {};
  for (const link_map* next = object->l_next; next != nullptr; next = next->l_next) {
    const auto trusted = trusted_plugin_path(next->l_name);
    if (!trusted) {
      return tl::unexpected(trusted.error().in(std::string("needs the library ") + next->l_name));
    }
  }
  return {};
}

Result<const thimble_plugin*> descriptor_in(void* handle) {
  const void* found = dlsym(handle, THIMBLE_PLUGIN_SYMBOL);
  const link_map* object = nullptr;
  if (found == nullptr || dlinfo(handle, RTLD_DI_LINKMAP, &object) != 0 ||
      object_of(found) != object) {
    return fail(Errc::Malformed, "is no plugin: it does not export " THIMBLE_PLUGIN_SYMBOL);
  }
  const auto* symbol = symbol_at(found);
  if (symbol == nullptr || ELF64_ST_TYPE(symbol->st_info) != STT_OBJECT ||
      reinterpret_cast<std::uintptr_t>(found) % alignof(thimble_plugin) != 0) {
    return fail(Errc::Malformed, "is no plugin: its " THIMBLE_PLUGIN_SYMBOL " is not data");
  }
  const auto* plugin = static_cast<const thimble_plugin*>(found);
  const auto checked = check_plugin(
      *plugin, symbol->st_size,
      [segments = segments_of(*object)](const void* start, std::size_t bytes, Access access) {
        return is_in(segments, start, bytes, access);
      });
  if (!checked) return tl::unexpected(checked.error());
  return plugin;
}

}  // namespace

Result<const thimble_plugin*> load_plugin(const std::string& path) {
  const auto file = trusted_plugin_path(path);
  if (!file) return tl::unexpected(file.error().in(path));
  const auto whole = check_object_is_whole(*file);
  if (!whole) return tl::unexpected(whole.error().in(path));
  void* handle = dlopen(file->c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (handle == nullptr) {
    return fail(Errc::Malformed, path + ": cannot be loaded: " + reason_of(dlerror(), *file));
  }
  const auto libraries = check_libraries(handle);
  if (!libraries) return tl::unexpected(libraries.error().in(path));
  auto plugin = descriptor_in(handle);
  if (!plugin) return tl::unexpected(plugin.error().in(path));
  return plugin;
}

Result<void> register_plugin(const thimble_plugin& plugin, DriverRegistry& drivers,
                             SimModelRegistry& models) {
  const thimble_usb_driver* const usb_driver = usb_driver_of(plugin);
  std::vector<std::string> names;
  if (plugin.driver != nullptr) names.push_back(text_of(plugin.driver->name));
  if (usb_driver != nullptr) names.push_back(text_of(usb_driver->name));
  for (const std::string& name : names) {
    if (!drivers.is_from_outside(name)) continue;
    return fail(Errc::InvalidArgument, "there is a driver '" + name + "' from outside already");
  }
  for (std::uint32_t i = 0; i < plugin.model_count; ++i) {
    const std::string model = text_of(plugin.models[i]->name);
    if (models.find(model) != nullptr) {
      return fail(Errc::InvalidArgument, "there is a model '" + model + "' already");
    }
  }
  if (plugin.driver != nullptr) drivers.add_from_outside(make_plugin_driver(*plugin.driver));
  if (usb_driver != nullptr) drivers.add_from_outside(make_plugin_usb_driver(*usb_driver));
  for (std::uint32_t i = 0; i < plugin.model_count; ++i) {
    models.add(plugin_model_entry(*plugin.models[i]));
  }
  return {};
}

}  // namespace thimble::plugin
