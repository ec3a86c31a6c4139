"""The two programs of the thesis (appendices A and B) as far as the network sees them.

Written from the printed listings, not from our code: blocking sockets, one datagram in flight, no
time-outs of their own (what they have of these only ends a test that went wrong).
"""

import math
import socket
import struct
import threading

from rig import udp_socket

LEN_MM = 30  # LEN_X … of the listing
DIM = 3      # DIM_X …
GARBAGE = (math.nan, math.inf, -math.inf, 3.4e38, 1e-45)  # what an uninitialised float may be


def request_bytes(x, y, z):
    return struct.pack(">fff", x, y, z)


def cell(position_mm):
    """user[X] = (position[X] + LEN_X * DIM_X / 2) / LEN_X, assigned to an int and clamped."""
    # The listing computes in float, whose quotient C cuts off towards zero.
    (quotient,) = struct.unpack(">f", struct.pack(">f", (position_mm + LEN_MM * DIM // 2) / LEN_MM))
    return min(max(math.trunc(quotient), 0), DIM - 1)


def reply_bytes(position_mm, unset=(0.0, 0.0, 0.0), ghost=(1, 1, 1)):
    """What set_actual_offset() sends; `unset` is what lay in its buffer."""
    values, directions = list(unset), 0
    for axis in range(3):
        user = cell(position_mm[axis])
        if ghost[axis] < user:
            values[axis] = (ghost[axis] + 1) * LEN_MM - LEN_MM * DIM // 2
            directions |= 1 << (2 * axis)
        elif ghost[axis] > user:
            values[axis] = ghost[axis] * LEN_MM - LEN_MM * DIM // 2
            directions |= 2 << (2 * axis)
    return struct.pack(">fffB", *values, directions)


class Client:
    """main() of appendix A without its arm: connect, send 12, wait for 13."""

    def __init__(self, port):
        self._socket = udp_socket()
        self._socket.connect(("127.0.0.1", port))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()

    def send(self, data):
        self._socket.send(data)

    def receive(self):
        return self._socket.recv(128)

    def ask(self, x, y, z):
        self.send(request_bytes(x, y, z))
        return self.receive()

    def hears_nothing(self):
        """Nothing has come and nothing was refused by the kernel."""
        self._socket.setblocking(False)
        try:
            return not self._socket.recv(128)
        except BlockingIOError:
            return True
        finally:
            self._socket.setblocking(True)


class Server:
    """The loop of appendix B for the box whose only free cell is the middle one.

    `answer` may be replaced: it gets the number of the request and the position, and returns the
    datagrams to send instead of the one reply.
    """

    def __init__(self, port=0, answer=None):
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", port))
        self._socket.settimeout(0.1)  # only so that close() is heard
        self.port = self._socket.getsockname()[1]
        self.answer = answer or (lambda number, position: [reply_bytes(position)])
        self.sizes = set()
        self.positions = []
        self.error = None
        self._is_closing = threading.Event()
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def close(self):
        self._is_closing.set()
        self._thread.join()
        self._socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _serve(self):
        while not self._is_closing.is_set():
            try:
                data, sender = self._socket.recvfrom(128)
            except TimeoutError:
                continue
            self.sizes.add(len(data))
            if len(data) != 12:
                continue  # "Malformed packet!"
            position = struct.unpack(">fff", data)
            self.positions.append(position)
            for datagram in self.answer(len(self.positions), position):
                self._socket.sendto(datagram, sender)
