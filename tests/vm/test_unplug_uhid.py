"""unplugged.py, through uhid: there a plug keeps the only processor for up to 2 ms, so a sample may be stale, and the wall let go for a moment.
What is never is a stop: that comes after 20 ms without a sample (DESIGN)."""

import unplugged


class UnpluggedFromUhid(unplugged.Unplugged):
    gap_s = {"in": 0.01, "out": 0.01}
