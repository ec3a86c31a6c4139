#!/usr/bin/env python3
"""Runs one file of guest tests for ctest: run_vm_test.py test_boot. Status 77, with the reason, where there can be no guest.

run_vm_test.py --save PACE makes the saved guest that tests of this pace start from; PACE: its name in machine.py; or bare, without the packages.
"""

import os
import sys
import unittest

import guest_image
import guest_states
import machine

SKIPPED = 77  # SKIP_RETURN_CODE of CMakeLists.txt


def obstacle():
    """Why there is no guest here; empty when there is."""
    if os.environ.get("THIMBLE_NO_VM"):
        return os.environ["THIMBLE_NO_VM"]
    if guest_image.missing():
        return f"no guest without {', '.join(guest_image.missing())}: ./run vm installs what it can"
    if not guest_image.image_folder().exists():
        return "the guest's root is not made: ./run vm makes it"
    if not list(machine.DEBS.glob("*.deb")):
        return "there are no packages to install: ./run vm makes them"
    return ""


if __name__ == "__main__":
    REASON = obstacle()
    if REASON:
        print(f"Skipped\n{REASON}")
        sys.exit(SKIPPED)
    if sys.argv[1] == "--save":
        guest_states.prepare(sys.argv[2])
        sys.exit()
    PROGRAM = unittest.main(module=sys.argv[1], argv=["vm", "-v"], exit=False)
    sys.exit(0 if PROGRAM.result.testsRun > 0 and PROGRAM.result.wasSuccessful() else f"{PROGRAM.result.testsRun} tests")
