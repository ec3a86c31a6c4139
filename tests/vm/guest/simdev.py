"""In the guest: says verbs to a thimble-simdev and prints what it answers.

usage: simdev.py SOCKET VERB…    (each verb one word with blanks, e.g. "move 0 0 0.01")

Ends with status 1 when one of them was refused.
"""

import json
import socket
import sys


def main(path, *verbs):
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as channel:
        channel.connect(path)
        replies = channel.makefile("r", encoding="utf-8")
        for verb in verbs:
            channel.sendall(verb.encode() + b"\n")
            for line in replies:
                print(line, end="")
                # Of a log there are thousands before the one that ends it.
                if line.startswith('{"ok"'):
                    if not json.loads(line)["ok"]:
                        sys.exit(1)
                    break


if __name__ == "__main__":
    main(*sys.argv[1:])
