"""The same as in test_servo_calls.py with an arm on a serial port."""

import arms
import test_servo_calls


class Serial(test_servo_calls.Hid):
    """No library is between its bus and the kernel: the thread of the bus takes no memory either."""

    blocking_call = "write(", "</dev/ttyACM"
    libraries = ()
    test_its_safety_lines_are_read_by_a_thread_of_their_own = None

    @classmethod
    def plug_in(cls):
        return arms.TextArm(cls.guest, arms.FULL_HZ)
