"""An arm and a world of two daemons along a serial line: two pseudo-terminals, and a cable between them that
takes its ten bits a byte."""

import os
import select
import threading
import time
import tty

from rig import ProcessTest

BIT_PER_S = 460_800

WORLD = """
[[world]]
name = "box"
source = "box:3"
listen = "serial:{line}@{rate}"
"""

ARM = """
[[arm]]
name = "right"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
link = "serial:{line}@{rate}"
protocol = "{protocol}"
[arm.hand]
motion = "poke"
seed = 1
"""


class Cable:
    """Joins two terminals; what is put in at one end comes out at the other no faster than the line is."""

    def __init__(self):
        self.ends = []
        self.nodes = []
        for _ in range(2):
            end, node = os.openpty()
            tty.setraw(node)
            self.ends.append(end)
            self.nodes.append(os.ttyname(node))
            os.close(node)
            os.set_blocking(end, False)
        self.carried = [0, 0]
        self.is_cut = threading.Event()
        self.is_noisy = threading.Event()
        self.threads = [threading.Thread(target=self.carry, args=(way,), daemon=True) for way in (0, 1)]
        for thread in self.threads:
            thread.start()

    def carry(self, way):
        free_at = time.monotonic()
        source, sink = self.ends[way], self.ends[1 - way]
        while not self.is_cut.is_set():
            # Not in read(): who cuts the cable waits for this thread, lest a number that is closed be another's by then.
            if not select.select([source], [], [], 0.05)[0]:
                continue
            try:
                data = os.read(source, 64)
            except OSError:  # nobody has the terminal open
                time.sleep(0.01)
                continue
            free_at = max(free_at, time.monotonic()) + 10 * len(data) / BIT_PER_S
            time.sleep(max(0, free_at - time.monotonic()))
            if self.is_noisy.is_set():
                data = bytes(byte ^ 0x24 for byte in data)
            self.carried[way] += len(data)
            try:
                os.write(sink, data)
            except OSError:
                pass

    def close(self):
        self.is_cut.set()
        for thread in self.threads:
            thread.join()
        for end in self.ends:
            os.close(end)
        self.ends = []


def link(status):
    return status["links"][0]


class SerialLine(ProcessTest):
    def setUp(self):
        super().setUp()
        self.cable = Cable()
        self.addCleanup(self.cable.close)

    def world(self, source="box:3", more=""):
        config = WORLD.format(line=self.cable.nodes[0], rate=BIT_PER_S).replace("box:3", source) + more
        return self.start(name="world", config=config)

    def arm(self, protocol, name="arm"):
        return self.start(name=name, config=ARM.format(line=self.cable.nodes[1], rate=BIT_PER_S, protocol=protocol))

    def test_a_wall_is_felt_along_a_line_by_both_protocols(self):
        world = self.world()
        for protocol, kind in (("thesis", "serial"), ("thimble", "thimble")):
            with self.subTest(protocol):
                arm = self.arm(protocol, protocol)
                status = arm.status_when(lambda s: link(s)["is_up"] and s["arms"][0]["contacts"] > 0
                                         and s["arms"][0]["peak_force_newton"] > 0.1)
                self.assertEqual(link(status)["kind"], kind)
                self.assertEqual(link(status)["peer"], f"serial:{self.cable.nodes[1]}@{BIT_PER_S}")
                world.status_when(lambda s: s["links"][0]["is_up"])
                arm.stop()
                world.status_when(lambda s: not s["links"][0]["is_up"])

    def test_what_is_asked_of_an_arm_comes_about_in_the_world_at_the_other_end(self):
        world = self.world("pieces", "[world.pieces]\ncells = 32\ncount = 1\n")
        arm = self.arm("thesis", "old")
        told = self.thimble(arm, "reset")
        self.assertEqual(told.returncode, 1)
        self.assert_one_sentence(told.stderr, "the datagrams of 1999 carry no actions")
        arm.stop()
        arm = self.arm("thimble")
        arm.status_when(lambda s: link(s)["is_up"])
        for verb, wish, is_free in (("free", "to switch free motion", True), ("reset", "for a reset", False)):
            self.ask_the_far_world(arm, verb, f"arm right: its world was asked {wish}\n", world, is_free)

    def test_noise_is_counted_and_the_link_comes_back(self):
        world, arm = self.world(), self.arm("thimble")
        arm.status_when(lambda s: link(s)["is_up"])
        self.cable.is_noisy.set()
        world.status_when(lambda s: s["links"][0]["events"]["receive_errors"] > 0)
        arm.status_when(lambda s: not link(s)["is_up"])
        self.cable.is_noisy.clear()
        arm.status_when(lambda s: link(s)["is_up"])

    def test_a_port_that_goes_is_told_of_and_the_daemons_go_on(self):
        world, arm = self.world(), self.arm("thimble")
        arm.status_when(lambda s: link(s)["is_up"])
        self.cable.close()
        status = arm.status_when(lambda s: not link(s)["is_up"] and link(s)["last_error"])
        self.assertEqual(status["arms"][0]["state"], "active")
        world.status_when(lambda s: s["links"][0]["last_error"])
        arm.stop()
        world.stop()

    def test_a_port_that_another_daemon_holds_is_said_to_be(self):
        self.arm("thimble")
        second = self.arm("thimble", "second")
        status = second.status_when(lambda s: link(s)["last_error"])
        self.assertRegex(link(status)["last_error"], "held by another daemon|busy")
