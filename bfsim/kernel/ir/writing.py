"""LLVM IR written: the text of a module, with other bodies of its functions or with a name for every value."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from bfsim.kernel.ir.reading import DEFINE
from bfsim.kernel.ir.text import Instruction, Routine

NUMBERED = re.compile(r"%(\d+)\b|^(\d+)(?=:)", re.MULTILINE)
NOTE = re.compile(r"^!(\d+) = ", re.MULTILINE)


def with_names(text: str) -> str:
    """Return a module in which every value and block has a name: LLVM numbers the others by order, which passes change.

    The names differ from those of earlier calls.
    """
    mark = ".n"
    while f"%{mark}" in text:
        mark += "n"
    return NUMBERED.sub(lambda found: f"%{mark}{found[1]}" if found[1] else f"{mark}{found[2]}", text)


def write_module(text: str, routines: Sequence[Routine]) -> str:
    """Return the module `text` with `routines`, one for each of its functions and in their order, as their bodies.

    Weights that no note has yet get one.
    """
    notes = dict[tuple[int, ...], str]()
    first = max(map(int, NOTE.findall(text)), default=-1) + 1

    def noted(each: Instruction) -> Instruction:
        if not each.weights or each.hint:
            return each
        return replace(each, hint=notes.setdefault(each.weights, str(first + len(notes))))

    bodies = [
        replace(
            routine,
            blocks=tuple(
                replace(block, instructions=tuple(map(noted, block.instructions))) for block in routine.blocks
            ),
        )
        for routine in routines
    ]
    words = (
        f'!{number} = !{{!"branch_weights", {", ".join(f"i32 {each}" for each in weights)}}}'
        for weights, number in notes.items()
    )
    return "\n".join((*_rows(text, iter(bodies)), *words))


def _rows(text: str, routines: Iterator[Routine]) -> Iterator[str]:
    rows = iter(text.splitlines())
    for row in rows:
        yield row
        if DEFINE.match(row):
            for block in next(routines).blocks:
                yield from block.rows()
            yield next(each for each in rows if each == "}")
