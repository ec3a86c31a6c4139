#pragma once

#include <thimble/plugin_abi.h>

namespace gantry {

extern const thimble_driver kDriver;
extern const thimble_model kModel;

}  // namespace gantry
