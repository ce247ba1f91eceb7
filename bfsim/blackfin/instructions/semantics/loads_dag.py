"""The data address generators.

An index I that steps out of the buffer of L bytes at B comes in again at its other end; with L = 0 there is no buffer.
The adders of the hardware decide what happens to an index that was outside its buffer, or near the ends of the address
space.
"""

from __future__ import annotations

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.semantics.arithmetic import sum_reversed
from bfsim.blackfin.instructions.semantics.results import write_half
from bfsim.blackfin.instructions.value import Value

ALIGNED = 0xFFFFFFFC


def load_indexed(fx: Effects, d: str, i: str, half: str, step: int = 0, m: str | None = None) -> None:
    address = fx.read(i)
    if half == "whole":
        fx.write(d, fx.load(address & ALIGNED if fx.aligns else address, 4))
    else:
        write_half(fx, d, half == "high", fx.load(address, 2))
    _step(fx, i, step, m)


def store_indexed(fx: Effects, d: str, i: str, half: str, step: int = 0, m: str | None = None) -> None:
    stored = {"whole": fx.read, "low": fx.low, "high": fx.high}[half](d)
    fx.store(fx.read(i), stored)
    _step(fx, i, step, m)


def modify_index(fx: Effects, i: str, step: int) -> None:
    _step(fx, i, step, None)


def modify_index_by_register(fx: Effects, i: str, m: str, sign: int) -> None:
    (_add if sign > 0 else _subtract)(fx, i, fx.read(m))


def modify_index_reversed(fx: Effects, i: str, m: str) -> None:
    """Step in the order of a fast Fourier transform; no buffer counts here."""
    fx.write(i, sum_reversed(fx.read(i), fx.read(m)))


def _step(fx: Effects, i: str, step: int, m: str | None) -> None:
    if m is not None:
        _add(fx, i, fx.read(m))
    elif step > 0:
        _add(fx, i, fx.constant(step))
    elif step < 0:
        _subtract(fx, i, fx.constant(-step))


def _add(fx: Effects, i: str, step: Value) -> None:
    index, base, length = fx.read(i), fx.read(f"B{i[1]}"), fx.read(f"L{i[1]}")
    new = index + step
    carry, end, end_carry = new.below(index), base + length, (base + length).below(base)
    up = _is_below(new.below(end), carry.equals(end_carry)).choose(new, new - length)
    down = _is_below(new.below(base), index.negative() | carry).choose(new + length, new)
    fx.write(i, step.negative().choose(down, up))


def _subtract(fx: Effects, i: str, step: Value) -> None:
    index, base, length = fx.read(i), fx.read(f"B{i[1]}"), fx.read(f"L{i[1]}")
    new = index - step
    carry, end, end_carry = _carry(index, -step), base + length, (base + length).below(base)
    up = _is_below(new.below(end), (index.negative() & carry).equals(end_carry)).choose(new, new - length)
    down = _is_below(new.below(base), step.equals(0) | carry).choose(new + length, new)
    fx.write(i, step.negative().choose(up, down))


def _carry(left: Value, right: Value) -> Value:
    """Whether the sum of two words does not fit in one."""
    return (left + right).below(left)


def _is_below(below: Value, same_turn: Value) -> Value:
    """Whether an address is below a bound; inverted if only one of them has wrapped round the address space."""
    return below.equals(same_turn)
