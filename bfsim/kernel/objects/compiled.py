"""A kernel's object code, ready to run: translated to native code, and counted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache, cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin.execution.subroutines import LoadedImage, Subroutine
from bfsim.blackfin.timing.tables import Timing
from bfsim.blackfin.translation.room import new_counts
from bfsim.blackfin.translation.tracing import Tracing
from bfsim.files import store
from bfsim.kernel import keys
from bfsim.kernel.calls.access_log import WRITE
from bfsim.kernel.costs.call_paths import Program
from bfsim.kernel.costs.costs import Costs, kept_costs
from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.costs.run_tables import RunTables, tables_of
from bfsim.kernel.ir.text import SourceLine
from bfsim.kernel.language.function import Function
from bfsim.kernel.objects.places import Places
from bfsim.kernel.types import ArrayType

NO_ARRAY = ""
"""Instead of an array's name: memory that belongs to none, such as the stack."""


class _Counted(NamedTuple):
    """How a kernel's object code is counted, and the functions that its instructions belong to."""

    tables: RunTables
    symbols: tuple[str, ...]


_COUNTED: dict[str, _Counted] = {}
_PROGRAMS: dict[str, Program] = {}
"""Costs of object code that this process has read, by their cache keys."""


@dataclass(frozen=True)
class CompiledObject:
    """A kernel's object code.

    `functions`: the kernels and library functions that its instructions belong to; `places`: which belong to which.
    """

    function: Function
    subroutine: Subroutine
    read_program: Callable[[], Program]
    tables: RunTables
    functions: tuple[Function, ...]
    places: Places

    @cached_property
    def program(self) -> Program:
        """How it is counted, and what it costs: most runs need only its `tables`."""
        return self.read_program()

    @property
    def counters(self) -> tuple[Counter, ...]:
        """The counters in the order of the totals, which is that of the translated code's counters."""
        return self.program.counters

    def may_write(self, array: str) -> bool:
        """Whether it may store into an array; code that is not made from Python may always do so."""
        return self.places.files is not None or array in self.function.written

    def new_totals(self) -> NDArray[np.int64]:
        """Return zeros for the events of each counter."""
        return new_counts(self.tables.counters)


def compiled_object(
    function: Function,
    symbol: str,
    loaded: LoadedImage,
    places: Places,
    timing: Timing,
    *,
    traced: bool = False,
) -> CompiledObject:
    """Return the function that `symbol` names in an image, translated or from the cache on disk.

    `timing`: that of the image's code (`Timing.placed`). With `traced`, it reports its accesses to memory. Raises
    KernelError if there is no such function.
    """
    about = loaded.image.digest, symbol, f"{timing.digest} {traced}"
    is_checked = places.files is not None  # code made from Python keeps its arrays aligned
    what = "checked native code" if is_checked else "native code"
    subroutine = loaded.subroutine(symbol, timing, keys.object_key(*about, what), is_checked=is_checked)
    words = [each.name if isinstance(each.type, ArrayType) else "" for each in function.parameters]
    arrays = (*function.array_names, NO_ARRAY) if traced else ()

    def made() -> Costs:
        from bfsim.blackfin.control_flow.pointers import arrays_accessed  # most starts find all costs
        from bfsim.kernel.objects.counted import calls, counters

        counted = subroutine.processor.counted()
        accessed = arrays_accessed(counted.code, subroutine.address, words)
        found = counters(counted.counters, places, timing, accessed, arrays)
        return Costs(tuple(found), calls(counted.code, places, subroutine.address, function.array_names))

    of_what = f"of {function.symbol} {function.parameters} {places.sources_digest}"
    key = keys.object_key(*about, f"costs {of_what}")

    def program() -> Program:
        if key not in _PROGRAMS:  # each run binds the code to another board, but its costs are read once
            _PROGRAMS[key] = Program(
                function.symbol, kept_costs(key, made), function.array_names, together=True
            )
        return _PROGRAMS[key]

    if key not in _COUNTED:
        _COUNTED[key] = _counted(keys.object_key(*about, f"tables {of_what}"), program)
    tables, symbols = _COUNTED[key]
    if traced:
        subroutine.processor.tracing = Tracing(_site_of(program, places), WRITE)
    functions = tuple(map(places.function_called, symbols))
    return CompiledObject(function, subroutine, program, tables, functions, places)


def _counted(key: str, program: Callable[[], Program]) -> _Counted:
    """Return what the cache on disk keeps of a program under a key, or make it now."""

    def made() -> tuple[Any, ...]:
        costs = program().costs
        lines = {one.line.routine for each in costs.counters for one in each.charges} - set(costs.calls)
        return asdict(tables_of(program())), [*costs.calls, *sorted(lines)]

    tables, symbols = store.kept(key, made)
    return _Counted(RunTables(**tables), tuple(symbols))


def code_bytes(symbol: str, loaded: LoadedImage, places: Places) -> dict[str, int]:
    """Return the size of the code of a function in an image, and of each function that it calls, by the names of kernels."""
    key = keys.object_key(loaded.image.digest, symbol, "", "bytes of code")

    def made() -> dict[str, int]:
        found: dict[str, int] = {}
        for each in loaded.explored(loaded.image.address_of(symbol)).blocks.values():
            name = places.function_at(each.start).symbol
            found[name] = found.get(name, 0) + each.end - each.start
        return found

    found: dict[str, int] = store.kept(key, made)
    return found


def _site_of(program: Callable[[], Program], places: Places) -> Callable[[int, int], int]:
    """Return a function that finds the first site of an instruction in a block: that of its line and the first array.

    The sites of the other arrays follow.
    """

    @cache
    def first() -> dict[tuple[str, SourceLine], int]:
        found: dict[tuple[str, SourceLine], int] = {}
        for path in program().paths:
            routine = path.routines[-1]
            for number, site in enumerate(program().own_sites[routine], path.first.site):
                found.setdefault((routine, site.line), number)
        return found

    def site_of(block: int, address: int) -> int:
        return first()[places.function_at(block).symbol, places.line_of(address)]

    return site_of
