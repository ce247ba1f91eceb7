"""The order of blocks: traces along likely edges, then connected [bb-reorder.cc of GCC 12: the software trace cache].

The algorithm is Torrellas, Xia and Daigle's, "Optimizing the instruction cache performance of the operating system" (IEEE
Transactions on Computers 47, 1998), as GCC has it at -O2: traces are grown in rounds, the likely and frequent edges first.
A small block that several traces lead to is copied behind one that would have to jump there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

ROUNDS = ((0.4, 0.5), (0.2, 0.2), (0.1, 0.05), (0.0, 0.0))
"""Least probability of an edge, and least count of it for one of the entry, in each round."""
TOLERANCE = 0.1  # edges that are less likely or frequent by this much are as good
ITERATIONS_TO_ROTATE = 0.8  # of a header's count, those that come from the back edge
COPIED_COUNT = 0.1  # an edge is worth a copy from this count on, for one of the entry
JUMP_BYTES = 2  # a block of no more than this is copied rather than jumped to
COPY_BYTES = 8 * JUMP_BYTES  # [param_max_grow_copy_bb_insns] where that saves a frequent jump
SCALE = 10_000  # of the most frequent block's count [BB_FREQ_MAX]


@dataclass(frozen=True, slots=True)
class Edge:
    """An edge from a block to another: how likely it is when the block ends, how often it is taken, and whether it may need no jump."""

    source: str
    target: str
    probability: float
    count: float
    may_fall: bool = True


@dataclass(frozen=True)
class Graph:
    """Blocks, the entry first, with their counts and bytes of code.

    `following`: the side of a test that comes next in the source. `back`: the back edges of loops. `ends`: blocks that
    return.
    """

    names: Sequence[str]
    edges: Mapping[str, tuple[Edge, ...]]
    count: Mapping[str, float]
    nbytes: Mapping[str, int]
    following: Mapping[str, str]
    back: frozenset[tuple[str, str]]
    ends: frozenset[str]

    @cached_property
    def into(self) -> Mapping[str, Sequence[Edge]]:
        """Edges to each block."""
        found: dict[str, list[Edge]] = {name: [] for name in self.names}
        for name in self.names:
            for edge in self.edges[name]:
                found[edge.target].append(edge)
        return found


@dataclass(slots=True)
class Layout:
    """The order found. `copied`: edges that lead to a copy of their target right after them."""

    order: list[str] = field(default_factory=list)
    copied: set[tuple[str, str]] = field(default_factory=set)


def laid_out(graph: Graph) -> Layout:
    """Order the blocks of a routine."""
    return _Connecting(graph, _Tracing(graph).traces).layout


def _is_copied(graph: Graph, name: str, most: int) -> bool:
    return len(graph.into[name]) > 1 and 0 < graph.nbytes[name] <= most


class _Tracing:
    """Grows the traces; a block is in one of them."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.traces: list[list[str]] = []
        self.trace_of: dict[str, int] = {}
        self.waiting: list[str] = [graph.names[0]]
        self.entry_count = graph.count[graph.names[0]]
        self.most = max(graph.count.values())
        self.ends: set[str] = set()
        for number, (probability, share) in enumerate(ROUNDS):
            later = self._round(probability, share * self.entry_count, is_last=number == len(ROUNDS) - 1)
            self.waiting = later
        for name in graph.names:  # what nothing leads to
            if name not in self.trace_of:
                self.traces.append([name])

    def _round(self, probability: float, count: float, *, is_last: bool) -> list[str]:
        later: list[str] = []
        while self.waiting:
            name = max(self.waiting, key=lambda each: (self._priority(each), self.waiting.index(each)))
            self.waiting.remove(name)
            if self.graph.count[name] < count and not is_last:
                later.append(name)
            else:
                self._grow(name, probability, count, later, is_last=is_last)
        return later

    def _priority(self, name: str) -> float:
        """Blocks after the end of a trace, and headers of loops, come first; among these, and among others, the most frequent."""
        frequency = SCALE * self.graph.count[name] / self.most
        edges = [
            each.count
            for each in self.graph.into[name]
            if each.source in self.ends or (each.source, name) in self.graph.back
        ]
        urgent = SCALE * max(edges, default=0) / self.most
        return 100 * SCALE + 100 * int(urgent) + int(frequency) if int(urgent) else int(frequency)

    def _grow(self, name: str, probability: float, count: float, later: list[str], *, is_last: bool) -> None:
        trace = [name]
        number = len(self.traces)
        self.traces.append(trace)
        self.trace_of[name] = number
        while (best := self._best(trace[-1], number, probability, count)) is not None:
            self._put_off(trace[-1], best, probability, count, later, is_last=is_last)
            if self.trace_of.get(best.target) == number:
                self._close(trace, best)
                break
            best = self._body_of_if(trace[-1], best)
            # what is visited now waits no longer
            for heap in (self.waiting, later):
                if best.target in heap:
                    heap.remove(best.target)
            trace.append(best.target)
            self.trace_of[best.target] = number
        else:
            self._put_off(trace[-1], None, probability, count, later, is_last=is_last)
        self.ends.add(trace[-1])

    def _best(self, name: str, number: int, probability: float, count: float) -> Edge | None:
        best: Edge | None = None
        for edge in self.graph.edges[name]:
            if self.trace_of.get(edge.target, number) != number:
                continue
            if edge.probability < probability or edge.count < count or not edge.may_fall:
                continue
            if best is None or self._is_better(edge, best):
                best = edge
        if best is not None and _is_copied(self.graph, best.target, JUMP_BYTES):
            return None
        return best

    def _is_better(self, edge: Edge, best: Edge) -> bool:
        """A likelier one; of two equally likely the one to the rarer block, to which fewer others lead; then the next in the source."""
        if abs(edge.probability - best.probability) > TOLERANCE * best.probability:
            return edge.probability > best.probability
        count, other = self.graph.count[edge.target], self.graph.count[best.target]
        if abs(count - other) > TOLERANCE * other:
            return count < other
        return self.graph.following.get(edge.source) == edge.target

    def _put_off(
        self,
        name: str,
        best: Edge | None,
        probability: float,
        count: float,
        later: list[str],
        *,
        is_last: bool,
    ) -> None:
        for edge in self.graph.edges[name]:
            known = edge.target in self.trace_of or edge.target in self.waiting or edge.target in later
            if known or (best is not None and edge.target == best.target):
                continue
            unlikely = edge.probability < probability or edge.count < count or not edge.may_fall
            rare = self.graph.count[edge.target] < count and not is_last
            (later if unlikely and rare else self.waiting).append(edge.target)

    def _close(self, trace: list[str], back: Edge) -> None:
        """A loop that jumps back ends with its most frequent exit: the test moves to the bottom."""
        frequent = back.count > ITERATIONS_TO_ROTATE * self.graph.count[back.target]
        if back.target == back.source or not frequent or back.target == self.graph.names[0]:
            return
        number = self.trace_of[back.target]
        start = trace.index(back.target)
        exits = [
            edge
            for name in trace[start:]
            for edge in self.graph.edges[name]
            if self.trace_of.get(edge.target) != number and edge.may_fall
        ]
        starts = {each[0] for each in self.traces}
        preferred = [each for each in exits if each.target not in self.trace_of or each.target in starts]
        best = max(preferred or exits, key=lambda edge: edge.count, default=None)
        if best is not None:
            cut = trace.index(best.source) + 1
            trace[start:] = trace[cut:] + trace[start:cut]

    def _body_of_if(self, name: str, best: Edge) -> Edge:
        """The body of an `if` stays in line unless it is rare: half as likely as what skips it."""
        for edge in self.graph.edges[name]:
            behind = self.graph.edges[edge.target]
            if (
                edge.target not in (best.target, *self.trace_of)
                and len(self.graph.into[edge.target]) == 1
                and len(behind) == 1
                and behind[0].target == best.target
                and 2 * self.graph.count[edge.target] >= best.count
            ):
                return edge
        return best


