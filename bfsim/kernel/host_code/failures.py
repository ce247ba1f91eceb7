"""A guard's note → the error for the author of the kernel: file, line and column, kernel, array, index and length."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from bfsim.errors import KernelError
from bfsim.kernel.emitting.emit import Sites, sites_of
from bfsim.kernel.host_code.guards import CALLS, FIRST, NUMBER, SECOND, Guard, Guarded, Shift, SourcePlace
from bfsim.kernel.language import tree
from bfsim.kernel.language.function import Function
from bfsim.kernel.language.refusal import KernelSource
from bfsim.kernel.types import i32, u32

_, HIGHEST = i32.bounds


def failure(function: Function, guarded: Guarded, note: Sequence[int]) -> KernelError:
    """Return the error for a note of `guarded`, the code of `function` and its callees."""
    routines = {each.symbol: each for each in (*function.callees(), function)}
    guard = guarded.guards[note[NUMBER] - 1]
    here, *callers = _way(guarded, guard, note)
    routine, sites = routines[here.routine], _sites(guard, sites_of(function)[here.routine])
    first, *others = sorted({each.line for each in sites}) or [max(1, here.line)]
    place, shown = _pointed(routine, first, {each.column for each in sites if each.line == first})
    same = f"; or line {' or '.join(str(routine.first_line + each - 1) for each in others)}" if others else ""
    calls = "".join(f"; called at {_place(routines[each.routine], each.line)}" for each in callers)
    told = {tree.Binary: _of_divisor, tree.For: _of_steps, Shift: _of_shift}.get(guard.node, _of_index)
    what, must_be = told(sites, note[FIRST], note[SECOND])
    return KernelError(f"{place}: {what} in kernel {routine.name}{same}; {must_be}{calls}{shown}")


def _way(guarded: Guarded, guard: Guard, note: Sequence[int]) -> Iterator[SourcePlace]:
    """Yield the place of `guard`, and of each call on the way to it, the last one first."""
    yield from guard.places
    while number := note[CALLS + guarded.routines.index(guard.routine)]:
        guard = guarded.guards[number - 1]
        yield from guard.places


def _sites(guard: Guard, known: Sites) -> Sites:
    """Return what `guard` checks: one access or division, several that the compiler has merged into one, or none.

    There is none if it has merged accesses in several kernels, which it inlined.
    """
    here, is_inlined = guard.places[0], len(guard.places) > 1
    if here.site:
        return (known[here.site - 1],)
    alike = [each for each in known if type(each) is guard.node]
    by_array = [each for each in alike if not is_inlined and getattr(each, "array", None) == guard.array]
    by_line = [each for each in by_array or alike if each.line == here.line]
    return tuple(by_line or by_array or alike)


def _of_index(sites: Sites, index: int, length: int) -> tuple[str, str]:
    """Return what is wrong with an index, and what it must be."""
    accesses = [each for each in sites if isinstance(each, (tree.Load, tree.Store))]
    if not accesses:
        return (
            f"index {i32(index)} is outside of an array",
            f"an index must be 0 or more and less than {length}",
        )
    shown = index if accesses[0].index.type is u32 else i32(index)
    arrays = list(dict.fromkeys(each.array for each in accesses))
    lengths = " or ".join(f"len({each})" for each in arrays)
    return (
        f"index {shown} is outside of {' or '.join(arrays)}",
        f"an index must be 0 or more and less than {lengths}, which is {length}",
    )


def _of_divisor(sites: Sites, dividend: int, divisor: int) -> tuple[str, str]:
    """Return what is wrong with a division, and what the divisor must be."""
    operator = sites[0].op if sites and isinstance(sites[0], tree.Binary) else "//"
    condition = f" where the dividend is {dividend}" if divisor else ""
    is_function = operator.isidentifier()
    shown = f"{operator}({dividend}, {divisor})" if is_function else f"{dividend} {operator} {divisor}"
    return f"{shown} is undefined", f"the divisor must not be {divisor}{condition}"


def _of_steps(_sites: Sites, step: int, stop: int) -> tuple[str, str]:
    """Return what is wrong with the step of a loop, and what it must be."""
    if step < 1:
        return f"a range has the step {step}", "a step must be 1 or more, or a negative constant"
    return (
        f"a range to {stop} in steps of {step} goes beyond {HIGHEST}",
        "its counter must stay an i32: take a smaller step, or end it earlier",
    )


def _of_shift(_sites: Sites, count: int, _: int) -> tuple[str, str]:
    """Return what is wrong with a shift, and what it must be."""
    return f"a shift is by {count}", "a shift must be by 0 to 31"


def _pointed(routine: Function, line: int, columns: Collection[int]) -> tuple[str, str]:
    """Return a place and its line, with the column and a caret if the failure can only be in one of the `columns`."""
    if len(columns) == 1:
        return KernelSource(routine.file, routine.first_line, routine.source).place(line, *columns)
    return _place(routine, line), f"\n    {routine.lines[line - 1].strip()}"


def _place(routine: Function, line: int) -> str:
    return f"{routine.file}:{routine.first_line + max(1, line) - 1}"
