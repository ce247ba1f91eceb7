"""A kernel's object code, ready to run: translated to native code, and counted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin.subroutines import LoadedImage, Subroutine
from bfsim.blackfin.timing import GNU, Timing
from bfsim.kernel import keys, tree
from bfsim.kernel.call_paths import Program
from bfsim.kernel.costs import Costs, kept_costs
from bfsim.kernel.counters import Counter
from bfsim.kernel.objects.counted import calls, counters
from bfsim.kernel.objects.places import Places


@dataclass(frozen=True)
class CompiledObject:
    """A kernel's object code. `functions`: the kernels, and functions of libraries, that its instructions are of; `places`: which are where."""

    function: tree.Function
    subroutine: Subroutine
    program: Program
    functions: tuple[tree.Function, ...]
    places: Places
    order: NDArray[np.int64]
    """Of each counter of the program, the number of the translated code's counter."""

    @property
    def counters(self) -> tuple[Counter, ...]:
        """What is counted, in the order of the totals."""
        return self.program.counters

    def new_totals(self) -> NDArray[np.int64]:
        """Return zeros for the events of each counter."""
        return np.zeros(max(1, len(self.counters)), np.int64)


def compiled_object(
    function: tree.Function, symbol: str, loaded: LoadedImage, places: Places, timing: Timing = GNU
) -> CompiledObject:
    """Return the function that `symbol` names in an image, translated or from the cache on disk. Raises KernelError where there is none."""
    about = loaded.image.digest, symbol, repr(timing)
    subroutine = loaded.subroutine(symbol, timing, keys.object_key(*about, "native code"))

    def made() -> Costs:
        translated = subroutine.translated
        found = counters(translated.counters, places, timing)
        return Costs(tuple(found), calls(translated.code, places, subroutine.address))

    key = keys.object_key(*about, f"costs of {function.symbol}")
    costs = (
        made() if places.folder else kept_costs(key, made)
    )  # lines of files that may change are looked up anew
    program = Program(function.symbol, costs, function.array_names, together=True)
    numbers = {id(each): number for number, each in enumerate(costs.counters)}
    order = np.array([numbers[id(each)] for each in program.counters], np.int64)
    lines = {line.routine for each in costs.counters for line, _, _ in each.line_cclk} - set(costs.calls)
    functions = tuple(places.function_called(each) for each in (*costs.calls, *sorted(lines)))
    return CompiledObject(function, subroutine, program, functions, places, order)
