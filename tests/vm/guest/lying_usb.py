"""In the guest: a USB device whose descriptors lie, straight on vhci-hcd, for as long as the kernel and its users ask it something.

usage: lying_usb.py VENDOR PRODUCT SERIAL LIE…    (ids in hexadecimal; LIE: of LIES; one device after the other)

It answers what it is asked of its descriptors, takes every configuration, stalls other requests and never answers a transfer. Pulled out
of PORT when nobody has asked anything for REST_S; prints how much was asked. The protocol: linux Documentation/usb/usbip_protocol.rst; tables: USB 2.0, chapter 9.
"""

import errno
import pathlib
import select
import socket
import struct
import sys
import time

REST_S = 0.3
FIRST_S = 10  # the kernel's hubs are looked after by one thread, which may be busy with the one before
PORT = 0
FULL_SPEED = 2
VHCI = pathlib.Path("/sys/devices/platform/vhci_hcd.0")
SUBMIT, UNLINK, SUBMITTED, UNLINKED = 1, 2, 3, 4
DEVICE, CONFIGURATION, STRING, INTERFACE, ENDPOINT = 1, 2, 3, 4, 5
GET_DESCRIPTOR, SET_CONFIGURATION, SET_INTERFACE = 6, 9, 11


def endpoint(address=0x81, attributes=2, packet=64, interval=0):
    return struct.pack("<BBBBHB", 7, ENDPOINT, address, attributes, packet, interval)


def interface(endpoints, number=0, count=None, kind=0xFF, subclass=0, functions=()):
    head = struct.pack("<9B", 9, INTERFACE, number, 0, len(endpoints) if count is None else count, kind, subclass, 0, 0)
    return head + b"".join(functions) + b"".join(endpoints)


def configuration(body, total=None, interfaces=1):
    return struct.pack("<BBHBBBBB", 9, CONFIGURATION, 9 + len(body) if total is None else total, interfaces, 1, 0, 0x80, 50) + body


def text(words):
    data = words.encode("utf-16-le")
    return bytes([2 + len(data), STRING]) + data


PAIR = [endpoint(0x81), endpoint(0x02)]
HONEST = configuration(interface(PAIR))
# What a lie changes: the configuration, or the string of the serial number.
LIES = {
    "longer": {"configuration": configuration(interface(PAIR), total=4000)},
    "shorter": {"configuration": configuration(interface(PAIR), total=20)},
    "no-endpoints": {"configuration": configuration(interface([]))},
    "more-endpoints": {"configuration": configuration(interface(PAIR, count=30))},
    "long-length": {"configuration": configuration(interface(PAIR) + bytes([255, ENDPOINT]))},
    "large-packets": {"configuration": configuration(interface([endpoint(0x81, packet=0xFFFF), endpoint(0x02, packet=1024)]))},
    "both-in": {"configuration": configuration(interface([endpoint(0x81), endpoint(0x82)]))},
    "interrupts": {"configuration": configuration(interface([endpoint(0x81, 3, 64, 1), endpoint(0x02, 3, 64, 1)]))},
    "no-serial": {"serial": b""},
    "strange-serial": {"serial": bytes([12, STRING]) + b"\n\0\x00\xd8\x1b\0\"\0/\0"},
    "none": {},  # but it never answers a transfer
}

# Of a serial port, CDC 1.2, section 5.2.3: header, ACM, and the union of its two interfaces.
HEADER, ACM, UNION = bytes([5, 0x24, 0, 0x10, 1]), bytes([4, 0x24, 2, 2]), bytes([5, 0x24, 6, 0, 1])
NOTICES = [endpoint(0x83, 3, 16, 16)]


def serial_port(functions=(HEADER, ACM, UNION), notices=NOTICES, data=interface(PAIR, 1, kind=0x0A)):
    port = interface(notices, kind=2, subclass=2, functions=functions)
    return {"configuration": configuration(port + data, interfaces=2 if data else 1)}


