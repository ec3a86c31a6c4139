"""Pieces on a CAM board in a slot of PCI: its memory is a BAR of the guest and a file of the host, where a process beside QEMU plays the board. The daemon,
which has no right to open it, gets it from thimble-board. The same moves lead to the same as on a board within the daemon.
"""

import pathlib
import shutil
import subprocess
import tempfile

import guest
import machine
import pieces

BAR = 2  # ivshmem-plain's memory


class Slot:
    """What stands behind the BAR."""

    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="thimble-slot-"))
        self.memory = self.folder / "bar"
        self.memory.write_bytes(bytes(machine.SLOT_BYTES))
        self.process = None

    def insert(self):
        self.process = subprocess.Popen([machine.BIN / "board_in_slot", self.memory], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        assert self.process.stdout.readline() == b"in its slot\n"

    def close(self):
        if self.process is not None:
            self.process.communicate()
        shutil.rmtree(self.folder)


class CamPci(pieces.Pieces):
    """Numbered: each test goes on where the one before it ended.

    The board knows nothing of the guest's clock, which leaps. But it never leaps further than to an arm's next frame, and a second of an arm takes the
    host about a second: the board has its time, on a busy host, too (decision 0467).
    """

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.slot = Slot()
        cls.addClassCleanup(cls.slot.close)
        cls.address = cls.guest.put_into_slot(cls.slot.memory)

    def test_1_without_a_word_of_the_administrators_there_is_no_helper(self):
        self.assertEqual(self.guest.ask("test -e /run/thimble-board.sock")[0], 1)
        self.start("pci", is_there=False)
        self.assertIn("thimble-board.socket", self.trouble())

    def test_2_a_slot_without_a_board_is_not_handed_over(self):
        self.guest.run(f"echo 'BOARD={self.address} {BAR}' > /etc/default/thimble-board; systemctl restart thimble-board.socket")
        self.assertEqual(self.guest.run("stat -c '%U:%G %a' /run/thimble-board.sock").strip(), "root:thimble 660")
        self.guest.wait_for("journalctl -u 'thimble-board@*' | grep -q 'no CAM board answers'")
        self.guest.wait_for("thimble status --json | grep -q \"world 'desk': no CAM board in a slot\"")

    def test_3_pieces_on_it_are_grasped_moved_and_dropped(self):
        self.slot.insert()
        self.wait_for_board(is_there=True)
        pid = self.properties("MainPID")["MainPID"]
        self.assertEqual(self.guest.run(f"stat -c %U /proc/{pid}").strip(), "thimble")
        self.assertIn(f"{self.address}/resource{BAR}", self.guest.run(f"cat /proc/{pid}/maps"))
        type(self).played = self.play()
        self.assert_grasped_moved_and_dropped(self.played)

    def test_4_nobody_else_may_ask_for_it(self):
        self.guest.run("useradd --groups thimble-users visitor")
        status, said = self.guest.ask("setpriv --reuid visitor --regid visitor --init-groups python3 -c 'import socket; "
                                      "socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET).connect(\"/run/thimble-board.sock\")'")
        self.assertEqual(status, 1)
        self.assertIn("PermissionError", said)

    def test_5_on_a_board_within_the_daemon_the_same_moves_lead_to_the_same(self):
        self.start("sim")
        self.assertEqual(self.play(), self.played)
