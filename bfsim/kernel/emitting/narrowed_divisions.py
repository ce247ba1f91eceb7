"""Divisions that LLVM does in fewer bits, where it has dropped their names: they get them back, by the number of their place in the source.

Of a byte divided by 10, of which only a byte is wanted, LLVM makes a new division. In C, `//` and `%` are those of a function of ints.
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
    """Return the module `text` of `function` and its callees with the name of `//` and `%` on each of them that was narrowed."""
    rows = text.splitlines()
    if not any(NARROWED.match(row) for row in rows):
        return text
    rounded, prefix = _rounded_notes(rows, function), f"{ROUNDED}.narrowed"
    while f"%{prefix}." in text:  # of those that have been narrowed before
        prefix += "_"
    for start in [number for number, row in enumerate(rows) if DEFINE.match(row)]:
        end = rows.index("}", start)
        found = (NARROWED.match(row) for row in rows[start:end])
        names = {each[1]: f"%{prefix}.{each[1]}" for each in found if each and each[2] in rounded}
        for number in range(start, end) if names else ():
            rows[number] = _renamed(rows[number], names)
    return "\n".join(rows)


def _rounded_notes(rows: list[str], function: Function) -> set[str]:
    """The numbers of the notes of the places at which `//` or `%` of two i32 stands; of a place without a number, its line decides."""
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
