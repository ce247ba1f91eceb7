"""The accesses to the stack frame of code that is called as one function, and the bytes that they go to.

They are known if the stack pointer has moved equally far on every path to an instruction, and if no other address in
the frame is computed or stored. Then registers of the host can hold what a compiler keeps on the stack.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NoReturn

from bfsim.blackfin.control_flow.blocks import CALLS, Code, does
from bfsim.blackfin.control_flow.convention import KEPT, RESULT
from bfsim.blackfin.control_flow.flow import Edge, Way, edges
from bfsim.blackfin.instructions.decode import Instruction
from bfsim.blackfin.instructions.origins import Origin, made_by

Places = Mapping[int, tuple[int | None, ...]]
"""For each instruction with accesses, by address, how far each is from the entry's stack pointer; None outside the frame."""
_State = dict[str, int | None]
"""How far registers that point into the frame are from there; None if they may point into it."""
_Numbers = dict[str, int]
"""Registers that the block has set to a number: a frame that is too large for an offset is taken and given back with one."""
SAVING = frozenset({"link", "push", "push_multiple"})
"""Instructions that save registers for a caller: an address that is saved is not used meanwhile."""


class _UnknownError(Exception):
    """An address in the frame is not known."""


def frame_places(code: Code, entry: int) -> Places:
    """Return the accesses of a function's code, callees included; none if it is not known which are to the frame."""
    try:
        return _Frames(code).followed(entry)
    except _UnknownError:
        return {}


class _Frames:
    """Follows the pointers to the frame through code."""

    def __init__(self, code: Code) -> None:
        self._code = code
        self._ways: dict[int, list[Edge]] = {}
        for each in edges(code):
            self._ways.setdefault(each.source, []).append(each)
        self._begins: dict[int, _State] = {}
        self._waiting: list[int] = []
        self._found: dict[int, tuple[int | None, ...]] = {}

    def followed(self, entry: int) -> Places:
        """Return all accesses."""
        self._come(entry, {"SP": 0})
        while self._waiting:
            start = self._waiting.pop()
            state = dict(self._begins[start])
            block, numbers = self._code.blocks[start], _Numbers()
            for each in block.instructions:
                self._execute(each, state, numbers)
            if block.returns and RESULT in state:
                _give_up()
            for way in self._ways.get(start, ()):
                self._come(way.target, _behind_call(state) if way.way is Way.RETURNS else state)
            if block.instructions and does(block.instructions[-1]) in CALLS:
                if not block.calls:
                    _give_up()
                self._come(block.calls[0], state)
        return self._found

    def _come(self, start: int, state: _State) -> None:
        """Come to a block: a register that does not point to the same place on every path to it only may point there."""
        before = self._begins.get(start)
        if before is None:
            self._begins[start] = dict(state)
            self._waiting.append(start)
        elif before != state:
            names = before.keys() | state.keys()
            both = {name: each if (each := before.get(name)) == state.get(name) else None for name in names}
            if both != before:
                self._begins[start] = both
                self._waiting.append(start)

    def _execute(self, instruction: Instruction, state: _State, numbers: _Numbers) -> None:
        made = made_by(instruction)
        places: list[int | None] = []
        for each in made.accesses:
            places.append(_place(each.address, state, numbers))
            if each.stored and not (does(instruction) in SAVING and each.stored.base in KEPT):
                _refuse(each.stored, state)
        if places:
            self._found[instruction.address] = tuple(places)
        written = {
            name: (_place(each, state, numbers), _sum(each, numbers)) for name, each in made.writes.items()
        }
        for name, (place, number) in written.items():
            for known, new in ((state, place), (numbers, number)):
                known.pop(name, None)
                if new is not None:
                    known[name] = new


def _behind_call(state: _State) -> _State:
    """Return what is known after a call: a register that need not be kept may still hold its value (GCC's -fipa-ra)."""
    return {name: place if name in KEPT else None for name, place in state.items()}


def _place(origin: Origin, state: _State, numbers: _Numbers) -> int | None:
    """Return the place in the frame that a value points to, if it does."""
    pointers = [each for each in origin.terms or () if each in state]
    if len(pointers) == 1 and (place := state[pointers[0]]) is not None:
        found = _sum(origin, {**numbers, pointers[0]: place})
        if found is not None:
            return found
    _refuse(origin, state)
    return None


def _sum(origin: Origin, numbers: _Numbers) -> int | None:
    """Return the number that a value is, if that is known."""
    if origin.terms is None or not all(each in numbers for each in origin.terms):
        return None
    return origin.offset + sum(numbers[each] for each in origin.terms)


def _refuse(origin: Origin, state: _State) -> None:
    """Give up if a value may be computed from a pointer into the frame."""
    if not state.keys().isdisjoint((*origin.of, *origin.less)):
        _give_up()


def _give_up() -> NoReturn:
    raise _UnknownError
