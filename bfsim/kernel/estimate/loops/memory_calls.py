"""Loops that GCC replaces by calls of memset and memmove [loop distribution: tree-loop-distribution.cc of GCC 12, part of -O2].

A loop fills if its stores all write the same byte, side by side [classify_builtin_st]; it moves if its stores write
what is loaded a fixed distance away in the same array, and nothing is loaded that was stored before
[classify_builtin_ldst]. Each store becomes a separate call. If only a few bytes are filled, stores of bytes replace the
call.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from bfsim.kernel.estimate.loops.scalar_evolution import Increment, ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.ir.widths import BYTE
from bfsim.kernel.profile import Library, MemoryRoutine

ALLOWED = {"phi", "add", "and", "getelementptr", "trunc", "load", "store", "icmp", "br"}
MOST_CLEARED = 14  # most bytes of zeros that are stored one by one [CLEAR_RATIO in GCC's defaults.h]
MOST_SET = 4  # of another byte [MOVE_RATIO in GCC's bfin.h, by SET_RATIO in defaults.h]
WORD_BYTES = 4


@dataclass(frozen=True, slots=True)
class MemoryCall:
    """The call that replaces a store of a loop."""

    loop: Loop
    number: int
    """Which of the loop's stores, from 0."""
    store: Instruction
    load: Instruction | None
    """None if the store fills."""
    routine: MemoryRoutine
    iterations: int | None
    """None if only the loop knows."""
    nest: Loop | None = None
    """The loop around, if one call fills what all its iterations fill side by side."""

    @property
    def nbytes(self) -> int:
        """What an iteration stores."""
        return self.store.bits // BYTE

    @property
    def total(self) -> int | None:
        """What all iterations store, in bytes; None if only the loop knows."""
        return None if self.iterations is None else self.iterations * self.nbytes

    @property
    def place(self) -> Loop:
        """The loop that the call stands before."""
        return self.nest or self.loop

    @property
    def is_inline(self) -> bool:
        """Whether stores of bytes replace the call."""
        most = MOST_CLEARED if self.store.operands[0] == "0" else MOST_SET
        return self.load is None and self.nest is None and self.total is not None and self.total <= most


def memory_calls(
    flow: ControlFlow, evolution: ScalarEvolution, library: Library
) -> dict[str, list[MemoryCall]]:
    """Return the calls that replace loops, by the only block of each loop."""
    finder = _Finder(flow, evolution, library)
    found = {loop.header: finder.of(loop) for loop in flow.loops if library.fill and len(loop.blocks) == 1}
    return {header: calls for header, calls in found.items() if calls}


class _Finder:
    def __init__(self, flow: ControlFlow, evolution: ScalarEvolution, library: Library) -> None:
        self._flow, self._evolution, self._library = flow, evolution, library

    def of(self, loop: Loop) -> list[MemoryCall]:
        rows = self._flow.blocks[loop.header].instructions
        if not self._evolution.is_counted(loop) or not all(self._is_allowed(each, loop) for each in rows):
            return []
        loads = {each.result: each for each in rows if each.opcode == "load"}
        stores = [each for each in rows if each.opcode == "store"]
        calls: list[MemoryCall] = []
        for number, store in enumerate(stores):
            load = loads.pop(store.operands[0], None)
            routine = self._routine(store, load, loop)
            if routine is None:
                return []
            calls.append(MemoryCall(loop, number, store, load, routine, self._evolution.iterations(loop)))
        if len(calls) == 1 and self._is_perfect(calls[0]):
            return [replace(calls[0], nest=self._flow.around(loop))]
        return [] if loads else calls

    def _is_perfect(self, call: MemoryCall) -> bool:
        """Whether the loop around only fills, each iteration right after the previous one [compute_access_range, of perfect nests]."""
        around = self._flow.around(call.loop)
        if (
            around is None
            or call.load is not None
            or call.total is None
            or not self._evolution.is_counted(around)
        ):
            return False
        rows = (each for label in around.blocks for each in self._flow.blocks[label].instructions)
        alone = all(each is call.store or each.opcode not in ("load", "store", "call") for each in rows)
        side_by_side = self._step_around(call, around) in (call.total, -call.total)
        return alone and side_by_side and len(self._flow.exits(around)) == 1

    def _step_around(self, call: MemoryCall, around: Loop) -> int | None:
        """Return how many bytes further each iteration of the loop around begins, if always the same."""
        total = 0
        for name, times in self._evolution.affine(call.store.operands[1]).terms:
            if self._flow.defined.get(name, ("",))[0] == call.loop.header:
                fixed = is_number(self._evolution.first(name, call.loop) or "")
                step = Increment() if fixed else None
            else:
                step = self._evolution.increment(name, around)
            if step is None or step.symbolic:
                return None
            total += times * step.constant
        return total

    def _is_allowed(self, each: Instruction, loop: Loop) -> bool:
        """Whether a statement may be in the loop: invariant values are computed before it."""
        is_before = bool(each.result) and self._evolution.code_motion.is_invariant(each.result or "", loop)
        return each.opcode in ALLOWED or is_before

    def _routine(self, store: Instruction, load: Instruction | None, loop: Loop) -> MemoryRoutine | None:
        """Return the library routine that does what a store does in all iterations, if there is one."""
        step = self._evolution.increment(store.operands[1], loop)
        if step is None or step.symbolic or abs(step.constant) != store.bits // BYTE:
            return None
        if load is None:
            return self._library.fill if self._is_one_byte(store, loop) else None
        return self._moving(store, load, step, loop)

    def _is_one_byte(self, store: Instruction, loop: Loop) -> bool:
        value = store.operands[0]
        one = store.bits == BYTE and self._evolution.code_motion.is_invariant(value, loop)
        return value in ("0", "-1") or one

    def _moving(
        self, store: Instruction, load: Instruction, step: Increment, loop: Loop
    ) -> MemoryRoutine | None:
        to, source = store.operands[1], load.operands[0]
        distance = self._evolution.affine(to).plus(self._evolution.affine(source), -1)
        if distance.terms or self._evolution.increment(source, loop) != step:
            return None
        iterations = self._evolution.iterations(loop)
        behind = distance.constant // step.constant  # iterations from a store to a load of the same element
        is_stored_before = behind > 0 and (iterations is None or behind < iterations)
        if behind == 0 or is_stored_before or len(self._flow.users[load.result or ""]) > 1:
            return None
        upwards = step.constant * behind > 0 and (iterations is None or abs(behind) < iterations)
        by_words = distance.constant % WORD_BYTES == 0 and not upwards
        return self._library.move_words if by_words else self._library.move_bytes
