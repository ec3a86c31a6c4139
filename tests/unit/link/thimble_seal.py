"""The seal of docs/link-protocol.md, without libsodium: for golden vectors, and slow.

Sources: RFC 8439 (ChaCha20-Poly1305), draft-irtf-cfrg-xchacha-03 (HChaCha20), RFC 7693 (BLAKE2b, by hashlib).
"""

import hashlib
import struct

MASK = 0xFFFFFFFF


def rotated(word, bits):
    return (word << bits | word >> (32 - bits)) & MASK


def quarter_round(state, a, b, c, d):
    for to, by, turned, bits in ((a, b, d, 16), (c, d, b, 12), (a, b, d, 8), (c, d, b, 7)):
        state[to] = (state[to] + state[by]) & MASK
        state[turned] = rotated(state[turned] ^ state[to], bits)


def rounds(state):
    state = list(state)
    for _ in range(10):
        for column in range(4):
            quarter_round(state, column, 4 + column, 8 + column, 12 + column)
        for column in range(4):
            quarter_round(state, column, 4 + (column + 1) % 4, 8 + (column + 2) % 4, 12 + (column + 3) % 4)
    return state


def first_state(key, last_words):
    return list(struct.unpack("<4I", b"expand 32-byte k")) + list(struct.unpack("<8I", key)) + list(last_words)


def chacha20_block(key, counter, nonce):
    state = first_state(key, (counter, *struct.unpack("<3I", nonce)))
    return struct.pack("<16I", *((a + b) & MASK for a, b in zip(state, rounds(state))))


def chacha20(key, counter, nonce, text):
    out = b""
    for begin in range(0, len(text), 64):
        stream = chacha20_block(key, counter + begin // 64, nonce)
        out += bytes(a ^ b for a, b in zip(text[begin:begin + 64], stream))
    return out


def hchacha20(key, nonce):
    state = rounds(first_state(key, struct.unpack("<4I", nonce)))
    return struct.pack("<8I", *state[:4], *state[12:])


def poly1305(key, text):
    r = int.from_bytes(key[:16], "little") & 0x0FFFFFFC0FFFFFFC0FFFFFFC0FFFFFFF
    total = 0
    for begin in range(0, len(text), 16):
        block = int.from_bytes(text[begin:begin + 16] + b"\1", "little")
        total = (total + block) * r % ((1 << 130) - 5)
    return ((total + int.from_bytes(key[16:], "little")) & ((1 << 128) - 1)).to_bytes(16, "little")


def padded(text):
    return text + bytes(-len(text) % 16)


def sealed(key, nonce, header, content):
    """ChaCha20-Poly1305: the content encrypted, and the tag over it and the header."""
    hidden = chacha20(key, 1, nonce, content)
    lengths = struct.pack("<QQ", len(header), len(content))
    return hidden + poly1305(chacha20_block(key, 0, nonce)[:32], padded(header) + padded(hidden) + lengths)


def halves(link_key, text):
    """The keys towards the world and towards the arm."""
    both = hashlib.blake2b(text, key=link_key, digest_size=64).digest()
    return both[:32], both[32:]


def handshake(link_key, is_towards_world, nonce, header, content):
    """A datagram of the handshake, its nonce of 24 bytes behind the header."""
    key = halves(link_key, b"thimble 1 handshake")[0 if is_towards_world else 1]
    return header + nonce + sealed(hchacha20(key, nonce[:16]), bytes(4) + nonce[16:], header, content)


def session(link_key, is_towards_world, arm_nonce, world_nonce, header, content):
    """A datagram of the session that the header names, under the header's sequence."""
    number, sequence = header[8:16], header[16:24]
    key = halves(link_key, b"thimble 1 session" + arm_nonce + world_nonce + number)[0 if is_towards_world else 1]
    return header + sealed(key, bytes(4) + sequence, header, content)
