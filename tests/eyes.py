"""Firmware of one stage, recordings of noise for it, and its run."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bfsim.recording.writer import RecordingWriter
from bfsim.run import simulate
from bfsim.trace import RunRecord

FIRMWARE = '''\
"""Firmware of one stage: lines in, a kernel with branches and an access to L2, lines out; the cores end together."""
from bfsim.api import *

@kernel
def threshold(line: u8[:], counts: i32[:], out: u8[:]) -> i32:
    found = 0
    for x in range(len(out)):
        out[x] = 0
        if line[x] > 100:
            out[x] = 255
            found += 1
    counts[0] += found
    return found

def main(core):
    while (frame := (yield from core.next_frame())) is not None:
        bright = 0
        with core.stage("Threshold"):
            ring, out = core.input_ring(frame.rows, "ring"), core.output_ring("out", core.rows("image"))
            for _ in range(frame.height):
                source, target = (yield from ring.line()), (yield from out.row())
                bright += yield core.run(threshold, source, core.array(f"counts_{core.name}"), target)
                out.send()
            yield from out.flush()
        core.publish(bright=bright)
        other = "B" if core.name == "A" else "A"
        yield from core.post(core.name)
        yield from core.wait(other)

def buffers(size):
    def of_core(n):
        line = 2 * size.width_px
        return [
            Buffer("camera", u8, line, f"sdram_bank{n}", rows=3 * size.height_px),
            Buffer("image", u8, line, f"sdram_bank{n + 2}", rows=size.height_px),
            Buffer("ring", u8, line, "L1_data_a", rows=2),
            Buffer("out", u8, line, "L1_data_b", rows=2),
        ]
    shared = [Buffer("counts_A", i32, 1, "l2_shared"), Buffer("counts_B", i32, 1, "l2_shared")]
    return {"A": of_core(0), "B": of_core(1), "shared": shared}

eyes = Firmware(mains={"A": main, "B": main}, buffers=buffers, camera="camera", rows=(BudgetRow(stage="Threshold"),))
'''


def record(path: Path, count: int, *, width: int = 32, height: int = 16, period_ns: int = 40_000_000) -> Path:
    """Write a recording of noise."""
    rng = np.random.default_rng(561)
    with RecordingWriter(path, width=width, height=height) as writer:
        for number in range(count):
            left, right = rng.integers(0, 256, (2, height, 2 * width), np.uint8)
            writer.add(left, right, number * period_ns, number * period_ns + 1000)
    return path


def run_eyes(recording: Path, **how: object) -> RunRecord:
    """Run that firmware, which lies in the current folder."""
    return simulate(recording, firmware="fw_eyes:eyes", **how)  # type: ignore[arg-type]
