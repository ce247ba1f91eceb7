"""A load from where the way to it has loaded, with nothing written since, brings what that one did [pass_fre in tree-ssa-sccvn.cc of GCC 12].

GCC finds that first of all, so that `if a[i] > most: most = a[i]` chooses between two values that are there. LLVM comes to it when it
has made one load of those of both ways.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from bfsim.kernel.ir_text import Routine, renamed
from bfsim.kernel.loops import ControlFlow

COMPUTED = (
    "getelementptr",
    "add",
    "sub",
    "mul",
    "shl",
    "lshr",
    "ashr",
    "and",
    "or",
    "xor",
    "sext",
    "zext",
    "trunc",
)
"""What a place is computed with."""

Key = tuple[object, ...]


def without_repeated_loads(routine: Routine) -> Routine:
    """Return `routine` with the first of such loads in place of each."""
    flow = ControlFlow(routine)
    same = _Repeated(flow).found()
    if not same:
        return routine
    blocks = []
    for block in routine.blocks:
        rows = [renamed(each, same) for each in block.instructions if each.result not in same]
        blocks.append(replace(block, instructions=tuple(rows)))
    return replace(routine, blocks=tuple(blocks))


class _Repeated:
    """Finds loads again that all ways to a block bring; of a way back, none."""

    def __init__(self, flow: ControlFlow) -> None:
        self.flow = flow
        self.same: dict[str, str] = {}
        self.keys: dict[str, Key | str] = {}

    def found(self) -> dict[str, str]:
        """Return the first load for each other one."""
        known: dict[str, dict[Key, str]] = {}
        for label in self.flow.order:
            here = _in_all([known.get(each, {}) for each in self.flow.predecessors[label]])
            for each in self.flow.blocks[label].instructions:
                if each.opcode == "store" or each.is_call:
                    here = {}
                elif each.opcode == "load" and each.result:
                    place = each.text.split(",")[0], self._key(each.operands[0])
                    first = here.setdefault(place, each.result)
                    if first != each.result:
                        self.same[each.result] = first
            known[label] = here
        return self.same

    def _key(self, value: str) -> Key | str:
        """What a value is computed with, the same for all that are."""
        value = self.same.get(value, value)
        if value not in self.keys:
            each = self.flow.instruction(value)
            key: Key | str = value
            if each is not None and each.opcode in COMPUTED:
                kinds = tuple(word for word in each.text.split() if not word.startswith("%"))
                key = (*kinds, *(self._key(operand) for operand in each.operands))
            self.keys[value] = key
        return self.keys[value]


def _in_all(tables: Sequence[dict[Key, str]]) -> dict[Key, str]:
    return (
        {key: value for key, value in tables[0].items() if all(each.get(key) == value for each in tables)}
        if tables
        else {}
    )
