#include "daemon/coupling/wave_channel.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::coupling {

void WaveInlet::send(Wave3 wave, double dt_s) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sums_.distance[axis] += wave[axis] * dt_s;
    sums_.joule[axis] += wave[axis] * wave[axis] * dt_s / 2;
  }
}

void WaveOutlet::restart(const WaveSums& before) noexcept {
  in_ = before;
  out_ = before;
}

void WaveOutlet::deliver(const WaveSums& newest) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (newest.joule[axis] < in_.joule[axis]) return;
  }
  in_ = newest;
}

Wave3 WaveOutlet::take(double dt_s) noexcept {
  Wave3 wave{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double distance = in_.distance[axis] - out_.distance[axis];
    const double joule = in_.joule[axis] - out_.joule[axis];
    const double most = std::abs(distance) / dt_s;
    if (!(most > 0) || !(joule > 0)) {
      out_.joule[axis] = std::max(out_.joule[axis], in_.joule[axis]);
      continue;
    }
    const double wanted = 2 * joule / std::abs(distance);
    if (wanted >= most) {
      out_.distance[axis] = in_.distance[axis];
      out_.joule[axis] = in_.joule[axis];
    } else {
      out_.distance[axis] += std::copysign(wanted * dt_s, distance);
      out_.joule[axis] += wanted * wanted * dt_s / 2;
    }
    wave[axis] = std::copysign(std::min(wanted, most), distance);
  }
  return wave;
}

}  // namespace thimble::coupling
