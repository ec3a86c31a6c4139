"""In the guest: a USB device whose descriptors lie, straight on vhci-hcd, for as long as the kernel and its users ask it something.

usage: lying_usb.py VENDOR PRODUCT SERIAL LIE…    (ids in hexadecimal; LIE: of LIES; one device after the other)

It answers what it is asked of its descriptors, takes every configuration, stalls other requests and never answers a transfer. Pulled out
when nobody has asked anything for REST_S, or after MOST_S; prints how many requests there were, and how many transfers: those are of who has opened it. The protocol: linux Documentation/usb/usbip_protocol.rst; tables: USB 2.0, chapter 9; HID 1.11, section 6.2.1.
"""

import errno
import pathlib
import select
import socket
import struct
import sys
import time

import uhid_device

REST_S = 0.3
MOST_S = 1.5  # who sends an arm its commands as requests never stops
FIRST_S = 10  # the kernel's hubs are looked after by one thread, which may be busy with the one before
FULL_SPEED = 2
VHCI = pathlib.Path("/sys/devices/platform/vhci_hcd.0")
SUBMIT, UNLINK, SUBMITTED, UNLINKED = 1, 2, 3, 4
DEVICE, CONFIGURATION, STRING, INTERFACE, ENDPOINT, REPORT = 1, 2, 3, 4, 5, 0x22
GET_DESCRIPTOR, SET_CONFIGURATION, SET_IDLE, SET_INTERFACE = 6, 9, 10, 11


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
    "vendor": {},  # in all that it says; but it never answers a transfer
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


# Of an arm on HID: what class it is, and how long the descriptor of its reports is.
REPORTS = uhid_device.DESCRIPTOR
PIPES = [endpoint(0x81, 3, 64, 1), endpoint(0x01, 3, 64, 1)]


def hid_class(reports=len(REPORTS), length=9, count=1):
    return struct.pack("<BBHBBBH", length, 0x21, 0x0111, 0, count, REPORT, reports)


def hid(kind=None, pipes=None, reports=REPORTS):
    functions = [hid_class()] if kind is None else [kind]
    return {"configuration": configuration(interface(PIPES if pipes is None else pipes, kind=3, functions=functions)), "reports": reports}


LIES.update({
    "hid": hid(),  # in all that it says
    "hid-no-class": hid(b""),
    "hid-short-class": hid(hid_class(length=6)[:6]),
    "hid-endless-class": hid(hid_class(length=255)),
    "hid-many-classes": hid(hid_class(count=255)),
    "hid-longer-reports": hid(hid_class(4096)),
    "hid-huge-reports": hid(hid_class(0xFFFF)),
    "hid-no-reports": hid(hid_class(0)),
    "hid-cut-reports": hid(hid_class(7)),
    "hid-stalled-reports": hid(reports=b""),
    "hid-no-input": hid(pipes=PIPES[1:]),
    "hid-no-output": hid(pipes=PIPES[:1]),
    "hid-bulk": hid(pipes=PAIR),
    "hid-no-packets": hid(pipes=[endpoint(0x81, 3, 0, 1), endpoint(0x01, 3, 0, 1)]),
    "hid-small-packets": hid(pipes=[endpoint(0x81, 3, 1, 255), endpoint(0x01, 3, 1, 255)]),
})


def descriptors_of(vendor, product, serial, lie):
    said = {"configuration": HONEST, "serial": text(serial), **LIES[lie]}
    device = struct.pack("<BBHBBBBHHHBBBB", 18, DEVICE, 0x0200, 0, 0, 0, 64, vendor, product, 0x0600, 1, 2, 3, 1)
    return {(DEVICE, 0): device, (CONFIGURATION, 0): said["configuration"], (STRING, 0): bytes([4, STRING, 9, 4]),
            (STRING, 1): text("FALCON"), (STRING, 2): text("FALCON HAPTIC"), (STRING, 3): said["serial"], (REPORT, 0): said.get("reports")}


def answer(setup, descriptors):
    """The data of a request to endpoint 0; None: it stalls."""
    kind, request, value, _, length = struct.unpack("<BBHHH", setup)
    if kind in (0x80, 0x81) and request == GET_DESCRIPTOR:
        data = descriptors.get((value >> 8, value & 0xFF))
        return data[:length] if data else None
    if (kind, request) in ((0x00, SET_CONFIGURATION), (0x01, SET_INTERFACE), (0x21, SET_IDLE)):
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
    requests, transfers, end = 0, 0, None
    while (end is None or time.monotonic() < end) and select.select([channel], [], [], REST_S if requests else FIRST_S)[0]:
        header = read(channel, 48)
        command, number, _, is_in, pipe, _, length = struct.unpack_from(">IIIIIII", header)
        if command == UNLINK:
            channel.sendall(struct.pack(">IIIIIi24x", UNLINKED, number, 0, 0, 0, -errno.ECONNRESET))
            continue
        if not is_in:
            read(channel, length)
        if pipe != 0:
            transfers += 1
            continue
        requests += 1
        end = end or time.monotonic() + MOST_S
        data = answer(header[40:], descriptors)
        status = -errno.EPIPE if data is None else 0
        data = (data or b"")[:length] if is_in else b""
        channel.sendall(struct.pack(">IIIIIiIIII8x", SUBMITTED, number, 0, 0, 0, status, len(data), 0, 0, 0) + data)
    return requests, transfers


def free_ports():
    """Those that have nothing: 4 is VDEV_ST_NULL of drivers/usb/usbip/usbip_common.h."""
    lines = (line.split() for line in (VHCI / "status").read_text(encoding="ascii").splitlines()[1:])
    return [int(port) for hub, port, state, *_ in lines if (hub, state) == ("hs", "004")]


def plug(descriptors, port):
    """Until it is pulled out again: how many requests there were, and how many transfers."""
    ours, kernels = socket.socketpair()
    with ours, kernels:
        (VHCI / "attach").write_text(f"{port} {kernels.fileno()} 65537 {FULL_SPEED}", encoding="ascii")
        return serve(ours, descriptors)


def main(vendor, product, serial, *lies):
    # A Falcon is known by where it hangs: that is the first one again.
    port = free_ports()[0]
    for lie in lies:
        requests, transfers = plug(descriptors_of(int(vendor, 16), int(product, 16), serial, lie), port)
        print(lie, requests, transfers, flush=True)
        while port not in free_ports():
            time.sleep(0.05)


if __name__ == "__main__":
    main(*sys.argv[1:])
