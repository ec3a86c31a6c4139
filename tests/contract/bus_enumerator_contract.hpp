#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "hal/bus/bus_enumerator.hpp"

namespace thimble::test {

// One implementation of bus::BusEnumerator with one device, of any kind, that can be pulled and put
// back; one of USB has a bulk endpoint UsbRig::kBulkIn. The device is present before the enumerator
// is made ready: pending events are drained.
class BusRig {
 public:
  virtual ~BusRig() = default;
  virtual bus::BusEnumerator& buses() = 0;
  [[nodiscard]] virtual bus::DeviceAddress address() const = 0;
  [[nodiscard]] virtual bus::BusKind kind() const { return bus::BusKind::Hid; }
  virtual void unplug() = 0;
  virtual void replug() = 0;
  virtual void settle() = 0;  // until arrivals and departures have been noticed
  // Whether it is so; where devices have threads of their own, whether it becomes so.
  virtual bool comes_true(const std::function<bool()>& claim) { return claim(); }
};

struct BusRigFactory {
  std::string name;
  std::unique_ptr<BusRig> (*make)();
  friend void PrintTo(const BusRigFactory& factory, std::ostream* out) { *out << factory.name; }
};

// What every bus::BusEnumerator promises.
class BusEnumeratorContract : public testing::TestWithParam<BusRigFactory> {
 protected:
  BusEnumeratorContract();
  std::unique_ptr<BusRig> rig = GetParam().make();
};

inline std::string bus_rig_name(const testing::TestParamInfo<BusRigFactory>& rig) {
  return rig.param.name;
}

}  // namespace thimble::test