LIES.update({
    "serial": serial_port(),  # in all that it says
    "serial-no-union": serial_port((HEADER, ACM)),
    "serial-union-with-none": serial_port((HEADER, ACM, bytes([5, 0x24, 6, 0, 7]))),
    "serial-union-with-itself": serial_port((HEADER, ACM, bytes([5, 0x24, 6, 0, 0]))),
    "serial-short-union": serial_port((HEADER, ACM, bytes([3, 0x24, 6]))),
    "serial-endless-union": serial_port((HEADER, ACM, bytes([255, 0x24, 6, 0, 1]))),
    "serial-no-data": serial_port(data=b""),
    "serial-no-pair": serial_port(data=interface([], 1, kind=0x0A)),
    "serial-half-a-pair": serial_port(data=interface(PAIR[:1], 1, kind=0x0A)),
    "serial-no-notices": serial_port(notices=[]),
})


def descriptors_of(vendor, product, serial, lie):
    said = {"configuration": HONEST, "serial": text(serial), **LIES[lie]}
    device = struct.pack("<BBHBBBBHHHBBBB", 18, DEVICE, 0x0200, 0, 0, 0, 64, vendor, product, 0x0600, 1, 2, 3, 1)
    return {(DEVICE, 0): device, (CONFIGURATION, 0): said["configuration"], (STRING, 0): bytes([4, STRING, 9, 4]),
            (STRING, 1): text("FALCON"), (STRING, 2): text("FALCON HAPTIC"), (STRING, 3): said["serial"]}


def answer(setup, descriptors):
    """The data of a request to endpoint 0; None: it stalls."""
    kind, request, value, _, length = struct.unpack("<BBHHH", setup)
    if kind == 0x80 and request == GET_DESCRIPTOR:
        data = descriptors.get((value >> 8, value & 0xFF))
        return data[:length] if data else None
    if (kind, request) in ((0x00, SET_CONFIGURATION), (0x01, SET_INTERFACE)):
        return b""
    return None


def read(channel, size):
    data = b""
    while len(data) < size:
        piece = channel.recv(size - len(data))
        if not piece:
            raise ConnectionError("the kernel has closed")
        data += piece
    return data


def serve(channel, descriptors):
    requests = 0
    while select.select([channel], [], [], REST_S if requests else FIRST_S)[0]:
        header = read(channel, 48)
        command, number, _, is_in, pipe, _, length = struct.unpack_from(">IIIIIII", header)
        if command == UNLINK:
            channel.sendall(struct.pack(">IIIIIi24x", UNLINKED, number, 0, 0, 0, -errno.ECONNRESET))
            continue
        if not is_in:
            read(channel, length)
        if pipe != 0:
            continue
        requests += 1
        data = answer(header[40:], descriptors)
        status = -errno.EPIPE if data is None else 0
        data = (data or b"")[:length] if is_in else b""
        channel.sendall(struct.pack(">IIIIIiIIII8x", SUBMITTED, number, 0, 0, 0, status, len(data), 0, 0, 0) + data)
    return requests


def is_free():
    """Whether the port has nothing: 4 is VDEV_ST_NULL of drivers/usb/usbip/usbip_common.h."""
    lines = (VHCI / "status").read_text(encoding="ascii").splitlines()[1:]
    return any(line.split()[:3] == ["hs", f"{PORT:04}", "004"] for line in lines)


def plug(descriptors):
    """Until it is pulled out again: how many requests it was asked."""
    ours, kernels = socket.socketpair()
    with ours, kernels:
        (VHCI / "attach").write_text(f"{PORT} {kernels.fileno()} 65537 {FULL_SPEED}", encoding="ascii")
        return serve(ours, descriptors)


def main(vendor, product, serial, *lies):
    for lie in lies:
        asked = plug(descriptors_of(int(vendor, 16), int(product, 16), serial, lie))
        print(lie, asked, flush=True)
        while not is_free():
            time.sleep(0.05)


if __name__ == "__main__":
    main(*sys.argv[1:])
