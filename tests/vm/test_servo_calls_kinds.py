"""The same as in test_servo_calls.py with an arm that is written to over hidraw and one on a serial port."""

import arms
import test_servo_calls


class Uhid(test_servo_calls.Hid):
    """It has no hiddev, as a HID device on Bluetooth has none: what leaves for it takes hidraw."""

    blocking_call = "write(", "</dev/hidraw"
    test_its_safety_lines_are_read_by_a_thread_of_their_own = None

    @classmethod
    def plug_in(cls):
        return arms.HidArm(cls.guest, rate_hz=arms.FULL_HZ)


class Serial(test_servo_calls.Hid):
    """No library is between its bus and the kernel: the thread of the bus takes no memory either."""

    blocking_call = "write(", "</dev/ttyACM"
    libraries = ()
    test_its_safety_lines_are_read_by_a_thread_of_their_own = None

    @classmethod
    def plug_in(cls):
        return arms.TextArm(cls.guest, arms.FULL_HZ)
