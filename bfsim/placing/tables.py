"""The result of a placement as rich tables of 80 columns, and as JSON."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.placing.placed import NEAR_CAMERA, Placed
from bfsim.report.jsonable import json_text, jsonable
from bfsim.report.tables.table import new_table, percent, stacked
from bfsim.report.wording.units import size

SCHEMA = "bfsim.place/1"
"""Name and version of the layout; the version rises when the meaning of a key changes or a key goes away."""

LONGEST_NAME = 20


def placed_report(placed: Placed, top: int) -> RenderableType:
    """Return the result: the gain, the placements that were run, the `top` moves, and how full the memories are."""
    return stacked(
        Text("\n".join(_verdict(placed))), _trials(placed), *_moves(placed, top), *_memories(placed)
    )


def placed_json(placed: Placed) -> str:
    """Return everything but the LDF's text as indented JSON. Keys are the field names of `placed`, with units."""
    plain = jsonable(replace(placed, ldf=""))
    del plain["ldf"]
    more = {"predicted_ms": placed.predicted_ms, "after_ms": placed.after_ms}
    return json_text({"schema": SCHEMA, **plain, **more})


def _verdict(placed: Placed) -> Iterator[str]:
    before, after, start = placed.before_ms, placed.after_ms, placed.start
    if not placed.linked:
        yield f"The firmware does not fit with {start}: before is with what did not fit moved elsewhere."
    if placed.best is None:
        than = f" than {start}" if placed.linked else ""
        yield f"{before:.2f} ms a frame ({1000 / before:.2f} Hz): no placement that was found is faster{than}."
    else:
        gain, predicted = (percent(before - each, before) for each in (after, placed.predicted_ms))
        yield (
            f"{before:.2f} → {after:.2f} ms a frame ({1000 / before:.2f} → {1000 / after:.2f} Hz): "
            f"gain {gain} % simulated, {predicted} % predicted."
        )
    if placed.frames == 1:
        yield "Of one frame, with the wait for its picture: the rate is higher with more."
    if after <= NEAR_CAMERA * placed.camera_ms:
        busy_ms = placed.before_busy_ms if placed.best is None else placed.trials[placed.best].busy_ms
        yield (
            f"The cameras bound it: there is a picture every {placed.camera_ms:.2f} ms, wherever things lie. The busier core "
            f"works {placed.before_busy_ms:.2f} → {busy_ms:.2f} ms of that."
        )


def _trials(placed: Placed) -> Table:
    table = new_table("Placements that were run", "", "predicted ms", "simulated ms", "Hz")
    table.add_row("before", "", f"{placed.before_ms:.2f}", f"{1000 / placed.before_ms:.2f}")
    for number, each in enumerate(placed.trials):
        table.add_row(
            f"{number + 1}, from what {'it' if not number else str(number)} measured",
            f"{each.predicted_ms:.2f}",
            f"{each.simulated_ms:.2f}",
            f"{1000 / each.simulated_ms:.2f}",
            style="bold" if number == placed.best else None,
        )
    return table


def _moves(placed: Placed, top: int) -> Iterator[Table]:
    moved = sorted(
        (each for each in placed.parts if each.has_moved),
        key=lambda each: (-each.saved_ms, each.core, each.name),
    )
    if not moved:
        return
    title = (
        f"What moved, {len(moved)} of {len(placed.parts)}, and how much less the cores wait for it in a frame"
    )
    table = new_table(title, "Buffer, or code", "core", "size", "from", "to", "saves ms")
    for column in (table.columns[1], table.columns[3], table.columns[4]):
        column.justify = "left"
    for each in moved[:top]:
        table.add_row(
            _ending(each.name), each.core, size(each.nbytes), each.before, each.after, f"{each.saved_ms:.3f}"
        )
    rest = moved[top:]
    if rest:
        nbytes, saved_ms = sum(each.nbytes for each in rest), sum(each.saved_ms for each in rest)
        table.add_row(f"({len(rest)} others)", "", size(nbytes), "", "", f"{saved_ms:.3f}")
    yield table


def _ending(name: str) -> str:
    """Return a name, or the end of a long one: kernels begin with their module."""
    return name if len(name) <= LONGEST_NAME else f"…{name[1 - LONGEST_NAME :]}"


def _memories(placed: Placed) -> Iterator[Table]:
    if placed.fills:
        table = new_table("Memories", "Memory", "size", "before", "after", "full %")
        for each in placed.fills:
            sizes = (size(nbytes) for nbytes in (each.nbytes, each.before_bytes, each.after_bytes))
            table.add_row(each.memory, *sizes, percent(each.after_bytes, each.nbytes))
        yield table
