#include "lab/table_4_1/contact_counts.hpp"

namespace thimble::lab {

Criterion contact_criterion(const std::vector<ContactCount>& rows) {
  Criterion criterion{
      "each row, but the finger's, streamed, at 500 ms, has the contacts that were asked for",
      !rows.empty()};
  for (const ContactCount& row : rows) {
    if (row.felt >= row.asked) continue;
    criterion.text += criterion.is_met ? ": not " : "; ";
    criterion.text +=
        row.row + " (" + std::to_string(row.felt) + " of " + std::to_string(row.asked) + ")";
    criterion.is_met = false;
  }
  return criterion;
}

}  // namespace thimble::lab
