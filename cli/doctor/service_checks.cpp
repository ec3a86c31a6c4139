#include "cli/doctor/checks.hpp"

namespace thimble::doctor {
namespace {

constexpr int kWrongConfiguration = 2;  // daemon/app/exit_code.hpp

Verdict failed_service(const cli::ServiceState& service) {
  Verdict verdict{Level::Wrong,
                  "service",
                  "thimbled.service has failed (" + service.result + ")",
                  "systemd starts it no more by itself, and without it no arm has a force",
                  "sudo systemctl restart thimbled",
                  "once what the journal says is mended",
                  "journalctl -u thimbled -n 30"};
  if (service.exit_status != kWrongConfiguration) return verdict;
  verdict.finding = "thimbled.service has failed: its configuration is wrong";
  return verdict;
}

// It is good, and something is missing that its arms will need.
std::vector<Verdict> doubts_about(const ConfigurationFile& said) {
  std::vector<Verdict> all;
  for (const std::string& doubt : said.doubts) {
    all.push_back({Level::Warn, "configuration", doubt,
                   "the daemon starts with it, and says the same", "", "",
                   "thimbled --check --config '" + said.file + "'"});
  }
  return all;
}

std::string all_of(const std::vector<std::string>& sentences) {
  std::string all;
  for (const std::string& sentence : sentences) all += (all.empty() ? "" : "; ") + sentence;
  return all;
}

}  // namespace

std::vector<Verdict> check_service(const Facts& facts) {
  if (!facts.service) return {};
  const cli::ServiceState& service = *facts.service;
  if (service.active == "active") return {all_well("service", "thimbled.service is active")};
  if (service.active == "failed") return {failed_service(service)};
  Verdict verdict{Level::Warn,
                  "service",
                  "thimbled.service is " + service.active,
                  "without it no arm has a force, unless a thimbled is started otherwise",
                  "",
                  "one that starts again and again fails each time: the journal says why",
                  "journalctl -u thimbled -n 30"};
  if (service.active != "inactive") return {verdict};
  verdict.command = "sudo systemctl start thimbled";
  verdict.advice.clear();
  verdict.look_with = "systemctl status thimbled";
  return {verdict};
}

std::vector<Verdict> check_configuration(const Facts& facts) {
  const ConfigurationFile& said = facts.configuration;
  if (said.file.empty()) return {};
  Verdict verdict{Level::Wrong,
                  "configuration",
                  "",
                  "the daemon does not start with it, or goes "
                  "without one of its arms",
                  "",
                  "",
                  "thimbled --check --config '" + said.file + "'"};
  if (!said.may_service_read) {
    verdict.finding = said.file + " cannot be read by the service";
    verdict.command = "sudo chgrp thimble " + said.file + " && sudo chmod 640 " + said.file;
    verdict.look_with = "ls -l " + said.file;
    return {verdict};
  }
  if (said.is_hidden) {
    verdict.level = Level::Warn;
    verdict.finding = said.file + " may not be read by who asks, and was not looked at";
    verdict.reason = "a mistake in it keeps the daemon from starting";
    verdict.advice = "root may read it";
    verdict.look_with = "sudo thimble doctor";
    return {verdict};
  }
  if (said.mistakes.empty() && !said.doubts.empty()) return doubts_about(said);
  if (said.mistakes.empty()) return {all_well("configuration", said.file + " is good")};
  verdict.finding = all_of(said.mistakes);
  verdict.advice = "correct the file, then start the service again";
  return {verdict};
}

}  // namespace thimble::doctor
