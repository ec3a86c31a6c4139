"""thimble-simdev from outside, over USB/IP, which needs no rights; through uhid it is tried in the guest (tests/vm)."""

import json
import re
import shutil
import signal
import socket
import struct
import subprocess
import zlib

from rig import BIN, SAMPLE, TIMEOUT_S, ProcessTest, clean_environment, die_with_parent

DESCRIPTOR_OF_DEVICE = bytes([0x80, 6, 0, 1, 0, 0, 18, 0])


class Simdev(ProcessTest):
    def offer(self, model, *options):
        """A running one: its process and the port at which it is offered."""
        process = subprocess.Popen([BIN / "thimble-simdev", "--usbip", "0", "--socket", self.folder / "verbs", *options, model],
                                   stdout=subprocess.PIPE, text=True, env=clean_environment(), preexec_fn=die_with_parent)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        line = process.stdout.readline()
        return process, int(re.search(r"at port (\d+), serial number", line).group(1))

    def say(self, *verbs):
        answers = []
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as channel:
            channel.settimeout(TIMEOUT_S)
            channel.connect(str(self.folder / "verbs"))
            replies = channel.makefile("r")
            for verb in verbs:
                channel.sendall(verb.encode() + b"\n")
                answers.append([])
                while not answers[-1] or "ok" not in answers[-1][-1]:
                    answers[-1].append(json.loads(replies.readline()))
        return answers

    def attached(self, port):
        host = socket.create_connection(("127.0.0.1", port), timeout=TIMEOUT_S)
        self.addCleanup(host.close)
        host.sendall(struct.pack(">HHI32s", 0x0111, 0x8003, 0, b"1-1"))
        reply = self.received(host, 8)
        self.assertEqual(reply, bytes([1, 0x11, 0, 3, 0, 0, 0, 0]))
        self.received(host, 312)
        return host

    def received(self, host, size):
        data = b""
        while len(data) < size:
            piece = host.recv(size - len(data))
            if not piece:
                break
            data += piece
        return data

    def submit(self, host, endpoint=0, length=0, data=b"", setup=bytes(8)):
        """Waits for its end, which must be a good one: what came."""
        is_in = not data and length > 0
        host.sendall(struct.pack(">10I8s", 1, 1, 0x10001, is_in, endpoint, 0, len(data) or length, 0, 0, 0, setup) + data)
        header = struct.unpack(">12I", self.received(host, 48))
        self.assertEqual(header[:2] + header[5:6], (3, 1, 0))
        return self.received(host, header[6]) if is_in else b""

    def control(self, host, request, value=0, length=0, data=b""):
        self.submit(host, data=data, setup=struct.pack("<BBHHH", 0x21, request, value, 0, length))

    def device_descriptor(self, host):
        descriptor = self.submit(host, length=18, setup=DESCRIPTOR_OF_DEVICE)
        self.assertEqual(len(descriptor), 18)
        return descriptor

    def test_a_plugins_model_is_one_as_well(self):
        plugin = self.folder / "gantry.so"
        shutil.copyfile(SAMPLE, plugin)
        plugin.chmod(0o644)
        _, port = self.offer("gantry", "--plugin", plugin)
        self.assertEqual(struct.unpack_from("<H", self.device_descriptor(self.attached(port)), 8), (0xFFF0,))
        ((moved,), (status,)) = self.say("move 0 0 0.01 0.01", "status")
        self.assertTrue(moved["ok"], moved)
        self.assertEqual(status["model"], "sim:gantry")

    def test_a_plugin_that_is_none_is_refused_in_a_sentence_that_names_it(self):
        for file, words in ((self.write("none.so", "x"), "none.so"), ("", "--plugin: the name of a file is expected, and it is empty"), (self.folder / "away.so", "away.so")):
            with self.subTest(file):
                ended = self.run_program("thimble-simdev", "--usbip", "0", "--plugin", file, "gantry")
                self.assertNotEqual(ended.returncode, 0)
                self.assert_one_sentence(ended.stderr, words)

    def test_what_cannot_be_offered_says_what_would_do(self):
        for words, said in ((("--usbip", "99999"), ("--usbip", "99999", "65535")), (("--usbip", "-1"), ("--usbip", "65535")),
                            (("--usbip", "0", "--socket", self.folder), (str(self.folder), "is there already, and is no socket"))):
            with self.subTest(words):
                result = self.run_program("thimble-simdev", *words, "phantom-vintage")
                self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
                for part in said:
                    self.assertIn(part, result.stderr)

    def test_any_model_is_a_usb_device_for_who_attaches_it(self):
        for model, ids in (("sim:phantom-vintage", (0x1234, 0x0006)), ("polhem-1", (0x16C0, 0x0486)), ("falcon", (0x0403, 0xCB48)),
                           ("woody-2015-serial", (0x16C0, 0x0483)), ("spacemouse", (0x256F, 0xC635))):
            with self.subTest(model):
                process, port = self.offer(model)
                descriptor = self.device_descriptor(self.attached(port))
                self.assertEqual(struct.unpack_from("<HH", descriptor, 8), ids)
                ((status,),) = self.say("status")
                self.assertEqual(status["model"], "sim:" + model.removeprefix("sim:"))
                process.kill()
                process.wait()

    def test_an_arm_on_a_serial_port_answers_its_text_over_usb(self):
        _, port = self.offer("phantom-vintage-serial")
        host = self.attached(port)
        self.control(host, 0x20, length=7, data=struct.pack("<IBBB", 115200, 0, 0, 8))
        self.control(host, 0x22, value=3)
        self.submit(host, endpoint=2, data=b"[0,0,0]".ljust(16, b"\n"))
        answer = b""
        while not answer.endswith(b"]\n"):
            answer += self.submit(host, endpoint=2, length=128)
        self.assertRegex(answer, rb"^\[2,(-?[0-9]+,){6}0\]\n$")
        entries = self.say("log 10")[0]
        self.assertTrue(any("5b302c302c305d0a" in entry.get("out", "") for entry in entries))
        self.assertTrue(any(entry.get("request") == "00c20100000008" for entry in entries))

    def ask_board(self, host, kind, number, words=0, offset=0, payload=b""):
        """What a CAM board answers (docs/cambus.md, section 7), behind its 16 bytes."""
        head = struct.pack("<HBBHHI", 0x4243, kind, 0, number, words, offset)
        self.submit(host, endpoint=1, data=head + struct.pack("<I", zlib.crc32(head + payload)) + payload)
        answer = self.submit(host, endpoint=1, length=64)
        self.assertEqual(struct.unpack_from("<HBBH", answer), (0x4342, kind, 0, number))
        self.assertEqual(struct.unpack_from("<I", answer, 12)[0], zlib.crc32(answer[:12] + answer[16:]))
        return answer[16:]

    def test_a_cam_board_shows_its_page_over_usb(self):
        _, port = self.offer("cam-8")
        host = self.attached(port)
        self.assertEqual(struct.unpack_from("<HH", self.device_descriptor(host), 8), (0x1209, 0x0001))
        self.ask_board(host, 3, 1)
        self.assertEqual(self.ask_board(host, 1, 2, words=2)[:4], b"CAM8")
        self.ask_board(host, 2, 3, words=2, offset=0x1000, payload=b"thimble!")
        self.assertEqual(self.ask_board(host, 1, 4, words=2, offset=0x1000), b"thimble!")
        self.assertEqual(self.say("status")[0][0]["readings"]["unmodelled"], 0)

    def test_its_verbs_are_answered_while_it_runs(self):
        for grain in ((), ("--slices-per-frame", "5"), ("--frames-at-once", "2")):
            with self.subTest(grain):
                process, _ = self.offer("phantom-vintage", "--serial", "ABC", *grain)
                self.assert_answers_verbs()
                process.kill()
                process.wait()

    def assert_answers_verbs(self):
        (home,), (status,), log = self.say("home 0.2", "status", "log 0.2")
        self.assertTrue(home["ok"])
        self.assertEqual((status["serial_number"], status["plugged"], status["open"]), ("ABC", True, False))
        self.assertEqual(log[-1], {"ok": True, "entries": len(log) - 1})

    def test_a_falcon_reads_how_often_it_was_sent_firmware(self):
        self.offer("falcon")
        self.assertEqual(self.say("status")[0][0]["readings"], {"uploads": 0})

    def test_its_cable_can_be_pulled(self):
        _, port = self.offer("falcon")
        host = self.attached(port)
        self.assertTrue(self.say("unplug")[0][0]["ok"])
        self.assertEqual(host.recv(1), b"")
        self.assertTrue(self.say("plug")[0][0]["ok"])
        self.device_descriptor(self.attached(port))

    def test_told_to_stop_it_takes_its_socket_along(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            process, _ = self.offer("falcon")
            process.send_signal(number)
            self.assertEqual(process.wait(TIMEOUT_S), 0)
            self.assertFalse((self.folder / "verbs").exists())

    def test_nobody_but_its_user_may_say_verbs(self):
        self.offer("falcon")
        self.assertEqual((self.folder / "verbs").stat().st_mode & 0o777, 0o700)

    def test_what_cannot_be_offered_is_refused_with_a_sentence(self):
        for words, code, sentence in ((("nobody", "--usbip", "0"), 2, "there are: phantom-vintage"),
                                      (("falcon",), 2, "say how it is to be offered"),
                                      (("falcon", "--vhci", "--usbip", "0"), 2, "say how it is to be offered"),
                                      (("falcon", "--uhid"), 2, "is no HID device"),
                                      (("phantom-vintage-serial", "--uhid"), 2, "is no HID device"),
                                      (("falcon", "--usbip", "0", "--slices-per-frame", "11"), 2, "--slices-per-frame"),
                                      (("falcon", "--usbip", "0", "--slices-per-frame", "2", "--frames-at-once", "2"), 2, "excludes"),
                                      *((("falcon", "--usbip", "0", "--serial", serial), 2, "1 to 63 printable letters")
                                        for serial in ("", "A B", "\x1b[31mred", "\u00e9", 64 * "A")),
                                      (("falcon", "--usbip", "0", "--socket", "/nowhere/s"), 1, "No such file"),
                                      (("falcon", "--usbip", "0", "--socket", ""), 2, '--socket: expected a name, found ""')):
            with self.subTest(words):
                result = self.run_program("thimble-simdev", *words)
                self.assertEqual(result.returncode, code)
                self.assertIn(sentence, result.stderr)
