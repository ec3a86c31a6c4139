"""The force that an arm was commanded, by its log: what its motors were told, in the pose that it had told itself.

That is what a limit of the daemon bounds, whatever the device says: where the pose was a lie the motors push elsewhere, and what bounds them is what each may be told (`loads`). Equations of its own, from the facts of the
drivers' tables: drivers/phantom/README.md, "Frames", and the legs of a delta arm.
"""

import collections
import functools
import itertools
import math
import pathlib
import re
import struct
import tomllib

DRIVERS = pathlib.Path(__file__).resolve().parents[2] / "drivers"
# Between the report that a command answers and the command there are as many, at most: what is under way in both directions.
POSES = 12
NEVER = (math.inf, math.inf, math.inf)  # where no force can be told


def model(family, name):
    table = tomllib.loads((DRIVERS / family / f"{family}_models.toml").read_text(encoding="utf-8"))[name]
    return {key: said["value"] for key, said in table.items()}


def solve(rows, right):
    """x of rows · x = right, by Cramer; None: the rows lie in a plane."""
    def volume(a, b, c):
        return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    whole = volume(*rows)
    if abs(whole) < 1e-12:
        return None
    return [volume(*([*row[:axis], value, *row[axis + 1:]] for row, value in zip(rows, right))) / whole for axis in range(3)]


class Phantom:
    """Of the HID form: its reports, its commands."""

    def __init__(self, name):
        self.facts = model("phantom", name)

    def told(self, stream):
        """Counters of the last whole report in it."""
        return [struct.unpack("<3h", stream[-1][:6])] if len(stream[-1]) >= 6 else []

    def motors(self, command):
        """A, of the three; None: it is no command for them."""
        *milliamperes, kind = struct.unpack("<4h", command[:8])
        return [value / 1000 for value in milliamperes] if kind == 0 else None

    def most(self, limit_newton):
        """A, of each motor: what that force asks for in the pose that asks for most, where its lever is all that the joint moves; never more than its peak."""
        facts = self.facts
        _, upper, fore = facts["link_m"]
        return [min(peak, limit_newton * lever * capstan / drum / constant) for peak, lever, capstan, drum, constant in
                zip(facts["peak_current_a"], (upper + fore, upper, fore), facts["capstan_diameter_m"], facts["drum_diameter_m"],
                    facts["torque_constant_newton_m_per_a"])]

    @functools.cache  # one that presses on a wall is in a few poses, a thousand times a second
    def force_in_pose(self, counts):
        """A function: of currents the force at the tip, in that pose."""
        facts = self.facts
        ratio = [capstan / drum for capstan, drum in zip(facts["capstan_diameter_m"], facts["drum_diameter_m"])]
        a, b, c = (home + sign * 2 * math.pi * count / turn * part for home, sign, count, turn, part in
                   zip(facts["home_angle_rad"], facts["motor_direction"], counts, facts["counts_per_motor_rev"], ratio))
        _, upper, fore = facts["link_m"]
        reach = upper * math.sin(b) + fore * math.sin(c)
        # The tip's way for each joint: a row each.
        rows = [(math.cos(a) * reach, 0, -math.sin(a) * reach),
                (math.sin(a) * upper * math.cos(b), -upper * math.sin(b), math.cos(a) * upper * math.cos(b)),
                (math.sin(a) * fore * math.cos(c), fore * math.sin(c), math.cos(a) * fore * math.cos(c))]
        scale = [sign * constant / part for sign, constant, part in
                 zip(facts["motor_direction"], facts["torque_constant_newton_m_per_a"], ratio)]
        return lambda currents: solve(rows, [current * factor for current, factor in zip(currents, scale)]) or NEVER


class Text(Phantom):
    """The same arm that speaks lines of text."""

    def told(self, stream):
        """Of all lines that end in the last packet."""
        before = b"".join(itertools.islice(stream, len(stream) - 1))
        text = before + stream[-1]
        return [tuple(int(word) for word in match[1].split(b",")[1:4])
                for match in re.finditer(rb"\[(-?\d{1,9}(?:,-?\d{1,9}){7})\]", text) if match.end() > len(before)]

    def motors(self, command):
        found = re.search(rb"\[(-?\d+),(-?\d+),(-?\d+)\]", command)
        return [int(word) / 1000 for word in found.groups()] if found else None


