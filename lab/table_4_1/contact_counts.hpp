#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lab/findings/findings.hpp"

// Whether a mean of table 4.1 is one of as many contacts as were asked for.
namespace thimble::lab {

struct ContactCount {
  std::string row;  // what is played in it
  std::uint64_t asked{0};
  std::uint64_t felt{0};
};

// Of the rows in which contacts are to be felt; names those that have fewer than were asked for.
// Not met without a row. Pure.
[[nodiscard]] Criterion contact_criterion(const std::vector<ContactCount>& rows);

}  // namespace thimble::lab
