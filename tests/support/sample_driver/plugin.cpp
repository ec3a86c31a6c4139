#include "gantry_parts.hpp"

namespace {

const thimble_model* const kModels[] = {&gantry::kModel};

}  // namespace

// NOLINTNEXTLINE: the one name that is exported.
THIMBLE_PLUGIN = {THIMBLE_PLUGIN_MAGIC,
                  THIMBLE_PLUGIN_ABI_VERSION,
                  THIMBLE_PLUGIN_ABI_REVISION,
                  sizeof(thimble_plugin),
                  &gantry::kDriver,
                  kModels,
                  1,
                  0,
                  nullptr};
