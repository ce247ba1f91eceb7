"""Firmware that can be loaded, without a fault and without work."""

from __future__ import annotations

GOOD = """\
from bfsim.api import *

def main(core):
    while (yield from core.next_frame()) is not None:
        pass

fw = Firmware(mains={"A": main, "B": main}, buffers=lambda size: {}, camera="camera", rows=())
"""
