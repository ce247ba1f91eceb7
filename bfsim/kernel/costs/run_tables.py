"""What a run needs to count and charge the calls of a program, as kept in the cache on disk: a small part of its costs.

Reports read all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from bfsim.kernel.costs.call_paths import CountedAccesses, Program, RoutineCosts


@dataclass(frozen=True)
class RunTables:
    """Tables of a program, as JSON has them.

    `counters`: how many there are; `routines`: those that they belong to, each once. `site_routines`: the routine of
    each site's line. `costs` and `accesses`: as in `Program`.
    """

    counters: int
    routines: list[str]
    site_routines: list[str]
    kept_costs: list[list[Any]]
    kept_accesses: list[list[Any]]

    @cached_property
    def costs(self) -> RoutineCosts:
        """The routines whose calls and cycles each counter counts."""
        symbols, counter, routine, costs = self.kept_costs
        counters, routines = (np.array(each, np.int64) for each in (counter, routine))
        return RoutineCosts(tuple(symbols), counters, routines, np.array(costs, np.int64).reshape(-1, 3))

    @cached_property
    def accesses(self) -> tuple[CountedAccesses, ...]:
        """The accesses to its arrays by the events of its counters."""
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
