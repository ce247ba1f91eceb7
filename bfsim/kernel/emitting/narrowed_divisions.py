"""Divisions that LLVM narrowed, and whose names it dropped, get them back by the number of their site.

If a byte is divided by 10 and only a byte of the result is wanted, LLVM makes a new division in fewer bits. In C, `//`
and `%` are a function of ints.
"""

from __future__ import annotations

import re

from bfsim.kernel.emitting.divisions import ROUNDED
from bfsim.kernel.emitting.emit import sites_of
from bfsim.kernel.ir.reading import DEFINE, SUBPROGRAM
from bfsim.kernel.language import tree
from bfsim.kernel.language.function import Function
from bfsim.kernel.types import i32

NARROWED = re.compile(r"^  %(\d+) = [us](?:div|rem) i(?:8|16) .*!dbg !(\d+)")
NOTE = re.compile(r"^!(\d+) = (?:distinct )?!DILocation\(line: (\d+),(?: column: (\d+),)? scope: !(\d+)")


def with_rounded_names(text: str, function: Function) -> str:
    """Return the module `text` of `function` and its callees, with the name of `//` and `%` on each that was narrowed."""
    rows = text.splitlines()
    if not any(NARROWED.match(row) for row in rows):
        return text
    rounded, prefix = _rounded_notes(rows, function), f"{ROUNDED}.narrowed"
    while f"%{prefix}." in text:  # taken by divisions that were narrowed earlier
        prefix += "_"
    for start in [number for number, row in enumerate(rows) if DEFINE.match(row)]:
        end = rows.index("}", start)
        found = (NARROWED.match(row) for row in rows[start:end])
        names = {each[1]: f"%{prefix}.{each[1]}" for each in found if each and each[2] in rounded}
        for number in range(start, end) if names else ():
            rows[number] = _renamed(rows[number], names)
    return "\n".join(rows)


def _rounded_notes(rows: list[str], function: Function) -> set[str]:
    """Return the numbers of the debug locations of `//` and `%` of two i32; without a column, the line decides."""
    symbols = {found[1]: found[2] for found in map(SUBPROGRAM.match, rows) if found}
    sites = sites_of(function)
    notes = set[str]()
    for note in filter(None, map(NOTE.match, rows)):
        here, number = sites[symbols[note[4]]], int(note[3] or 0)
        nodes = here[number - 1 : number] if number else [each for each in here if each.line == int(note[2])]
        if any(
            isinstance(each, tree.Binary) and each.op in ("//", "%") and each.type is i32 for each in nodes
        ):
            notes.add(note[1])
    return notes


def _renamed(row: str, names: dict[str, str]) -> str:
    return re.sub(r"%(\d+)\b", lambda found: names.get(found[1], found[0]), row)
