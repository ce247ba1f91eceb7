"""The array that an access is to: pointers are followed from the arguments of a function through registers and the stack.

What is known of a value is the arrays that it may point into, and the place if it points into the stack frame. Where
paths join, it may be either; a callee is looked at once, with what all of its calls pass.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from heapq import heappop, heappush
from itertools import groupby

from bfsim.blackfin.control_flow.blocks import CALLS, Code, does
from bfsim.blackfin.control_flow.convention import KEPT, REGISTERS
from bfsim.blackfin.control_flow.flow import Way, edges
from bfsim.blackfin.instructions.origins import Made, Origin, made_by
from bfsim.blackfin.instructions.registers import WORD_BYTES


@dataclass(frozen=True, slots=True)
class Pointer:
    """What is known of a value: `arrays` that it may point into; `less`: arrays of which a pointer was subtracted from it.

    `frame`: how far it is from the SP of the function's entry, if known.
    """

    arrays: frozenset[str] = frozenset()
    less: frozenset[str] = frozenset()
    frame: int | None = None

    def joined(self, other: Pointer) -> Pointer:
        """Return what is known of a value that is one or the other."""
        if self is other:
            return self
        frame = self.frame if self.frame == other.frame else None
        return Pointer(self.arrays | other.arrays, self.less | other.less, frame)


NUMBER = Pointer()
Accesses = tuple[tuple[bool, frozenset[str]], ...]
"""For each access of an instruction, whether it writes, and the arrays that it may be to."""


@dataclass(slots=True)
class _State:
    """What is known of registers, and of words of the stack by their places."""

    registers: dict[str, Pointer] = field(default_factory=dict)
    words: dict[int, Pointer] = field(default_factory=dict)

    def joined(self, other: _State) -> _State:
        """Return what is known if either holds; itself if the other says nothing new."""
        registers, words = _joined(self.registers, other.registers), self._words_joined(other)
        if registers is self.registers and words is self.words:
            return self
        return _State(registers, words)

    def _words_joined(self, other: _State) -> dict[int, Pointer]:
        """Return the words of the stack that both know."""
        if self.words == other.words:
            return self.words
        both = self.words.keys() & other.words.keys()
        found = {each: self.words[each].joined(other.words[each]) for each in both}
        return self.words if found == self.words else found

    def behind_call(self) -> _State:
        """Return what is known after a call."""
        return _State({name: each for name, each in self.registers.items() if name in KEPT}, self.words)

    def in_call(self) -> _State:
        """Return what a callee knows: places in the stack are counted from its own SP."""
        top = self.registers.get("SP", NUMBER).frame
        if top is None:
            registers = {name: replace(each, frame=None) for name, each in self.registers.items()}
            return _State({**registers, "SP": Pointer(frame=0)})

        def moved(each: Pointer) -> Pointer:
            return each if each.frame is None else replace(each, frame=each.frame - top)

        return _State(
            {name: moved(each) for name, each in self.registers.items()},
            {place - top: moved(each) for place, each in self.words.items() if place >= top},
        )

    def execute(self, made: Made) -> Accesses:
        """Apply what an instruction has `made`; return its accesses."""
        known = dict(self.registers) if made.accesses else self.registers  # with what is loaded
        found: list[tuple[bool, frozenset[str]]] = []
        stores: list[tuple[Pointer, int, Pointer]] = []
        for each in made.accesses:
            address = _of(each.address, known)
            found.append((each.stored is not None, address.arrays))
            if each.stored is None:
                loads = sum(name.startswith("load ") for name in known)
                word = self.words.get(address.frame, NUMBER) if address.frame is not None else NUMBER
                known[f"load {loads}"] = word if each.nbytes == WORD_BYTES else NUMBER
            else:
                stores.append((address, each.nbytes, _of(each.stored, known)))
        for address, nbytes, value in stores:
            self._store(address, nbytes, value)
        self.registers.update({name: _of(each, known) for name, each in made.writes.items()})
        return tuple(found)

    def _store(self, address: Pointer, nbytes: int, value: Pointer) -> None:
        if address.frame is None:
            return
        for place in range(address.frame - WORD_BYTES + 1, address.frame + nbytes):
            self.words.pop(place, None)
        if nbytes == WORD_BYTES:
            self.words[address.frame] = value


def _joined(one: dict[str, Pointer], two: dict[str, Pointer]) -> dict[str, Pointer]:
    """Return what is known of registers, where those not named are numbers; the first if the second says nothing new."""
    found: dict[str, Pointer] = {}
    for name in one.keys() | two.keys():
        here, there = one.get(name, NUMBER), two.get(name, NUMBER)
        if here is not there and (joined := here.joined(there)) != here:
            found[name] = joined
    return {**one, **found} if found else one


def _of(origin: Origin, known: Mapping[str, Pointer]) -> Pointer:
    added, subtracted = ([known[each] for each in part if each in known] for part in (origin.of, origin.less))
    if not subtracted and all(each is NUMBER for each in added):
        return NUMBER
    if not subtracted and not origin.offset and [origin.base] == [*origin.of]:
        return added[0]
    plus = _union((each.arrays for each in added), (each.less for each in subtracted))
    minus = _union((each.less for each in added), (each.arrays for each in subtracted))
    base = known.get(origin.base, NUMBER).frame if origin.base else None
    return Pointer(plus - minus, minus - plus, None if base is None else base + origin.offset)


def _union(*parts: Iterable[frozenset[str]]) -> frozenset[str]:
    return frozenset(name for part in parts for each in part for name in each)


def arrays_accessed(code: Code, entry: int, arguments: Sequence[str]) -> dict[int, Accesses]:
    """Return the accesses of each instruction that has some, by its address.

    `arguments`: names of the arrays that the function at `entry` is called with, in the order of its words; "" for numbers.
    """
    places = [Pointer(frozenset({name} - {""})) for name in arguments]
    registers = dict(zip(REGISTERS, places, strict=False))
    words = {WORD_BYTES * number: each for number, each in enumerate(places) if number >= len(REGISTERS)}
    begins = {entry: _State({**registers, "SP": Pointer(frame=0)}, words)}
    ways = {source: list(each) for source, each in groupby(edges(code), lambda edge: edge.source)}
    made = cache(lambda start: [(each.address, made_by(each)) for each in code.blocks[start].instructions])
    waiting = [entry]  # a heap: what is earlier in the code is most often earlier in time, too
    found: dict[int, Accesses] = {}
    while waiting:
        start = heappop(waiting)
        state = _State(dict(begins[start].registers), dict(begins[start].words))
        block = code.blocks[start]
        for address, each in made(start):
            if reached := state.execute(each):
                found[address] = reached
        behind = [
            (each.target, state if each.way is not Way.RETURNS else state.behind_call())
            for each in ways.get(start, ())
        ]
        last = block.instructions[-1] if block.instructions else None
        if last and does(last) in CALLS:
            target = last.operations[0].operands.get("t")
            called = sorted(code.callees) if target is None else [int(target)]
            behind += [(each, state.in_call()) for each in called]
        for target, new in behind:
            before = begins.get(target)
            joined = new if before is None else before.joined(new)
            if joined is not before:
                begins[target] = joined
                if target not in waiting:
                    heappush(waiting, target)
    return found
