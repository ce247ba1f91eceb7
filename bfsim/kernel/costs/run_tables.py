"""What a run must know of a program to count and to charge its calls, as the cache on disk keeps it: a small part of the costs, which reports read."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from bfsim.kernel.costs.call_paths import CountedAccesses, Program, RoutineCosts


@dataclass(frozen=True)
class RunTables:
    """Tables of a program, as JSON has them.

    `counters`: how many there are; `routines`: whose they are, each once. `site_routines`: that of each site's line. `costs` and `accesses`
    as the program has them.
    """

    counters: int
    routines: list[str]
    site_routines: list[str]
    kept_costs: list[list[Any]]
    kept_accesses: list[list[Any]]

    @cached_property
    def costs(self) -> RoutineCosts:
        """Whose calls and cycles each counter counts."""
        symbols, counter, routine, costs = self.kept_costs
        counters, routines = (np.array(each, np.int64) for each in (counter, routine))
        return RoutineCosts(tuple(symbols), counters, routines, np.array(costs, np.int64).reshape(-1, 3))

    @cached_property
    def accesses(self) -> tuple[CountedAccesses, ...]:
        """What the events of its counters access in its arrays."""
        return tuple(CountedAccesses(*each) for each in self.kept_accesses)


def tables_of(program: Program) -> RunTables:
    """Return the tables of a program."""
    symbols, *numbers = program.routine_costs
    return RunTables(
        counters=len(program.counters),
        routines=[*dict.fromkeys(each.routine for each in program.costs.counters)],
        site_routines=[each.line.routine for each in program.sites],
        kept_costs=[list(symbols), *(each.tolist() for each in numbers)],
        kept_accesses=[list(each) for each in program.accesses],
    )
