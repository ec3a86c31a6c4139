"""In the guest: says verbs to a thimble-simdev and prints what it answers.

usage: simdev.py SOCKET VERB…    (each verb one word with blanks, e.g. "move 0 0 0.01")

Ends with status 1 when one of them was refused.
"""

import json
import socket
import sys


class Verbs:
    """A connection to it. Use as a context manager."""

    def __init__(self, path):
        self.channel = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.channel.connect(path)
        self.replies = self.channel.makefile("r", encoding="utf-8")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.channel.close()

    def say(self, verb, take_line=lambda line: None):
        """The last line of the reply, and each to `take_line`."""
        self.channel.sendall(verb.encode() + b"\n")
        for line in self.replies:
            take_line(line)
            # Of a log there are thousands before the one that ends it.
            if line.startswith('{"ok"'):
                return json.loads(line)
        raise ConnectionError("the device is gone")


def main(path, *verbs):
    with Verbs(path) as device:
        for verb in verbs:
            if not device.say(verb, lambda line: print(line, end=""))["ok"]:
                sys.exit(1)


if __name__ == "__main__":
    main(*sys.argv[1:])
