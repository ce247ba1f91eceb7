"""What an instruction does with pointers: the registers from which its results and the addresses of its accesses come.

The semantics are called once, with values that know their origins instead of numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from llvmlite import ir

from bfsim.blackfin.instructions.decode import Instruction
from bfsim.blackfin.instructions.effects import I32, Effects
from bfsim.blackfin.instructions.registers import width
from bfsim.blackfin.instructions.semantics import SEMANTICS
from bfsim.blackfin.instructions.value import Value

NOWHERE = frozenset[str]()


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a value comes from: registers, by their names, and words that the instruction has loaded, as "load 0", "load 1" ...

    `less`: what was subtracted from it: a pointer less a pointer into the same array is a number. `terms`: what it is the
    sum of, apart from the constant `offset`, so a constant has none; None if it is no such sum.
    """

    of: frozenset[str] = NOWHERE
    less: frozenset[str] = NOWHERE
    terms: tuple[str, ...] | None = None
    offset: int = 0

    @property
    def base(self) -> str:
        """What it is, apart from `offset`, if that is one register or loaded word."""
        return self.terms[0] if self.terms and len(self.terms) == 1 else ""


@dataclass(frozen=True, slots=True)
class MemoryAccess:
    """A load, or a store of `stored`, of some bytes at an address."""

    address: Origin
    nbytes: int
    stored: Origin | None = None


@dataclass(frozen=True, slots=True)
class Made:
    """What an instruction makes: values of registers, and its accesses, the loads numbered in their order."""

    writes: Mapping[str, Origin]
    accesses: tuple[MemoryAccess, ...]


@dataclass(frozen=True, slots=True)
class _Known:
    """A value in place of one of LLVM's."""

    type: ir.IntType
    origin: Origin


class _Builder:
    """Makes origins where LLVM's builder makes instructions."""

    def add(self, one: Any, other: Any) -> _Known:
        return self._sum(one, other, 1)

    def sub(self, one: Any, other: Any) -> _Known:
        return self._sum(one, other, -1)

    def select(self, _condition: Any, one: Any, other: Any) -> _Known:
        same = _origin(one) == _origin(other)
        return _Known(one.type, _origin(one) if same else _mixed(one, other))

    def shl(self, one: Any, other: Any) -> _Known:
        is_same = isinstance(other, ir.Constant) and not other.constant
        return _Known(one.type, _origin(one) if is_same else _mixed(one, other))

    def icmp_signed(self, *_operands: Any) -> _Known:
        return _Known(ir.IntType(1), Origin())

    icmp_unsigned = icmp_signed

    def __getattr__(self, _name: str) -> Callable[..., _Known]:
        return _converted

    @staticmethod
    def _sum(one: Any, other: Any, sign: int) -> _Known:
        left, right = _origin(one), _origin(other)
        if sign < 0 and right.terms != ():
            return _Known(one.type, Origin(left.of, left.less | right.of))
        terms = None if left.terms is None or right.terms is None else left.terms + right.terms
        found = Origin(left.of | right.of, left.less | right.less, terms, left.offset + sign * right.offset)
        return _Known(one.type, found)


def _converted(*operands: Any) -> _Known:
    """Return the result of an operation on some values, perhaps of another type."""
    kinds = [each for each in operands if isinstance(each, ir.IntType)]
    values = [each for each in operands if not isinstance(each, ir.IntType)]
    is_same = len(values) == 1 and isinstance(values[0], _Known)
    return _Known(kinds[0] if kinds else values[0].type, values[0].origin if is_same else _mixed(*values))


def _mixed(*values: Any) -> Origin:
    origins = [_origin(each) for each in values]
    of = frozenset(name for each in origins for name in each.of)
    return Origin(of, frozenset(name for each in origins for name in each.less))


def _origin(value: Any) -> Origin:
    if isinstance(value, _Known):
        return value.origin
    number = value.constant
    return Origin(terms=(), offset=number - (1 << value.type.width) * (number >> value.type.width - 1))


@dataclass(slots=True)
class _Tracking(Effects):
    """Effects that keep origins."""

    accesses: list[MemoryAccess] = field(default_factory=list)

    def load(self, address: Value, nbytes: int) -> Value:
        loaded = f"load {sum(each.stored is None for each in self.accesses)}"
        self.accesses.append(MemoryAccess(_origin(address.ir), nbytes))
        return _named(self.builder, loaded, 8 * nbytes)

    def store(self, address: Value, value: Value) -> None:
        self.accesses.append(MemoryAccess(_origin(address.ir), value.bits // 8, _origin(value.ir)))

    def _fetched(self, register: str) -> Value:
        return _named(self.builder, register, width(register))


def _named(builder: Any, name: str, bits: int) -> Value:
    return Value(builder, _Known(ir.IntType(bits), Origin(frozenset({name}), NOWHERE, (name,))))


_known: dict[tuple[object, ...], Made] = {}


def made_by(instruction: Instruction) -> Made:
    """Return what an instruction makes; for a bundle, what all of it makes."""
    key = tuple((id(each.form), *each.operands.values()) for each in instruction.operations)
    if key not in _known:
        builder: Any = _Builder()
        clock = Value(builder, ir.Constant(ir.IntType(64), 0))
        following = Value(builder, I32(instruction.end))
        effects = _Tracking(
            builder, lambda _: None, None, lambda: clock, instruction.address, lambda: following
        )
        for each in instruction.operations:
            SEMANTICS[each.form.does](effects, **each.operands, **each.form.given)
        writes = {name: _origin(value.ir) for name, value in effects.pending.items()}
        _known[key] = Made(writes, tuple(effects.accesses))
    return _known[key]