class Falcon:
    FULL_SCALE = 4095  # what the firmware's source clamps at

    def __init__(self, newton_per_count):
        self.facts = model("falcon", "falcon")
        crank_rad = 3 * [self.facts["home_angle_rad"]]
        for _ in range(20):  # Newton's: the cranks when the grip is in the middle
            slopes = [self.slopes(leg, angle, (0, 0, 0)) for leg, angle in enumerate(crank_rad)]
            crank_rad = [angle - gap / slope[3] for angle, (gap, slope) in zip(crank_rad, slopes)]
        # One count more of each motor is the force along z.
        self.newton_m_per_count = newton_per_count / sum(-slope[2] / slope[3] for _, slope in slopes)

    def gap(self, leg, crank_rad, tip):
        """What that leg misses of reaching the grip, as a difference of squares."""
        facts = self.facts
        sine, cosine = math.sin(facts["leg_azimuth_rad"][leg]), math.cos(facts["leg_azimuth_rad"][leg])
        x, y, up = (value + origin for value, origin in zip(tip, facts["origin_m"]))
        out = cosine * x + sine * y - facts["base_radius_m"] + facts["grip_radius_m"]
        across = -sine * x + cosine * y - facts["base_shift_m"] + facts["grip_shift_m"]
        rods = facts["knee_m"] + facts["ankle_m"] + math.sqrt(max(0, facts["rods_m"] ** 2 - across ** 2))
        return (out - facts["crank_m"] * math.cos(crank_rad)) ** 2 + (up - facts["crank_m"] * math.sin(crank_rad)) ** 2 - rods ** 2

    def slopes(self, leg, crank_rad, tip, step=1e-6):
        """The gap, and its change with x, y, z of the grip and with the crank."""
        place = [*tip, crank_rad]
        def moved(axis, by):
            at = [value + by * (i == axis) for i, value in enumerate(place)]
            return self.gap(leg, at[3], at[:3])
        return self.gap(leg, crank_rad, tip), [(moved(axis, step) - moved(axis, -step)) / (2 * step) for axis in range(4)]

    def told(self, stream):
        """Of all reports that end in the last packet: two bytes of each are the modem's. Also those that begin within another."""
        before = b"".join(packet[2:] for packet in itertools.islice(stream, len(stream) - 1))
        text = before + stream[-1][2:]
        return [self.numbers(match[1]) for match in re.finditer(rb"(?=<([A-P]{12})[\x41-\xc0].>)", text, re.DOTALL)
                if match.start() + 16 > len(before)]

    @staticmethod
    def numbers(nibbles):
        """Three, the least nibble of each first."""
        values = [sum((letter - 0x41) << 4 * place for place, letter in enumerate(nibbles[first:first + 4])) for first in (0, 4, 8)]
        return tuple(value - 0x10000 if value & 0x8000 else value for value in values)

    def motors(self, command):
        return self.numbers(command[1:13]) if len(command) == 16 and command[:1] == b"<" else None

    @functools.cache
    def most(self, limit_newton):
        """Counts, of each motor: what that force asks for where it asks for most in the workspace, which is somewhere on its surface; and a fiftieth, as the driver looks at other points of it and adds a hundredth."""
        asked = []
        for i in range(400):
            height, around_rad = 1 - (i + 0.5) / 200, math.pi * (3 - math.sqrt(5)) * i
            out = math.sqrt(1 - height ** 2)
            tip = [self.facts["workspace_radius_m"] * value for value in (out * math.cos(around_rad), out * math.sin(around_rad), height)]
            per_axis = list(zip(*self.force_of_a_count(tip)))
            # A column each: the counts that are a newton along x, y, z.
            counts = [solve(per_axis, [axis == along for axis in range(3)]) for along in range(3)]
            asked.append([math.hypot(*of_motor) for of_motor in zip(*counts)])
        return [min(self.FULL_SCALE, 1.02 * limit_newton * max(of_motor) + 0.5) for of_motor in zip(*asked)]

    def force_of_a_count(self, tip):
        """Of each motor: the force at the tip, there."""
        crank_rad = 3 * [self.facts["home_angle_rad"]]
        for _ in range(12):  # Newton's
            slopes = [self.slopes(leg, angle, tip) for leg, angle in enumerate(crank_rad)]
            crank_rad = [angle - gap / slope[3] for angle, (gap, slope) in zip(crank_rad, slopes)]
        return self.per_count(slopes)

    def per_count(self, slopes):
        return [[-value / slope[3] * sign * self.newton_m_per_count for value in slope[:3]]
                for (_, slope), sign in zip(slopes, self.facts["motor_direction"])]

    @functools.cache
    def force_in_pose(self, counts):
        facts = self.facts
        rad_per_count = 2 * math.pi / facts["counts_per_motor_rev"] * facts["capstan_diameter_m"] / facts["drum_diameter_m"]
        crank_rad = [facts["home_angle_rad"] + rad_per_count * count for count in counts]
        tip = (0, 0, 0)
        for _ in range(12):  # Newton's, from the middle
            slopes = [self.slopes(leg, angle, tip) for leg, angle in enumerate(crank_rad)]
            move = solve([slope[:3] for _, slope in slopes], [-gap for gap, _ in slopes])
            if move is None or max(map(abs, move)) > 0.2:
                return lambda _: NEVER
            tip = [value + by for value, by in zip(tip, move)]
        per_tip = self.per_count(slopes)
        return lambda motors: [sum(count * row[axis] for count, row in zip(motors, per_tip)) for axis in range(3)]


def forces(arm, log):
    """The size of the force of each command in it, in that one of the poses told just before in which it is least: which one it answers nobody can see."""
    stream, poses, sizes = collections.deque(maxlen=8), collections.deque(maxlen=POSES), []
    for entry in log:
        if "in" in entry:
            stream.append(bytes.fromhex(entry["in"]))
            poses.extend(arm.force_in_pose(counts) for counts in arm.told(stream))
        if "out" in entry and poses:
            motors = arm.motors(bytes.fromhex(entry["out"]))
            if motors is not None:
                sizes.append(min(math.hypot(*force_of(motors)) for force_of in poses))
    return sizes


def loads(arm, log, limit_newton):
    """Of each command in it that motor's which has most, as a share of what it may have at that limit in whatever pose."""
    most = arm.most(limit_newton)
    commands = (arm.motors(bytes.fromhex(entry["out"])) for entry in log if "out" in entry)
    return [max(abs(told) / may for told, may in zip(motors, most)) for motors in commands if motors is not None]
