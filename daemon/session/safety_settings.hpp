#pragma once

#include "daemon/config/config.hpp"
#include "daemon/safety/safety_chain.hpp"
#include "hal/bus/gpio_lines.hpp"

namespace thimble::session {

// The lines that a configuration names, in the order that the chain expects. Any thread; pure, and
// not RT: they allocate. Errors: none, the configuration is inspected before.
[[nodiscard]] bus::GpioClaim make_gpio_claim(const config::SafetyConfig& safety);
[[nodiscard]] safety::ChainSettings make_chain_settings(const config::SafetyConfig& safety);

}  // namespace thimble::session
