"""The registers that an instruction reads and writes, according to its semantics.

The semantics are called once with `Effects` that take note. Flags count as registers of one bit, except sticky ones,
which no instruction waits for.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from llvmlite import ir

from bfsim.blackfin.instructions.decode import Instruction
from bfsim.blackfin.instructions.effects import I32, Effects
from bfsim.blackfin.instructions.registers import FLAGS, STATE, width
from bfsim.blackfin.instructions.semantics import SEMANTICS
from bfsim.blackfin.instructions.value import Value

UNSEEN = {"PC", "CLOCK", "WAITED", "FUEL", "ARGUMENT", "TRACE", "ASTAT_UNUSED", "CYCLES_OFFSET"} | {
    each for each in FLAGS if each.endswith(("S", "_COPY"))
}
"""Slots of the state that no instruction waits for."""
VISIBLE = frozenset(STATE) - UNSEEN


@dataclass(frozen=True, slots=True)
class Registers:
    """An instruction's effect on registers. `loaded`: those of `writes` that get an unchanged word. `does`: of its forms."""

    reads: frozenset[str]
    writes: frozenset[str]
    loaded: frozenset[str]
    does: frozenset[str]


@dataclass(slots=True)
class _Noting(Effects):
    """Effects that remember the words that were loaded."""

    words: list[ir.Value] = field(default_factory=list)

    def load(self, address: Value, nbytes: int) -> Value:
        found = Effects.load(self, address, nbytes)
        self.words.append(found.ir)
        return found


_known: dict[tuple[object, ...], Registers] = {}


def registers_of(instruction: Instruction) -> Registers:
    """Return the registers of an instruction; for a bundle, those of all its parts."""
    key = tuple((id(each.form), *each.operands.values()) for each in instruction.operations)
    if key not in _known:
        _known[key] = _noted(instruction)
    return _known[key]


def _noted(instruction: Instruction) -> Registers:
    function = ir.Function(ir.Module(), ir.FunctionType(ir.VoidType(), (ir.PointerType(),)), "f")
    builder = ir.IRBuilder(function.append_basic_block())
    reads: set[str] = set()

    def fetch(register: str) -> ir.Value:
        reads.add(register)
        return builder.load(function.args[0], typ=ir.IntType(width(register)))

    following = Value(builder, I32(instruction.end))
    clock = Value(builder, ir.Constant(ir.IntType(64), 0))
    effects = _Noting(builder, fetch, function.args[0], lambda: clock, instruction.address, lambda: following)
    for each in instruction.operations:
        SEMANTICS[each.form.does](effects, **each.operands, **each.form.given)
    loaded = {
        name for name, value in effects.pending.items() if any(value.ir is each for each in effects.words)
    }
    writes = VISIBLE.intersection(effects.pending)
    does = frozenset(each.form.does for each in instruction.operations)
    return Registers(VISIBLE & reads, writes, writes & loaded, does)
