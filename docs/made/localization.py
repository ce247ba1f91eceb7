"""Draw how well a robot localizes itself: `python docs/made/localization.py DRIVE.mcap`, a recording of the example's drive.

Makes `docs/images/localization.png`, and the sentence below it in `docs/how-to/localize.md`.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import altair as alt
import numpy as np

DOCS = Path(__file__).parent.parent
sys.path.insert(0, str(DOCS.parent / "examples" / "self_localization"))

from drive import PERIOD_NS  # noqa: E402
from localize import Step, known_of, localize, messages_of  # noqa: E402

PICTURE = DOCS / "images" / "localization.png"
PAGE = DOCS / "how-to" / "localize.md"
BLOCK = re.compile(r"(<!-- made by docs/made/localization.py -->\n\n)(?:On the drive.*\n(?:.+\n)*\n)?")
SEEDS = range(2007, 2017)
SETTLED = 5  # frames until the particles are together


def draw(steps: list[Step]) -> None:
    """Draw the errors of place and heading over time, one beneath the other."""
    rows = [
        {"s": number * PERIOD_NS / 1e9, "mm": mm, "what": what, "deg": each.error_deg}
        for number, each in enumerate(steps)
        for what, mm in (
            ("particle filter", each.error_mm),
            ("scatter of its particles", each.scatter_mm),
            ("wheels alone, from the true start", each.wheels_error_mm),
        )
    ]
    base = alt.Chart(alt.Data(values=rows)).encode(x=alt.X("s:Q", title="seconds"))
    colours = alt.Scale(range=["#1f5fa8", "#9dbfe6", "#d9952b"])
    places = base.mark_line(point=True).encode(
        y=alt.Y("mm:Q", title="off by, mm"),
        color=alt.Color(
            "what:N", sort=None, title=None, scale=colours, legend=alt.Legend(orient="top", labelLimit=400)
        ),
    )
    headings = (
        base.transform_filter("datum.what == 'particle filter'")
        .mark_line(point=True, color="#1f5fa8")
        .encode(y=alt.Y("deg:Q", title="off by, degrees"))
    )
    size = {"width": 560, "height": 170}
    chart = (places.properties(**size) & headings.properties(**size)).configure(font="sans-serif")
    chart.save(PICTURE, scale_factor=1.5)


def said(runs: list[list[Step]]) -> str:
    """Return the errors of the drive in words, over all seeds."""
    later = [each for steps in runs for each in steps[SETTLED:]]
    mm, deg = [each.error_mm for each in later], [each.error_deg for each in later]
    wheels = [steps[-1].wheels_error_mm for steps in runs]
    return (
        f"On the drive of {len(runs[0])} frames, over {len(runs)} seeds and from frame {SETTLED} on, the place is off by {np.mean(mm):.0f} mm\n"
        f"(median {np.median(mm):.0f}, at most {max(mm):.0f}) and the heading by {np.mean(deg):.1f} degrees "
        f"(median {np.median(deg):.1f}, at most {max(deg):.1f}). With the\n"
        f"wheels alone, from the true start, the robot is {np.mean(wheels):.0f} mm off at the end. The picture shows seed {SEEDS[0]}.\n\n"
    )


def main() -> None:
    """Draw the picture and write the sentence."""
    if len(sys.argv) != 2:
        sys.exit("usage: python docs/made/localization.py DRIVE.mcap")
    recording = Path(sys.argv[1])
    known, messages = known_of(recording), messages_of(recording)
    runs = [localize(*known, messages, seed) for seed in SEEDS]
    draw(runs[0])
    PAGE.write_text(BLOCK.sub(lambda block: block[1] + said(runs), PAGE.read_text(), count=1))


if __name__ == "__main__":
    main()