class _Connecting:
    """Puts the traces one after the other."""

    def __init__(self, graph: Graph, traces: list[list[str]]) -> None:
        self.graph, self.traces = graph, traces
        self.left = set(range(len(traces)))
        self.start = {each[0]: number for number, each in enumerate(traces)}
        self.end = {each[-1]: number for number, each in enumerate(traces)}
        self.layout = Layout()
        for number in range(len(traces)):
            if number in self.left:
                self._chain(number)

    def _chain(self, number: int) -> None:
        """A trace, those that lead to it and those that it leads to."""
        self.left.discard(number)
        chain = [number]
        while chain[0] > 0 and (before := self._before(chain[0])) is not None:
            self.left.discard(before)
            chain.insert(0, before)
        last = number
        while (after := self._after(last)) is not None:
            self.left.discard(after)
            chain.append(after)
            last = after
        for each in chain:
            self.layout.order += self.traces[each]

    def _before(self, number: int) -> int | None:
        edges = [
            each
            for each in self.graph.into[self.traces[number][0]]
            if self.end.get(each.source, -1) in self.left and each.may_fall
        ]
        best = max(
            edges,
            key=lambda edge: (edge.probability, len(self.traces[self.end[edge.source]])),
            default=None,
        )
        return self.end[best.source] if best else None

    def _after(self, number: int) -> int | None:
        edges = tuple(each for each in self.graph.edges[self.traces[number][-1]] if each.may_fall)
        free = [each for each in edges if self.start.get(each.target, -1) in self.left]
        best = max(
            free,
            key=lambda edge: (edge.probability, len(self.traces[self.start[edge.target]])),
            default=None,
        )
        return self.start[best.target] if best else self._by_copy(edges)

    def _by_copy(self, edges: tuple[Edge, ...]) -> int | None:
        """The block that a trace leads to stands elsewhere, but is small: a copy goes in between, and what may follow that."""
        best, following = None, None
        entry_count = self.graph.count[self.graph.names[0]]
        for edge in edges:
            if edge.target == edge.source or (best is not None and edge.probability <= best.probability):
                continue  # a copy after itself would need the same jump
            number = self.start.get(edge.target, -1)
            if number >= 0 and len(self.traces[number]) == 1:
                best, following = edge, None
                continue
            onwards = [
                each
                for each in self.graph.edges[edge.target]
                if self.start.get(each.target, -1) in self.left and each.count >= COPIED_COUNT * entry_count
            ]
            if onwards or edge.target in self.graph.ends:
                best = edge
                following = max(onwards, key=lambda each: each.probability) if onwards else None
        if best is None:
            return None
        frequent = best.count >= COPIED_COUNT * entry_count
        if not _is_copied(self.graph, best.target, COPY_BYTES if frequent else JUMP_BYTES):
            return None
        self.layout.copied.add((best.source, best.target))
        return self.start[following.target] if following else None
