"""Draw what each improvement of the built-in firmware is worth: `python docs/made/waterfall.py`, after a change of any cycle.

From the robot's frame (T Table 6.4) over the steps that the thesis describes to the built-in ones and the fast ones,
one exchanged after the other: each bar is one change. Makes `docs/images/waterfall.png`, and the table below it in
`docs/tinyphoon.md`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from statistics import median

import altair as alt

from bfsim.api import Buffers, Calibration, Firmware
from bfsim.run import simulate
from tinyphoon import fast, thesis, tinyphoon
from tinyphoon.buffers import calibration_buffers
from tinyphoon.features import PLAIN
from tinyphoon.stages.edge_detection import edge_detection, scan
from tinyphoon.stages.sdram_rectification import untouched
from tinyphoon.stages.strong_gradients import STRONG_FIRST
from tinyphoon.variants import FAST, THESIS, mains

DOCS = Path(__file__).parent.parent
PICTURE = DOCS / "images" / "waterfall.png"
PAGE = DOCS / "tinyphoon.md"
BLOCK = re.compile(r"(<!-- made by docs/made/waterfall.py -->\n\n)(?:\|.*\n)*")
ROBOT_MS = 219.0  # T §6.6: the mean of Table 6.4
CCLK_PER_MS = 600e3
COLOURS = {"robot": "#8a8f98", "thesis": "#d9952b", "gain": "#1f5fa8", "cost": "#b3372f"}
"""Of each kind of bar."""
WEAK_REMOVED_FIRST = partial(edge_detection, scanned=partial(scan, steps=STRONG_FIRST))


def frame_ms(firmware: Firmware) -> float:
    """Return the median frame of the built-in recording, from frame 1 on: frame 0 waits for its picture."""
    run = simulate(firmware=firmware)
    return median(
        (frame.cores[0].end_cclk - frame.cores[0].begin_cclk) / CCLK_PER_MS for frame in run.frames[1:]
    )


def windowed(calibration: Calibration) -> Buffers:
    """Return the buffers of the built-in firmware for cameras that have a table, as the robot's had."""
    assert calibration.size
    sources = {core: untouched(calibration.size) for core in ("A", "B")}
    return calibration_buffers(replace(calibration, sources=sources))


def stages() -> Iterator[tuple[str, float]]:
    """Yield each improvement and the frame with it, in ms."""
    yield "the robot (T Table 6.4)", ROBOT_MS
    yield "the thesis's steps, as GCC compiles them", frame_ms(thesis)
    steps, rectified = THESIS, thesis
    for what, change in (
        ("blobs by runs, in one pass", {"blob_detection": PLAIN.blob_detection}),
        ("opening on lines that DMA brings", {"open_closing": PLAIN.open_closing}),
        ("rectification through a window that DMA moves", {"rectification": PLAIN.rectification}),
        ("colours eroded at edges only", {"circle_detection": PLAIN.circle_detection}),
        ("lines by the labels of the row above", {"line_scan": PLAIN.line_scan}),
        ("hysteresis over the edge store", {"edge_detection": WEAK_REMOVED_FIRST}),
        ("a direction for every pixel, weak or not", {"edge_detection": PLAIN.edge_detection}),
    ):
        steps = replace(steps, **change)
        if "rectification" in change:
            rectified = replace(thesis, calibration=windowed)
        yield what, frame_ms(replace(rectified, mains=mains(steps)))
    assert replace(steps, colour_groups=PLAIN.colour_groups) == PLAIN
    yield (
        "finer lines, circles and depths; a thing's hues as one",
        frame_ms(replace(tinyphoon, calibration=windowed)),
    )
    yield "no rectification, which this recording does not need", frame_ms(tinyphoon)
    steps = replace(PLAIN, edge_detection=FAST.edge_detection)
    yield "edges and colours four pixels at once", frame_ms(replace(fast, mains=mains(steps)))
    yield "opening column by column", frame_ms(fast)


def draw(found: list[tuple[str, float]]) -> None:
    """Draw bars from one frame to the next."""
    gains = pairwise(found[1:])
    rows: list[dict[str, object]] = [
        {"what": what, "from": 0.0, "to": ms, "label": f"{ms:.0f} ms", "kind": kind}
        for kind, (what, ms) in zip(("robot", "thesis"), found[:2], strict=True)
    ]
    rows += [
        {
            "what": what,
            "from": before,
            "to": ms,
            "label": f"{ms - before:+.1f}, {ms:.0f} ms",
            "kind": "gain" if ms < before else "cost",
        }
        for (_, before), (what, ms) in gains
    ]
    base = alt.Chart(alt.Data(values=rows)).encode(
        y=alt.Y("what:N", sort=None, title=None, axis=alt.Axis(labelLimit=340)),
        x=alt.X("from:Q", title="ms a frame", scale=alt.Scale(domain=[0, ROBOT_MS + 30])),
        x2="to:Q",
    )
    colours = alt.Scale(domain=list(COLOURS), range=list(COLOURS.values()))
    bars = base.mark_bar(height=18).encode(color=alt.Color("kind:N", scale=colours, legend=None))
    labels = (
        base.mark_text(align="left", dx=6)
        .encode(x=alt.X("right:Q"), text="label:N")
        .transform_calculate(right="max(datum.from, datum.to)")
    )
    chart = (bars + labels).properties(width=560, height=26 * len(rows))
    chart.configure(font="sans-serif").save(PICTURE, scale_factor=1.5)


def main() -> None:
    """Draw the picture and write the table."""
    found = list(stages())
    draw(found)
    rows = ["| | ms a frame | frames/s |", "|---|--:|--:|"]
    rows += [f"| {what} | {ms:.1f} | {1000 / ms:.1f} |" for what, ms in found]
    PAGE.write_text(BLOCK.sub(lambda block: block[1] + "\n".join(rows) + "\n", PAGE.read_text(), count=1))


if __name__ == "__main__":
    main()
