"""The contract suites of HID and USB devices, their enumerator, serial ports and GPIO lines over a real kernel: hidapi, libusb, libudev and libgpiod as they are, on devices
that hang on uhid and vhci-hcd; the serial port is a modem under the kernel's cdc_acm, the GPIO chips are a CP2112 under the kernel's own driver and one of gpio-sim.

What the same suites say of the simulated buses, and of ours over stand-ins for the libraries, runs on any machine: tests/contract.
"""

import re
import sys

import gpio_sim
import guest


# kernel_gpio_rig.cpp and kernel_gpio_sim_rig.cpp say why.
NOT_ON_A_KERNEL = {"ALostEdgeLeavesAHoleInTheNumbers", "TheLevelTellsWhatALostEdgeDidNot", "ALineThatIsTakenAwayTakesTheOthersWithIt"}
NOT_ON_GPIO_SIM = {"AChipThatIsPulledOutIsGoneForItsLinesAndCanBeOpenedWhenItIsBack", "AChipThatAnswersNothingShowsInItsAgeAndInItsOutputs", "SoDoesOneThatRefusesWhatItIsAskedFor"}


class Contract(guest.GuestTest):
    pace = guest.COUNTED
    runs_daemon = False

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        gpio_sim.load(cls.guest)

    def play(self, program, tests, least, not_played=frozenset()):
        status, printed = self.guest.ask(f"LD_LIBRARY_PATH=/run/bin /run/bin/{program} --gtest_filter='{tests}' 2>&1 | tail -n 100; "
                                         "exit ${PIPESTATUS[0]}", timeout_s=600)
        self.assertEqual(status, 0, printed)
        self.assertGreaterEqual(int(re.search(r"\[  PASSED  \] (\d+) test", printed)[1]), least)
        skipped = set(re.findall(r"^\[  SKIPPED \] \w+/\w+\.(\w+)", printed, re.MULTILINE))
        print(f"{program} {tests}: skipped {sorted(skipped)}", file=sys.stderr)
        self.assertLessEqual(skipped, not_played)

    def test_every_sentence_of_the_suites_is_true(self):
        for suite, least in (("HidDeviceContract", 24), ("BusEnumeratorContract", 36), ("UsbDeviceContract", 31), ("SerialPortContract", 13)):
            with self.subTest(suite):
                self.play("kernel_contract", f"*{suite}*", least)

    def test_so_is_that_of_gpio_lines_on_a_chip_without_edges(self):
        self.play("kernel_contract", "*GpioLinesContract*/Cp2112", 12, NOT_ON_A_KERNEL)

    def test_so_it_is_on_one_whose_edges_the_kernel_tells(self):
        self.play("kernel_contract", "*GpioLinesContract*/GpioSim:KernelGpio.*", 11, NOT_ON_A_KERNEL | NOT_ON_GPIO_SIM)

    def test_so_it_is_with_libgpiod_2(self):
        if not (guest.BIN / "kernel_contract_gpiod2").exists():
            self.skipTest("there is no libgpiod 2: the backports were not reached when the guest's root was made; rm -r ~/.cache/thimble/vm, and the next ./run vm tries again")
        self.play("kernel_contract_gpiod2", "*", 11, NOT_ON_A_KERNEL | NOT_ON_GPIO_SIM)
