#include "cli/doctor/doctor.hpp"

#include <iostream>

#include "cli/commands.hpp"
#include "cli/doctor/checks.hpp"
#include "cli/doctor/load_plugins.hpp"
#include "cli/doctor/read_facts.hpp"
#include "cli/doctor/report.hpp"

namespace thimble::doctor {

int run_doctor(const DoctorOptions& options) {
  session::Plugins plugins;
  if (!load_plugins(plugins, options.plugins)) return cli::kExitRefused;
  const std::vector<Verdict> verdicts = examine(read_facts(options.root, plugins.drivers));
  std::cout << (options.is_json ? to_json(verdicts) : render(verdicts));
  return is_something_wrong(verdicts) ? cli::kExitRefused : cli::kExitOk;
}

}  // namespace thimble::doctor
