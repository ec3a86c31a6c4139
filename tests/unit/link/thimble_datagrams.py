#!/usr/bin/env python3
"""Thimble's datagrams written field by field from docs/link-protocol.md, without the codec.

  thimble_datagrams.py > tests/data/thimble_datagrams.txt                    the golden vectors of unit_link
  thimble_datagrams.py --sealed > tests/data/thimble_sealed_datagrams.txt    the same of some of them, sealed
  thimble_datagrams.py --check FILE SEALED_FILE      whether those are what this program writes
  thimble_datagrams.py --corpus FOLDER               those without a seal as seeds of the fuzz target
"""

import pathlib
import struct
import sys

import thimble_seal

HELLO, CHALLENGE, WELCOME, REFUSAL, SAMPLE, CONSTRAINTS, IDLE = 1, 2, 3, 4, 16, 17, 19
ARM_NONCE = bytes(range(32))
WORLD_NONCE = bytes(range(64, 96))
LINK_KEY = bytes(range(128, 160))
SEAL_NONCE = bytes(range(160, 184))  # of a handshake


def header(kind, session, sequence, is_sealed=False):
    return b"THMB" + struct.pack(">BBHQQ", 1, kind, 1 if is_sealed else 0, session, sequence)


def timing(sent_at, echo, echoed_at):
    return struct.pack(">qqq", sent_at, echo, echoed_at)


def name(text):
    return text.encode("ascii").ljust(32, b"\0")


def half(scheme, force_at, zone_names, buffer_m):
    return name(scheme) + bytes([force_at, zone_names]) + struct.pack(">d", buffer_m)


def reals(*values):
    return struct.pack(f">{len(values)}d", *values)


def sample(mask, fields):
    return (timing(1_000_000_000, 2_000_000_000, 900_000_000)
            + struct.pack(">QqIIQ", 77, 999_000_000, 3, 0b101, 41)
            + reals(0.0155, -0.25, 1e-300) + struct.pack(">I", mask) + fields)


def constraints(mask, fields):
    return (timing(2_500_000_000, 1_000_000_000, 2_400_000_000) + struct.pack(">Q", 12)
            + struct.pack(">QQqI", 42, 77, 999_000_000, 6) + struct.pack(">I", mask) + fields)


def plane(normal, offset, *surface):
    """`surface`: stiffness, damping, friction, temperature; None is not said."""
    said = [value for value in surface if value is not None]
    mask = sum(1 << bit for bit, value in enumerate(surface) if value is not None)
    return reals(*normal, offset) + bytes([mask]) + reals(*said)


def every_field_of_a_sample():
    velocity = reals(0.2, -0.1, 0.05)
    tool = reals(800, 5)
    waves = reals(1, 2, -3) + reals(0.5, 0.25, 0.125)
    impulse = reals(-0.001, 0.002, 0)
    pull = reals(-0.75, 0, 1.5)
    presses = bytes([1, 0, 255, 0, 0, 0, 0, 7])
    actions = bytes([3, 255])
    return (velocity + tool + waves + impulse + presses + reals(0.0001) + struct.pack(">Q", 9) + reals(0.0151, -0.25, 0)
            + struct.pack(">Q", 0b101) + pull + actions)


def near_cells():
    boxes = [(-31, 0, 2, -1, 0, 31), (0, 1, 0, 0, 1, 0)]
    return (struct.pack(">III", 64, 32, 1) + reals(0.000703125) + struct.pack(">iii", 33, 31, 0)
            + struct.pack(">6b", -31, -31, 0, 31, 31, 0) + bytes([1, len(boxes)])
            + b"".join(struct.pack(">6b", *box) for box in boxes))


def map_news():
    slices = [1 << (3 * z) for z in range(8)]
    return (struct.pack(">III", 64, 32, 1) + reals(0.000703125) + struct.pack(">iii", 33, 31, 0) + bytes([1, 1])
            + struct.pack(">hhhI", 4, 3, -1, 70_000) + struct.pack(">8Q", *slices))


