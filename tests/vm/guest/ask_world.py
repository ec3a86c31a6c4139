"""In the guest: asks a world that serves arms of other hosts, as one of 1999 does, and prints how many bytes it answers: 0 when it is silent.

usage: ask_world.py FROM TO PORT    (FROM: an address of the guest's own, which the world takes for that of another host)
"""

import socket
import struct
import sys

PATIENCE_S = 2


def main(sender, receiver, port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as channel:
        channel.bind((sender, 0))
        channel.settimeout(PATIENCE_S)
        channel.sendto(struct.pack(">fff", 20, 0, 0), (receiver, int(port)))
        try:
            print(len(channel.recv(128)))
        except TimeoutError:
            print(0)


if __name__ == "__main__":
    main(*sys.argv[1:])
