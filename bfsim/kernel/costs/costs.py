"""What a kernel costs, as the cache on disk keeps it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from bfsim.files import store
from bfsim.kernel.costs.charges import Access, Charge
from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.costs.routine_calls import RoutineCall
from bfsim.kernel.ir.text import Entrance, SourceLine
from bfsim.kernel.operations import Op

OPS = {each.value: each for each in Op}


@dataclass(frozen=True, slots=True)
class Costs:
    """What a kernel costs: the `counters` of its routines, callees included, and how they call each other.

    `calls`: the calls that each routine makes of others, in the order of its text. `inlined`: the routines through
    which an inlined call came, by its number (`SourceLine.site`), beginning with the one that it was inlined into.
    """

    counters: tuple[Counter, ...] = ()
    calls: Mapping[str, tuple[RoutineCall, ...]] = field(default_factory=dict)
    inlined: Mapping[int, tuple[str, ...]] = field(default_factory=dict)


def kept_costs(key: str, made: Callable[[], Costs]) -> Costs:
    """Return the costs that the cache on disk keeps under a key; make and keep them if there are none."""
    return _costs(store.kept(key, lambda: _rows(made())))


def _rows(costs: Costs) -> dict[str, Any]:
    """Return costs for JSON: each line, charge and access once, and elsewhere by its number."""
    lines, charges, accesses = _Numbered(), _Numbered(), _Numbered()

    def row(each: Counter) -> list[Any]:
        numbered = {
            "charges": [charges[one.op, lines[one.line], *one[2:]] for one in each.charges],
            "accesses": [accesses[*one[:4], lines[one.line], *one[5:]] for one in each.accesses],
            "enters": [(one.symbol, lines[one.caller], one.location) for one in each.enters],
        }
        return [numbered.get(name, getattr(each, name)) for name in each.__dataclass_fields__]

    return {
        "counters": list(map(row, costs.counters)),
        "lines": list(lines),
        "charges": list(charges),
        "accesses": list(accesses),
        "calls": costs.calls,
        "inlined": costs.inlined,
    }


class _Numbered(dict[Any, int]):
    """Numbers of things, in the order in which they are first asked for."""

    def __missing__(self, key: Any) -> int:
        return self.setdefault(key, len(self))


def _costs(kept: dict[str, Any]) -> Costs:
    """Build costs from their JSON."""
    lines = [SourceLine(*each) for each in kept["lines"]]
    charges = [Charge(OPS[op], lines[line], *more) for op, line, *more in kept["charges"]]
    accesses = [
        Access(array, writes, label, number, lines[line], *more)
        for array, writes, label, number, line, *more in kept["accesses"]
    ]

    def counter(row: list[Any]) -> Counter:
        routine, label, value, equals, charged, accessed, nbytes, depth, enters = row
        return Counter(
            routine,
            label,
            value,
            equals,
            tuple([charges[each] for each in charged]),
            tuple([accesses[each] for each in accessed]),
            nbytes,
            depth,
            tuple([Entrance(symbol, lines[caller], note) for symbol, caller, note in enters]),
        )

    calls = {
        routine: tuple(RoutineCall(callee, tuple(map(tuple, arrays))) for callee, arrays in each)
        for routine, each in kept["calls"].items()
    }
    inlined = {int(site): tuple(routines) for site, routines in kept["inlined"].items()}
    return Costs(tuple(map(counter, kept["counters"])), calls, inlined)
