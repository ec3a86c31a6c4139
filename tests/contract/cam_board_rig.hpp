#pragma once

#include <memory>
#include <ostream>
#include <string>

#include "hal/base/time.hpp"
#include "hal/device/cam_board.hpp"

namespace thimble::test {

// One implementation of CamBoard with time, and a plug that can be pulled.
class CamBoardRig {
 public:
  virtual ~CamBoardRig() = default;
  virtual CamBoard& board() = 0;
  virtual CamGeometry geometry() = 0;  // a space that fits it: at least 8 x 4 x 2 cells
  virtual MonotonicTime now() = 0;
  virtual void pass(Duration time) = 0;
  virtual void unplug() = 0;
};

// How the suite makes a fresh rig for every test.
struct CamBoardRigFactory {
  std::string name;
  std::unique_ptr<CamBoardRig> (*make)();
  friend void PrintTo(const CamBoardRigFactory& factory, std::ostream* out) {
    *out << factory.name;
  }
};

}  // namespace thimble::test