def every_field_of_constraints():
    planes = bytes([2]) + plane((1, 0, 0), 0.015, 800, None, 0.5, 310.15) + plane((0, 0.6, -0.8), -0.02)
    ghost = reals(0.0149, 0, 0.01)
    far = reals(-1.5, 0, 0.25) + reals(0.015, 0, 0.01) + reals(0, 0.001, 0)
    waves = reals(4, 5, 6) + reals(1, 1.5, 2)
    return (planes + ghost + far + waves + bytes([1]) + struct.pack(">Q", 9) + reals(0, 0.75, 0)
            + reals(0.002) + near_cells() + map_news() + reals(400, 5))


def datagrams():
    hello = timing(1, 0, 0) + ARM_NONCE
    welcome = (timing(4, 3, 3) + ARM_NONCE + struct.pack(">Q", 0) + name("box") + struct.pack(">III", 64, 32, 16)
               + reals(0.00140625) + struct.pack(">Q", 9))
    return {
        "hello": header(HELLO, 0, 1) + hello + bytes(32) + half("ghost-point", 0, 0, 0.0) + struct.pack(">Q", 0),
        "join": header(HELLO, 0, 2) + hello + WORLD_NONCE + half("buffer-zone", 1, 1, 0.03)
                + struct.pack(">Q", 0),
        "challenge": header(CHALLENGE, 0, 1) + timing(2, 1, 2) + ARM_NONCE + WORLD_NONCE,
        "welcome": header(WELCOME, 0x0123456789ABCDEF, 1) + welcome,
        "refusal": header(REFUSAL, 0, 3) + timing(4, 3, 3) + ARM_NONCE + bytes([2]),
        "refusal_by_an_arm": header(REFUSAL, 0, 4) + timing(4, 3, 3) + ARM_NONCE + bytes([3]) + name("wave"),
        "sample_least": header(SAMPLE, 0x0123456789ABCDEF, 12) + sample(0, b""),
        "sample_full": header(SAMPLE, 0x0123456789ABCDEF, 13) + sample(0xF7F, every_field_of_a_sample()),
        "constraints_least": header(CONSTRAINTS, 0x0123456789ABCDEF, 2) + constraints(0, b""),
        "constraints_full": header(CONSTRAINTS, 0x0123456789ABCDEF, 3)
                            + constraints(0xFFB, every_field_of_constraints()),
        "constraints_cell": header(CONSTRAINTS, 0x0123456789ABCDEF, 4)
                            + constraints(0x6, reals(0.0149, 0, 0.01) + struct.pack(">iii", 33, 31, -1)),
        "idle": header(IDLE, 0x0123456789ABCDEF, 5) + timing(7, 6, 6) + struct.pack(">Q", 14),
    }


def sealed_datagrams():
    """Some of those, sealed: of the handshake, and of a session in either direction."""
    clear = datagrams()

    def parts(key):
        as_sealed = clear[key][:6] + struct.pack(">H", 1) + clear[key][8:24]
        return as_sealed, clear[key][24:]

    return {
        "hello": thimble_seal.handshake(LINK_KEY, True, SEAL_NONCE, *parts("hello")),
        "sample_least": thimble_seal.session(LINK_KEY, True, ARM_NONCE, WORLD_NONCE, *parts("sample_least")),
        "idle": thimble_seal.session(LINK_KEY, False, ARM_NONCE, WORLD_NONCE, *parts("idle")),
    }


def text(of):
    return "".join(f"{key} {value.hex()}\n" for key, value in of.items())


def main(arguments):
    if arguments[:1] == ["--check"] and len(arguments) == 3:
        for file, of in zip(arguments[1:], (datagrams(), sealed_datagrams())):
            if pathlib.Path(file).read_text() != text(of):
                return f"{file} is not what this writes"
        return 0
    if arguments[:1] == ["--corpus"] and len(arguments) == 2:
        for key, value in datagrams().items():
            pathlib.Path(arguments[1], key).write_bytes(value)
        return 0
    if arguments not in ([], ["--sealed"]):
        return __doc__
    sys.stdout.write(text(sealed_datagrams() if arguments else datagrams()))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
