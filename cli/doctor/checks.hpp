#pragma once

#include <vector>

#include "cli/doctor/facts.hpp"
#include "cli/doctor/verdict.hpp"

// Each check is a pure function of the facts. Thread: any. Not RT.
namespace thimble::doctor {

// Of the machine.
[[nodiscard]] Verdict check_kernel(const Facts& facts);
[[nodiscard]] Verdict check_realtime_share(const Facts& facts);
[[nodiscard]] Verdict check_clock_source(const Facts& facts);
[[nodiscard]] Verdict check_governor(const Facts& facts);

// Of what starts the daemon; nothing where it is not known.
[[nodiscard]] std::vector<Verdict> check_service(const Facts& facts);
[[nodiscard]] std::vector<Verdict> check_configuration(const Facts& facts);

// Of the daemon that runs, or of who asks.
[[nodiscard]] Verdict check_daemon(const Facts& facts);
[[nodiscard]] Verdict check_group(const Facts& facts);
[[nodiscard]] Verdict check_rtprio(const Facts& facts);
[[nodiscard]] Verdict check_memlock(const Facts& facts);
[[nodiscard]] Verdict check_dma_latency(const Facts& facts);

// Where none is plugged in.
[[nodiscard]] Verdict check_arms(const Facts& facts);
// Of one that the configuration names.
[[nodiscard]] Verdict check_configured_arm(const Facts& facts, const ConfiguredArm& arm);
// Of one arm that is plugged in.
[[nodiscard]] Verdict check_node(const Facts& facts, const Controller& controller);
// Of one of its raw_nodes: who may command the arm around the daemon.
[[nodiscard]] Verdict check_raw_node(const Facts& facts, const Controller& controller,
                                     const Node& node);
[[nodiscard]] Verdict check_usb_speed(const Controller& controller);
[[nodiscard]] Verdict check_usb_port(const Controller& controller);
[[nodiscard]] Verdict check_usb_power(const Controller& controller);
[[nodiscard]] Verdict check_holders(const Facts& facts, const Controller& controller);

// Of [safety]: its chip, then each of its lines; nothing where no configuration has it.
[[nodiscard]] std::vector<Verdict> check_safety(const Facts& facts);

// All of them, in the order in which they are best mended.
[[nodiscard]] std::vector<Verdict> examine(const Facts& facts);

}  // namespace thimble::doctor
