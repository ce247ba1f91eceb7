"""Put into the page of the built-in firmware what each of its fast steps saves: `python docs/made/faster.py` after a change of any cycle."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from bfsim.run import simulate
from bfsim.trace.run import RunRecord

PAGE = Path(__file__).parent.parent / "tinyphoon.md"
BLOCK = re.compile(r"(<!-- made by docs/made/faster.py -->\n\n)(?:\|.*\n)*")
CCLK_PER_MS = 600e3

# what a step is, its kernels in the plain firmware and in the fast one
STEPS: Sequence[tuple[str, Sequence[str], Sequence[str]]] = (
    (
        "gradients: roots from a table, and only where both components together reach the threshold; pairs at once",
        ("sobel_row", "magnitude_row"),
        ("sobel_words", "magnitude_words"),
    ),
    (
        "directions of edges alone, by a multiplication; maxima by comparing both components",
        ("direction_row", "suppress_row", "store_edges_row", "count_levels"),
        ("peak_words",),
    ),
    (
        "colours: roots from a table, hues without a division, both pixels of a pair at once",
        ("colour_row",),
        ("colour_words",),
    ),
    ("Gauss of four pixels at once", ("gauss3_row",), ("gauss3_words",)),
    ("grey levels of four pixels at once", ("grey_row",), ("grey_words",)),
    ("opening column by column", ("erode_row", "dilate_row"), ("erode_columns", "dilate_columns")),
)


def costs(run: RunRecord) -> dict[str, float]:
    """Return ms a frame of core A by the kernel that its tasks call, with all that it calls."""
    found: dict[str, float] = {}
    for each in run.paths:
        if each.core == "A":
            cycles = each.issue_cclk + sum(each.stall_cclk.values())
            found[each.path[0]] = found.get(each.path[0], 0.0) + cycles / CCLK_PER_MS / len(run.frames)
    return found


def cost(of: dict[str, float], kernels: Sequence[str]) -> float:
    """Return what these kernels take."""
    return sum(ms for symbol, ms in of.items() if symbol.endswith(tuple(f"_{each}" for each in kernels)))


def table() -> str:
    """Return the table of the steps."""
    plain, fast = simulate(firmware="tinyphoon"), simulate(firmware="fast")
    before, after = costs(plain), costs(fast)
    rows = ["| step | plain, ms | fast, ms |", "|---|--:|--:|"]
    rows += [f"| {what} | {cost(before, old):.2f} | {cost(after, new):.2f} |" for what, old, new in STEPS]
    whole = [
        sum(before.values()) - sum(cost(before, old) for _, old, _ in STEPS),
        sum(after.values()) - sum(cost(after, new) for _, _, new in STEPS),
    ]
    rows.append(f"| all other kernels | {whole[0]:.2f} | {whole[1]:.2f} |")
    return "\n".join(rows)


if __name__ == "__main__":
    PAGE.write_text(BLOCK.sub(lambda found: found[1] + table() + "\n", PAGE.read_text(), count=1))
