"""The contract suites of HID and USB devices, their enumerator, serial ports and GPIO lines over a real kernel: hidapi, libusb, libudev and libgpiod as they are, on devices
that hang on uhid and vhci-hcd; the serial port is a modem under the kernel's cdc_acm, the GPIO chip is a CP2112 under the kernel's own driver.

What the same suites say of the simulated buses, and of ours over stand-ins for the libraries, runs on any machine: tests/contract.
"""

import re
import sys

import guest


# kernel_gpio_rig.cpp says why.
NOT_ON_THIS_RIG = {"ALostEdgeLeavesAHoleInTheNumbers", "TheLevelTellsWhatALostEdgeDidNot", "ALineThatIsTakenAwayTakesTheOthersWithIt"}


class Contract(guest.GuestTest):
    pace = guest.COUNTED
    runs_daemon = False

    def test_every_sentence_of_the_suites_is_true(self):
        for suite, least in (("HidDeviceContract", 24), ("BusEnumeratorContract", 36), ("UsbDeviceContract", 31),
                             ("SerialPortContract", 13), ("GpioLinesContract", 12)):
            with self.subTest(suite):
                status, printed = self.guest.ask(f"/run/bin/kernel_contract --gtest_filter='*{suite}*' 2>&1 | tail -n 100; "
                                                 "exit ${PIPESTATUS[0]}", timeout_s=600)
                self.assertEqual(status, 0, printed)
                self.assertGreaterEqual(int(re.search(r"\[  PASSED  \] (\d+) test", printed)[1]), least)
                skipped = set(re.findall(r"^\[  SKIPPED \] \w+/\w+\.(\w+)", printed, re.MULTILINE))
                print(f"{suite}: skipped {sorted(skipped)}", file=sys.stderr)
                self.assertLessEqual(skipped, NOT_ON_THIS_RIG)
