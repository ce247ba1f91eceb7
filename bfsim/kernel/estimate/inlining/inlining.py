"""Which calls a compiler replaces by the called code, as GCC 12 decides at -O2 [ipa-inline.cc, params.opt].

A call is inlined early if the code hardly grows by it; later, best gain first, if it grows by less than 15 statements,
or by less than 30 and takes much less time, or by less than 70 and inlining all calls of a static kernel saves code;
and finally if inlining all calls of a static kernel saves code, as for a single call. A callee that the compiler does
not see is never inlined (`Inlines`). A kernel cannot call itself, so inlining always ends.

Not modelled: cloning and splitting of functions, limits of size that only functions of thousands of statements reach.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cache

from bfsim.kernel.emitting.values import InlinedCall
from bfsim.kernel.estimate.inlining.gimple_size import RETURN_TIME, CallSite, Estimate, estimate
from bfsim.kernel.function_keys import compiled_with
from bfsim.kernel.language.function import Function
from bfsim.kernel.profile import CompilerProfile, Inlines

EARLY_STATEMENTS = 6  # [params.opt] early-inlining-insns
SMALL_STATEMENTS = 15  # [params.opt] max-inline-insns-auto
FAST_STATEMENTS = 30  # [params.opt] the same times inline-heuristics-hint-percent, if much time is gained
SINGLE_STATEMENTS = 70  # [params.opt] max-inline-insns-single
LEAST_SPEEDUP = 0.30  # [params.opt] inline-min-speedup
KEPT_STATEMENTS = 3  # of a function that is not inlined: uninlined-function-insns [params.opt] and the return


class Why(StrEnum):
    """Why a call is inlined, or is not."""

    SHRINKS = "code shrinks by it"
    SMALL = "small"
    FAST = "much faster"
    ONCE = "all calls of it together save code"
    UNSEEN = "in another file"
    LARGE = "too large"


@dataclass(frozen=True, slots=True, order=True)
class Decision:
    """What happens to the calls of `callee` in one line of `caller`; `growth` in statements."""

    caller: str
    callee: str
    line: int
    inlined: bool
    why: Why
    growth: int


@dataclass(frozen=True, slots=True, eq=False)
class _Edge:
    """A call in code as it stands now; `source`: the routine that has it in the source."""

    source: str
    site: CallSite

    @property
    def callee(self) -> str:
        return self.site.callee


@dataclass(slots=True)
class _Node:
    """A routine as it stands now, with what has been inlined into it; `gone`: what it is larger by if it is not inlined."""

    size: int
    time: float
    gone_size: int
    gone_time: float
    edges: list[_Edge]
    is_static: bool


@cache
def decisions(function: Function, profile: CompilerProfile) -> tuple[Decision, ...]:
    """Return what happens to the calls in `function` and in the kernels that it calls, callers in the order of their symbols."""
    if not profile.optimises or profile.inlines is Inlines.NOTHING or not function.callees():
        return ()
    within = {each.symbol for each in (*function.callees(), function)}
    kernels = {each.symbol: each for each in compiled_with(function, profile)}
    by_file = profile.inlines is Inlines.FILE
    estimates = {symbol: estimate(each) for symbol, each in kernels.items()}
    unseen = {
        (caller, site.callee)
        for caller, each in estimates.items()
        for site in each.calls
        if by_file and kernels[caller].file != kernels[site.callee].file
    }
    static = {
        symbol
        for symbol, each in kernels.items()
        if (each.is_static if by_file else each is not function)
        and all(symbol != callee for _, callee in unseen)
    }
    found = Inliner(estimates, frozenset(static), frozenset(unseen)).decide()
    return tuple(sorted(each for each in found if each.caller in within))


def inlined_calls(function: Function, profile: CompilerProfile) -> frozenset[InlinedCall]:
    """Return the calls in the program of `function` that are inlined."""
    return frozenset(
        (each.caller, each.callee, each.line) for each in decisions(function, profile) if each.inlined
    )


@dataclass
class Inliner:
    """Decides about all calls of a program. `estimates`: by symbol, callees before their callers."""

    estimates: Mapping[str, Estimate]
    static: frozenset[str]
    unseen: frozenset[tuple[str, str]]
    """(caller, callee) of the calls whose callee the compiler does not see."""
    nodes: dict[str, _Node] = field(init=False)
    first_growth: dict[str, int] = field(init=False)
    """By how much the program would grow if all calls of each callee were inlined, before any but tiny ones were."""
    found: dict[tuple[str, int, str], Decision] = field(init=False, default_factory=dict)

    def decide(self) -> tuple[Decision, ...]:
        """Return what happens to each call, in the order of the callers."""
        self.nodes = {name: self._node(name, each) for name, each in self.estimates.items()}
        for name in self.nodes:
            self._early(name)
        self.first_growth = {name: self._overall_growth(name) for name in self.nodes}
        while (best := self._best()) is not None:
            name, edge, why = best
            self._inline(name, edge, why)
        for name in [each for each in self.nodes if each in self.static]:
            if self._saves(name):
                for caller, edge in self._calls_of(name):
                    self._inline(caller, edge, Why.ONCE)
        for node in self.nodes.values():
            for edge in node.edges:
                self._leave(edge)
        return tuple(self.found.values())

    def _node(self, name: str, estimate: Estimate) -> _Node:
        edges = [_Edge(name, each) for each in estimate.calls]
        gone = estimate.gone_size + KEPT_STATEMENTS, estimate.gone_time + RETURN_TIME
        return _Node(estimate.size, estimate.time, *gone, edges, name in self.static)

    def _sees(self, edge: _Edge) -> bool:
        return (edge.source, edge.callee) not in self.unseen

    def _growth(self, edge: _Edge) -> int:
        return self.nodes[edge.callee].size - edge.site.spared_size - edge.site.size

    def _early(self, name: str) -> None:
        """Inline tiny callees, whatever their arguments; a callee that calls others must be tiny even with each of them inlined."""
        for edge in list(self.nodes[name].edges):
            growth, calls = self._growth(edge) + edge.site.spared_size, len(self.nodes[edge.callee].edges)
            if self._sees(edge) and (growth <= 0 or growth * (calls + 1) <= EARLY_STATEMENTS):
                self._inline(name, edge, Why.SHRINKS if growth <= 0 else Why.SMALL)

    def _best(self) -> tuple[str, _Edge, Why] | None:
        wanted = [
            (self._badness(name, edge), name, edge, why)
            for name, node in self.nodes.items()
            for edge in node.edges
            if self._sees(edge) and (why := self._wants(name, edge)) is not None
        ]
        return min(wanted, key=lambda each: each[0])[1:] if wanted else None

    def _wants(self, name: str, edge: _Edge) -> Why | None:
        """Why a call is inlined as that of a small function [want_inline_small_function_p]."""
        growth = self._growth(edge)
        if growth <= 0:
            return Why.SHRINKS
        if growth < SMALL_STATEMENTS:
            return Why.SMALL
        if growth < FAST_STATEMENTS and self._is_much_faster(name, edge):
            return Why.FAST
        if growth < SINGLE_STATEMENTS and self._saves(edge.callee):
            return Why.ONCE
        return None

    def _gain(self, edge: _Edge) -> float:
        """Time that is saved: that of the call, and of what disappears or is spared."""
        return (
            edge.site.time + self.nodes[edge.callee].gone_time + edge.site.spared_time
        ) * edge.site.frequency

    def _is_much_faster(self, name: str, edge: _Edge) -> bool:
        """Whether the caller, with the time in the callee, gets faster by 30 % [big_speedup_p]."""
        caller, callee = self.nodes[name], self.nodes[edge.callee]
        time = caller.time + (callee.time + callee.gone_time) * edge.site.frequency
        return self._gain(edge) > LEAST_SPEEDUP * time

    def _badness(self, name: str, edge: _Edge) -> float:
        """The lower this is, the earlier a call is inlined [edge_badness]."""
        growth = self._growth(edge)
        if growth <= 0:
            return -1e12 + growth
        overall = self.first_growth[edge.callee]
        weight = growth * (self.nodes[name].size + growth) * (overall * overall if overall > 0 else 1)
        badness = -self._gain(edge) / weight
        return badness * 4 if overall <= 0 else badness

    def _calls_of(self, callee: str) -> list[tuple[str, _Edge]]:
        return [
            (name, edge) for name, node in self.nodes.items() for edge in node.edges if edge.callee == callee
        ]

    def _overall_growth(self, callee: str) -> int:
        """By how much the program grows if all calls of `callee` are inlined."""
        node = self.nodes[callee]
        own = node.size + node.gone_size if callee in self.static else 0
        return sum(self._growth(edge) for _, edge in self._calls_of(callee)) - own

    def _saves(self, callee: str) -> bool:
        return callee in self.static and bool(self._calls_of(callee)) and self._overall_growth(callee) <= 0

    def _inline(self, name: str, edge: _Edge, why: Why) -> None:
        node, callee = self.nodes[name], self.nodes[edge.callee]
        self._note(edge, inlined=True, why=why)
        node.size += self._growth(edge)
        node.time += (callee.time - edge.site.spared_time - edge.site.time) * edge.site.frequency
        place = next(index for index, each in enumerate(node.edges) if each is edge)
        node.edges[place : place + 1] = [
            _Edge(each.source, replace(each.site, frequency=each.site.frequency * edge.site.frequency))
            for each in callee.edges
        ]
        if edge.callee in self.static and not self._calls_of(edge.callee):
            callee.edges = []  # nothing calls it any more: it is gone

    def _leave(self, edge: _Edge) -> None:
        self._note(edge, inlined=False, why=Why.LARGE if self._sees(edge) else Why.UNSEEN)

    def _note(self, edge: _Edge, *, inlined: bool, why: Why) -> None:
        key = (edge.source, edge.site.line, edge.callee)
        if key not in self.found or (inlined and not self.found[key].inlined):
            self.found[key] = Decision(
                edge.source, edge.callee, edge.site.line, inlined, why, self._growth(edge)
            )
