"""Blocks before loops that begin right behind another one: what is set up there must not run in every iteration of the first."""

from __future__ import annotations

import re
from collections.abc import Iterator

from bfsim.kernel.ir_text import DEFINE, LABEL, Routine, read_module
from bfsim.kernel.loops import ControlFlow

ENDING = ".before"


def with_preheaders(text: str) -> str:
    """Return the module `text` with an empty block between such loops."""
    edges = {(routine.symbol, *edge) for routine in read_module(text) for edge in _edges(routine)}
    return "\n".join(_rows(text, edges)) if edges else text


def _edges(routine: Routine) -> Iterator[tuple[str, str]]:
    """(last block of a loop, header of the one behind it)."""
    flow = ControlFlow(routine)
    for loop in flow.loops:
        before = [each for each in flow.predecessors[loop.header] if each not in loop.blocks]
        if len(before) == 1 and flow.innermost(before[0]) is not flow.around(loop):
            yield before[0], loop.header


def _rows(text: str, edges: set[tuple[str, str, str]]) -> Iterator[str]:
    symbol = label = ""
    notes: dict[str, str] = {}
    for line in text.splitlines():
        row = line
        if found := DEFINE.match(row):
            symbol = found.group(1)
        elif found := LABEL.match(row):
            label = found.group(1)
        for _, before, header in (each for each in edges if each[0] == symbol):
            if label == before and row.startswith("  br "):
                notes[header] = "".join(re.findall(r", !dbg !\d+", row))
                row = re.sub(rf"label %{re.escape(header)}(?![\w.$-])", f"label %{header}{ENDING}", row)
            elif label == header and " = phi " in row:
                row = row.replace(f", %{before} ]", f", %{header}{ENDING} ]")
        if label and row == "}":
            yield from _blocks({header: notes[header] for each, _, header in edges if each == symbol})
        yield row


def _blocks(notes: dict[str, str]) -> Iterator[str]:
    for header in sorted(notes):
        yield from ("", f"{header}{ENDING}:", f"  br label %{header}{notes[header]}")
