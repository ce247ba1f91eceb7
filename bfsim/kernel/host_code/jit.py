"""Kernel → machine code: the code that was costed, with its counters, compiled for the host.

This pass may vectorise and unroll as it likes, because the counters are in the code by then.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from bfsim import machine_code
from bfsim.errors import KernelError
from bfsim.files import store
from bfsim.kernel import function_keys
from bfsim.kernel.calls import crashes
from bfsim.kernel.costs.call_paths import Program
from bfsim.kernel.costs.costs import Costs
from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.costs.run_tables import RunTables, tables_of
from bfsim.kernel.estimate.estimated import costs_of
from bfsim.kernel.host_code.entry import running_name
from bfsim.kernel.language.function import Function
from bfsim.kernel.profile import CompilerProfile
from bfsim.machine_code import Effort


@dataclass(frozen=True, slots=True)
class CompiledKernel:
    """A kernel ready to run: the address of its entry point (see `entry`)."""

    entry: int
    program: Program
    tables: RunTables
    """What a run needs to know of the program."""
    failure: Callable[[], KernelError]
    """Returns the error for a guard's note in the last call; see `guards`."""
    functions: tuple[Function, ...]
    """The kernel and all that it calls."""

    @property
    def counters(self) -> tuple[Counter, ...]:
        """The counters in the order of the totals: each once for each path to its routine."""
        return self.program.counters

    def new_totals(self) -> NDArray[np.int64]:
        """Return zeros for the events of each counter (one word at least, to have an address)."""
        return np.zeros(max(1, self.tables.counters), np.int64)


@cache
def compile_kernel(
    function: Function,
    profile: CompilerProfile,
    *,
    traced: bool = False,
    counted: bool = True,
    checked: bool = True,
    effort: Effort = Effort.ALL,
) -> CompiledKernel:
    """Compile `function`, or take it from the cache on disk; once per process.

    `traced` kernels report every access to the access trace; without `counted` there are no counters
    (the floor that benchmarks compare with) and every call costs 0 cycles; without `checked` indices and divisors are
    not checked and must be known to be right. Code that runs only a few times is ready sooner with less `effort`; its
    results and counts are the same.
    """
    key = function_keys.key(
        function, profile, f"traced={traced} counted={counted} checked={checked} effort={effort.name}"
    )
    entry = _entry_name(key)
    costs = costs_of(function, profile) if counted else Costs()
    program = Program(function.symbol, costs, function.array_names)
    code = store.load(key)
    if code is None:
        from bfsim.kernel.estimate.costing import optimised  # most starts find all machine code
        from bfsim.kernel.host_code.instrument import instrument

        text = instrument(
            optimised(function, profile), function, program, entry, traced=traced, checked=checked,
            as_written=not profile.optimises,
        )  # fmt: skip
        code = machine_code.host_code(text, effort)
        store.save(key, code)
    if not machine_code.address_of(entry):  # else an equal function has loaded it, and its note is there
        machine_code.add(code)
    crashes.watch(machine_code.address_of(running_name(entry)), function)
    return CompiledKernel(
        machine_code.address_of(entry),
        program,
        tables_of(program),
        partial(_failure, function, profile, entry),
        (*function.callees(), function),
    )


def _failure(function: Function, profile: CompilerProfile, entry: str) -> KernelError:
    """Return the error that the guards of a loaded kernel have noted."""
    from bfsim.kernel.estimate.costing import optimised  # few kernels fail
    from bfsim.kernel.host_code.failures import failure
    from bfsim.kernel.host_code.guards import Guarded, note_name

    guarded = Guarded(optimised(function, profile), entry, shifts=not profile.optimises)
    note = (ctypes.c_int64 * guarded.note_words).from_address(machine_code.address_of(note_name(entry)))
    return failure(function, guarded, list(note))


def _entry_name(key: str) -> str:
    return f"bfsim_{key[:24]}"
