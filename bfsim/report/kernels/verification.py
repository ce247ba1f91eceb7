"""Estimates beside the real compiler's code, as tables and JSON."""

from __future__ import annotations

from pathlib import PurePath

from rich.console import RenderableType
from rich.text import Text

from bfsim.report.jsonable import json_text, jsonable
from bfsim.report.tables.table import new_table, stacked
from bfsim.trace.verification import Verification

SCHEMA = "bfsim.verify/1"
MILLION = 1e6


def verification_report(found: Verification, top: int) -> RenderableType:
    """Return two sentences and the table of `top` kernels."""
    table = new_table(f"Cycles of a frame, {found.profile}", "Kernel", "%", "estimated", "measured", "error")
    for each in found.kernels[:top]:
        table.add_row(
            f"{each.kernel} ({PurePath(each.file).stem})",
            f"{100 * each.measured_cclk / found.measured_cclk:.2f}",
            f"{each.estimated_cclk:,.0f}",
            f"{each.measured_cclk:,.0f}",
            f"{100 * each.error:+.1f} %",
        )
    left_out = len(found.kernels) - len(table.rows)
    note = (
        f"Issue cycles, all cores, without memory and interlocks; {found.played:,} calls "
        f"of {len(found.kernels)} kernel{'s' if len(found.kernels) > 1 else ''} were played, spread evenly over {found.frames} frame{'s' if found.frames > 1 else ''}."
        + (f" {left_out} more with --top {len(found.kernels)}." if left_out else "")
    )
    return stacked(Text(verdict(found)), table, Text(note))


def verdict(found: Verification) -> str:
    """Say by how much the estimate is off, and whether the bits are the same."""
    bits = (
        "Every call leaves the same bits."
        if not found.different
        else f"{found.different} calls leave OTHER BITS, of "
        + ", ".join(each.kernel for each in found.kernels if each.different)
        + "."
    )
    return (
        f"GCC {found.compiler}'s code takes {found.measured_cclk / MILLION:.2f} M cycles a frame; the estimate is off by "
        f"{100 * found.signed_error:+.1f} % in all, and by {100 * found.error_by_share:.1f} % kernel by kernel (the mean, weighted by cycles). "
        f"{bits} {_judged(found)}"
    )


def _judged(found: Verification) -> str:
    """Say what counted the cycles, and whether the translated code and the simulator agree."""
    if not found.is_judged:
        return "The cycles are those of its instructions, translated; there was no GNU simulator to compare with."
    if not found.unequal:
        return "Translated, it takes the GNU simulator's cycles in every call: difference 0."
    names = ", ".join(each.kernel for each in found.kernels if each.unequal)
    return f"Translated, it takes OTHER CYCLES than under the GNU simulator in {found.unequal} calls, of {names}."


def verification_json(found: Verification) -> str:
    """Return the comparison as indented text that ends in a line feed; keys are the field names of `bfsim.trace.verification`."""
    totals = {
        "signed_error": found.signed_error,
        "error_by_share": found.error_by_share,
        "different": found.different,
        "unequal": found.unequal,
    }
    return json_text({"schema": SCHEMA, **totals, **jsonable(found)})
