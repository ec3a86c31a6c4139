#pragma once

#include <algorithm>
#include <initializer_list>

#include "hal/base/result.hpp"

namespace thimble::test {

// What `open` gives, asked again while it is refused by one of `codes`: what a stalled machine had
// not read, opened or closed within a bus's patience is had at a later look, as a daemon's.
template <class Open>
auto look_again(std::initializer_list<Errc> codes, const Open& open, int most_looks = 40) {
  auto opened = open();
  for (int looks = 1; looks < most_looks && !opened; ++looks) {
    if (std::find(codes.begin(), codes.end(), opened.error().code) == codes.end()) break;
    opened = open();
  }
  return opened;
}

}  // namespace thimble::test
