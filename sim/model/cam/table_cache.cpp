#include "sim/model/cam/table_cache.hpp"

#include <algorithm>

namespace thimble::sim::cam {

std::shared_ptr<const PreparedTable> TableCache::prepare(std::span<const std::uint16_t> entries) {
  const auto found = std::find_if(tables_.begin(), tables_.end(), [&](const auto& table) {
    return std::equal(entries.begin(), entries.end(), table->entries.begin());
  });
  if (found != tables_.end()) {
    tables_.splice(tables_.begin(), tables_, found);
    return tables_.front();
  }
  auto table = std::make_shared<PreparedTable>();
  table->entries.assign(entries.begin(), entries.end());
  table->shape = shape_of(entries);
  table->rule = compile_rule(entries, kernels_->worth_ops);
  if (table->rule && !does_as_table(*table->rule, entries, *kernels_)) table->rule.reset();
  tables_.push_front(std::move(table));
  if (tables_.size() > kTables) tables_.pop_back();
  return tables_.front();
}

}  // namespace thimble::sim::cam
