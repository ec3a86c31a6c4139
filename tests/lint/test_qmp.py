import json
import pathlib
import socket
import sys
import threading
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "vm"))
import qmp  # noqa: E402

EVENT = {"event": "STOP"}
DONE = {"event": "JOB_STATUS_CHANGE", "data": {"status": "concluded", "id": "job"}}


class Qmp(unittest.TestCase):
    def answer(self, *messages):
        """A monitor on an emulator that greets, and says these; a list is what it says at once to a command."""
        ours, theirs = socket.socketpair()
        self.heard = []
        self.addCleanup(theirs.close)

        def talk():
            lines = theirs.makefile("rb")
            theirs.sendall(b'{"QMP": {}}\n')
            for said in ([{"return": {}}], *messages):
                self.heard.append(json.loads(lines.readline()))
                theirs.sendall(b"".join(json.dumps(message).encode() + b"\n" for message in said))
            theirs.shutdown(socket.SHUT_RDWR)

        thread = threading.Thread(target=talk)
        thread.start()
        self.addCleanup(thread.join)
        monitor = qmp.Monitor(ours)
        self.addCleanup(monitor.close)
        return monitor

    def test_a_command_has_its_words_and_its_answer(self):
        monitor = self.answer([{"return": 7}])
        self.assertEqual(monitor.execute("blockdev-add", node_name="n"), 7)
        self.assertEqual(self.heard[1], {"execute": "blockdev-add", "arguments": {"node-name": "n"}})

    def test_what_is_refused_has_its_reason(self):
        monitor = self.answer([{"error": {"desc": "no such thing"}}])
        with self.assertRaisesRegex(qmp.QmpError, "x: no such thing"):
            monitor.execute("x")

    def test_an_emulator_that_ends_is_told(self):
        monitor = self.answer([])
        with self.assertRaisesRegex(qmp.QmpError, "ended"):
            monitor.execute("x")

    def test_a_job_ends_when_it_says_so_before_or_after_its_answer(self):
        for said in ([EVENT, DONE, {"return": {}}], [{"return": {}}, EVENT, DONE]):
            with self.subTest(said):
                monitor = self.answer(said, [{"return": [{"id": "job", "status": "concluded"}]}], [{"return": {}}])
                monitor.run_job("blockdev-create")
                self.assertEqual([heard["execute"] for heard in self.heard[1:]], ["blockdev-create", "query-jobs", "job-dismiss"])

    def test_a_job_that_fails_has_its_reason(self):
        monitor = self.answer([{"return": {}}, DONE], [{"return": [{"id": "job", "error": "no space"}]}], [{"return": {}}])
        with self.assertRaisesRegex(qmp.QmpError, "blockdev-backup: no space"):
            monitor.run_job("blockdev-backup")
