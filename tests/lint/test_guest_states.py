import contextlib
import io
import pathlib
import sys
import unittest
from unittest import mock

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "vm"))
import guest_states  # noqa: E402
import machine  # noqa: E402
import qmp  # noqa: E402


class GuestStates(unittest.TestCase):
    def start(self, pace, **resumes):
        """What start() gives, and what it says; where nothing boots or resumes but by name."""
        said = io.StringIO()
        self.booted = mock.Mock(spec=machine.Guest)
        with mock.patch.object(guest_states, "boot", return_value=self.booted), \
                mock.patch.object(guest_states, "resume", **resumes), contextlib.redirect_stderr(said):
            return guest_states.start("amd64", pace), said.getvalue()

    def test_where_time_is_counted_it_goes_on(self):
        self.assertEqual(self.start(machine.COUNTED, return_value="resumed"), ("resumed", ""))

    def test_where_it_passes_as_it_comes_it_boots(self):
        started, said = self.start(machine.AS_IT_COMES, return_value="resumed")
        self.assertEqual((started, said), (self.booted, ""))

    def test_where_nothing_can_be_saved_it_boots_has_what_devices_hang_on_and_says_why(self):
        for error in (OSError("no space"), machine.GuestError("no space"), qmp.QmpError("no space")):
            with self.subTest(type(error)):
                started, said = self.start(machine.COUNTED, side_effect=error)
                self.assertIs(started, self.booted)
                self.assertIn("uhid vhci-hcd", started.run.call_args.args[0])
                self.assertIn("boots: no space", said)
