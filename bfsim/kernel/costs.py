"""What a kernel costs, costed once and kept in the cache."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from bfsim import store
from bfsim.kernel import keys, tree
from bfsim.kernel.call_paths import RoutineCall
from bfsim.kernel.counters import Counter
from bfsim.kernel.ir_text import Entrance, SourceLine
from bfsim.kernel.isa import Op
from bfsim.kernel.lowering.charges import Access, Charge
from bfsim.kernel.profile import CompilerProfile


@dataclass(frozen=True, slots=True)
class Costs:
    """What a kernel costs: `counters` of its routines, its own and those it calls, and how it comes from one to the other.

    `calls`: of each routine its calls of others, in the order of its text. `inlined`: through which routines an inlined call
    came, by its number (`SourceLine.site`), the routine that it was inlined into first.
    """

    counters: tuple[Counter, ...] = ()
    calls: Mapping[str, tuple[RoutineCall, ...]] = field(default_factory=dict)
    inlined: Mapping[int, tuple[str, ...]] = field(default_factory=dict)


@cache
def costs_of(function: tree.Function, profile: CompilerProfile) -> Costs:
    """Cost `function` and its callees, or take the costs from the cache on disk; once per process."""

    def made() -> Costs:
        from bfsim.kernel.costing import costed  # most starts find all costs

        return costed(function, profile)

    return kept_costs(keys.key(function, profile, "costs"), made)


def kept_costs(key: str, made: Callable[[], Costs]) -> Costs:
    """Return the costs that the cache on disk keeps under a key, or those that are made now, which it keeps."""
    kept = store.load(key)
    if kept is not None:
        return _costs(json.loads(kept))
    costs = made()
    store.save(key, json.dumps(_rows(costs), separators=(",", ":")).encode())
    return costs


def _rows(costs: Costs) -> dict[str, Any]:
    """Return costs for JSON: dataclasses as lists of their fields, which `asdict` would take as long for as the rest takes."""
    counters = [
        _fields(each) | {"charges": [[*_fields(one).values()] for one in each.charges]}
        for each in costs.counters
    ]
    return {
        "counters": [[*each.values()] for each in counters],
        "calls": costs.calls,
        "inlined": costs.inlined,
    }


def _fields(each: Counter | Charge) -> dict[str, Any]:
    return {name: getattr(each, name) for name in each.__dataclass_fields__}


def _costs(kept: dict[str, Any]) -> Costs:
    """Build costs from their JSON."""
    calls = {
        routine: tuple(RoutineCall(callee, tuple(map(tuple, arrays))) for callee, arrays in each)
        for routine, each in kept["calls"].items()
    }
    inlined = {int(site): tuple(routines) for site, routines in kept["inlined"].items()}
    return Costs(tuple(map(_counter, kept["counters"])), calls, inlined)


def _counter(row: list[Any]) -> Counter:
    """Build a counter from its JSON."""
    found = dict(zip(Counter.__dataclass_fields__, row, strict=True))
    found["charges"] = tuple(Charge(Op(op), SourceLine(*line), *more) for op, line, *more in found["charges"])
    found["accesses"] = tuple(Access(*each)._replace(line=SourceLine(*each[4])) for each in found["accesses"])
    found["enters"] = tuple(
        Entrance(symbol, SourceLine(*caller), note) for symbol, caller, note in found["enters"]
    )
    return Counter(**found)
