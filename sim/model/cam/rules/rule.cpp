#include "sim/model/cam/rules/rule.hpp"

#include <algorithm>

namespace thimble::sim::cam {
namespace {

std::vector<Rule> make_rules() {
  std::vector<Rule> all;
  add_counting_rules(all);
  add_gas_rules(all);
  add_block_rules(all);
  add_spin_rules(all);
  std::sort(all.begin(), all.end(), [](const Rule& a, const Rule& b) { return a.name < b.name; });
  return all;
}

}  // namespace

std::span<const Rule> rules() {
  static const std::vector<Rule> kRules = make_rules();
  return kRules;
}

const Rule* find_rule(std::string_view name) {
  const auto all = rules();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Rule& rule) { return rule.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<std::uint16_t> table_of(SiteFunction function) {
  std::vector<std::uint16_t> table(65536);
  for (std::uint32_t site = 0; site < table.size(); ++site) {
    table[site] = static_cast<std::uint16_t>(function(site));
  }
  return table;
}

std::vector<std::uint16_t> table_of(const Rule& rule) { return table_of(rule.function); }

}  // namespace thimble::sim::cam
