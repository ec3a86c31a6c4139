#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/cam_board_contract.hpp"
#include "tests/support/usb_cam_board.hpp"

namespace thimble::test {
namespace {

// The driver over a simulated slot of PCI.
class PciCamBoardRig final : public CamBoardRig {
 public:
  PciCamBoardRig(const sim::cam::TorusShape& shape, const CamGeometry& geometry, bool is_paced)
      : geometry_(geometry),
        slot_(clock_,
              {.shape = shape, .window_bytes = std::size_t{1} << 22, .is_paced = is_paced}) {}
  CamBoard& board() override { return board_; }
  CamGeometry geometry() override { return geometry_; }
  MonotonicTime now() override { return clock_.now(); }
  void pass(Duration time) override { clock_.run_for(time); }
  void unplug() override { slot_.unplug(); }

 private:
  sim::VirtualClock clock_;
  CamGeometry geometry_;
  sim::cam::SimCamBoard slot_;
  cambus::Board board_{cambus::PciPort::open(slot_.open_window(), clock_.now()).value()};
};

// And over a simulated USB bus.
class UsbCamBoardRig final : public CamBoardRig {
 public:
  UsbCamBoardRig(const sim::cam::TorusShape& shape, const CamGeometry& geometry, bool is_paced)
      : geometry_(geometry),
        plug_(clock_,
              {.shape = shape, .window_bytes = std::size_t{1} << 22, .is_paced = is_paced}) {}
  CamBoard& board() override { return board_; }
  CamGeometry geometry() override { return geometry_; }
  MonotonicTime now() override { return clock_.now(); }
  void pass(Duration time) override { clock_.run_for(time); }
  void unplug() override { plug_.unplug(); }

 private:
  sim::VirtualClock clock_;
  CamGeometry geometry_;
  sim::cam::SimUsbCamBoard plug_;
  cambus::Board board_{open_usb_port(plug_, clock_)};
};

std::unique_ptr<CamBoardRig> one_module() {
  return std::make_unique<PciCamBoardRig>(sim::cam::TorusShape{{1, 1, 1}, 8},
                                          CamGeometry{{4, 3, 1}, CamDivision::Mesh}, true);
}
std::unique_ptr<CamBoardRig> eight_in_strips() {
  return std::make_unique<PciCamBoardRig>(sim::cam::TorusShape{{2, 2, 2}, 6},
                                          CamGeometry{{3, 5, 1}, CamDivision::StripY}, true);
}
std::unique_ptr<CamBoardRig> eight_as_mesh() {
  return std::make_unique<PciCamBoardRig>(sim::cam::TorusShape{{2, 2, 2}, 6},
                                          CamGeometry{{3, 3, 2}, CamDivision::Mesh}, false);
}
std::unique_ptr<CamBoardRig> one_module_on_usb() {
  return std::make_unique<UsbCamBoardRig>(sim::cam::TorusShape{{1, 1, 1}, 8},
                                          CamGeometry{{4, 3, 1}, CamDivision::Mesh}, true);
}
std::unique_ptr<CamBoardRig> eight_on_usb() {
  return std::make_unique<UsbCamBoardRig>(sim::cam::TorusShape{{2, 2, 2}, 6},
                                          CamGeometry{{3, 3, 2}, CamDivision::Mesh}, false);
}

INSTANTIATE_TEST_SUITE_P(Device, CamBoardContract,
                         testing::Values(CamBoardRigFactory{"OneModule", &one_module},
                                         CamBoardRigFactory{"EightInStrips", &eight_in_strips},
                                         CamBoardRigFactory{"EightAsMesh", &eight_as_mesh},
                                         CamBoardRigFactory{"OneModuleOnUsb", &one_module_on_usb},
                                         CamBoardRigFactory{"EightOnUsb", &eight_on_usb}),
                         cam_board_rig_name);

}  // namespace
}  // namespace thimble::test
