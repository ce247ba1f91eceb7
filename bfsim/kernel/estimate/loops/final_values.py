"""Final values: the value of a counter after its loop, computed there [final_value_replacement_loop in tree-scalar-evolution.cc of GCC 12].

`while i < n: ...; i += 1; o += 2` ends with `i == n`, and with `o` higher by twice the number of iterations. So the
loop need not step counters that only index elements. If a loop has other exits, it is only known that its counter has
reached a constant [vrp].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.estimate.loops.scalar_evolution import Affine
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.edges import put_between
from bfsim.kernel.ir.text import (
    INVERTED,
    SWAPPED,
    BasicBlock,
    Instruction,
    Routine,
    arms_of,
    is_number,
    predicate,
    renamed,
    with_values,
    written,
)

STEPS = {"lt": 1, "gt": -1}
"""The step of a counter by its relation to its bound while the loop goes on."""
MARK = ".final"


@dataclass(frozen=True, slots=True)
class _Stepped:
    """A counter of a loop: the phi, its start, and its step. `more`: by how much a value exceeds the phi."""

    phi: str
    start: str
    step: int
    more: int = 0


def with_final_values(routine: Routine) -> Routine:
    """Return `routine` with the known values of such counters in their place after each loop."""
    for header in [loop.header for loop in ControlFlow(routine).loops]:
        flow = ControlFlow(routine)
        loop = next(each for each in flow.loops if each.header == header)
        routine = _FinalValues(flow, loop).rewritten()
    return routine


class _FinalValues:
    """The values of one loop's counters when its last block ends it."""

    def __init__(self, flow: ControlFlow, loop: Loop) -> None:
        self.flow, self.loop = flow, loop
        self.is_only_exit = flow.exits(loop) == [loop.latch]
        self.quotient = list[Instruction]()
        """The rows that compute how often the loop iterates, less one, if that takes a shift."""
        self.iterations = None if flow.is_split(loop) else self._iterations()

    def rewritten(self) -> Routine:
        """The routine with final values in place of stepped ones."""
        routine = self.flow.routine
        if self.iterations is None:
            return routine
        if self.is_only_exit and not self._does_more():
            return routine  # GCC would leave the loop out
        (behind,) = set(self.flow.blocks[self.loop.latch].successors) - self.loop.blocks
        finals = {name: final for name in self._wanted(behind) if (final := self._final(name)) is not None}
        if not finals:
            return routine
        blocks = {each.label: each for each in routine.blocks}
        rows = [*self.quotient]
        names = {name: self._computed(name, final, rows) for name, final in sorted(finals.items())}
        has_phis = any(each.opcode == "phi" for each in blocks[behind].instructions)
        if not self.is_only_exit or (rows and (has_phis or len(self.flow.predecessors[behind]) > 1)):
            home = f"{self.loop.latch}{MARK}"
            put_between(blocks, self.loop.latch, behind, home)
            blocks[behind] = _arriving(blocks[behind], home, names)
        else:
            home = behind
        if self.is_only_exit:
            for label in blocks.keys() - self.loop.blocks:
                blocks[label] = _renamed(blocks[label], names)
        phis = [each for each in blocks[home].instructions if each.opcode == "phi"]
        rest = blocks[home].instructions[len(phis) :]
        blocks[home] = replace(blocks[home], instructions=(*phis, *rows, *rest))
        return replace(routine, blocks=tuple(blocks.values()))

    def _does_more(self) -> bool:
        """Whether the loop does anything besides stepping."""
        rows = (each for label in self.loop.blocks for each in self.flow.blocks[label].instructions)
        return any(each.opcode in ("load", "store", "call") for each in rows)

    def _wanted(self, behind: str) -> Iterator[str]:
        """Values of the loop that are used outside it, or where its last block leads."""
        outside = [block for label, block in self.flow.blocks.items() if label not in self.loop.blocks]
        if self.is_only_exit:
            used = {name for block in outside for each in block.instructions for name in each.operands}
        else:
            phis = (each for each in self.flow.blocks[behind].instructions if each.opcode == "phi")
            used = {arms_of(each)[self.loop.latch] for each in phis}
        yield from (name for name in used if not self.flow.is_invariant(name, self.loop))

    def _final(self, name: str) -> Affine | None:
        """The value of a stepped value after the loop: its start, plus the steps."""
        stepped = self._stepped(name)
        if stepped is None or self.iterations is None:
            return None
        first = _atom(stepped.start).plus(Affine(constant=stepped.more - stepped.step))
        final = first.plus(self.iterations, stepped.step)
        return final if self.is_only_exit or not final.terms else None

    def _iterations(self) -> Affine | None:
        """How often the loop iterates, if its last test compares a counter that steps by one."""
        end = self.flow.blocks[self.loop.latch]
        test = self.flow.instruction(end.terminator.operands[0]) if end.terminator.operands else None
        if test is None or test.opcode != "icmp" or end.successors[0] not in self.loop.blocks:
            return None
        bound, relation = test.operands[1], predicate(test)
        counter = self._stepped(test.operands[0])
        if counter is None or not self.flow.is_invariant(bound, self.loop):
            return None
        if abs(counter.step) != 1:
            return self._shifted(counter, test)
        left = _atom(bound).plus(_atom(counter.start), -1).plus(Affine(constant=-counter.more))
        iterations = Affine(constant=1).plus(left, counter.step)
        by_order = relation != "ne" and STEPS.get(relation[1:]) == counter.step
        return iterations if relation == "ne" or (by_order and self._is_guarded(iterations, test)) else None

    def _shifted(self, counter: _Stepped, test: Instruction) -> Affine | None:
        """How often the loop iterates if its counter steps by a power of two; if it took a division, GCC would count in the loop [expression_expensive_p]."""
        step, bound, at = abs(counter.step), test.operands[1], self.flow.instruction(counter.phi)
        sign = counter.step // step
        ends = counter.more == counter.step and STEPS.get(predicate(test)[1:]) == sign
        rest = (
            _atom(bound).plus(_atom(counter.start), -1)
            if sign > 0
            else _atom(counter.start).plus(_atom(bound), -1)
        )
        is_power = step.bit_count() == 1 and bool(rest.terms)
        if at is None or not (ends and is_power and self.is_only_exit and self._is_guarded(rest, test)):
            return None
        distance = self._computed(counter.phi, rest.plus(Affine(constant=-1)), self.quotient)
        bits = str(step.bit_length() - 1)
        name = _append(self.quotient, f"lshr i32 {distance}, {bits}", (distance, bits), counter.phi, at)
        return _atom(name).plus(Affine(constant=1))

    def _is_guarded(self, iterations: Affine, last: Instruction) -> bool:
        """Whether the loop is only entered for at least one iteration: its last test was made before, or is known to hold there."""
        if not iterations.terms:
            return iterations.constant >= 1
        for label in self.flow.dominators[self.loop.header] - self.loop.blocks:
            terminator, ways = self.flow.blocks[label].terminator, self.flow.blocks[label].successors
            named = terminator.opcode == "br" and terminator.operands
            test = self.flow.instruction(terminator.operands[0]) if named else None
            if test is None or test.opcode != "icmp" or len(set(ways)) != 2:
                continue
            for way, holds in zip(ways, (predicate(test), INVERTED[predicate(test)]), strict=True):
                before = [each for each in self.flow.predecessors[way] if each not in self.loop.blocks]
                if way in self.flow.dominators[self.loop.header] and before == [label]:
                    left, right = test.operands[:2]
                    if holds == "ne" and right == "0" and self._is_extended(iterations, left):
                        return True
                    least = _least(holds, left, right, predicate(last)[0])
                    if least is not None and not (rest := iterations.plus(least, -1)).terms:
                        return rest.constant >= 0
        return self._is_first(last)

    def _is_first(self, last: Instruction) -> bool:
        """Whether the source makes the last test of the loop at its top: LLVM leaves it out before a loop if it is sure to hold."""
        rows = (each for label in self.loop.blocks for each in self.flow.blocks[label].instructions)
        lines = [each.line.line for each in rows if each.line._replace(line=0) == last.line._replace(line=0)]
        return min(lines) == last.line.line < max(lines)

    def _is_extended(self, iterations: Affine, narrow: str) -> bool:
        """Whether the number of iterations is an extended narrow value, which is never negative."""
        if iterations.constant or [times for _, times in iterations.terms] != [1]:
            return False
        each = self.flow.instruction(iterations.terms[0][0])
        return each is not None and each.opcode == "zext" and each.operands[0] == narrow

    def _stepped(self, name: str) -> _Stepped | None:
        """A phi of the header that steps by a constant, or its sum with a constant that each iteration computes."""
        each, more = self.flow.instruction(name), 0
        if each is not None and each.opcode == "add" and is_number(each.operands[1]):
            name, more = each.operands[0], int(each.operands[1])
            each = self.flow.instruction(name)
        if each is None or each.opcode != "phi" or not each.text.startswith("phi i32 "):
            return None
        arms, before = arms_of(each), self.flow.entering(self.loop)
        if self.flow.defined[name][0] != self.loop.header or set(arms) != {before, self.loop.latch}:
            return None
        new = self.flow.instruction(arms[self.loop.latch])
        if new is None or new.opcode != "add" or new.operands[0] != name or not is_number(new.operands[1]):
            return None
        return _Stepped(name, arms[before], int(new.operands[1]), more)

    def _computed(self, name: str, final: Affine, rows: list[Instruction]) -> str:
        """The value of a sum; the instructions that compute it are appended to `rows`."""
        at = self.flow.defined[name][1]
        total = ""
        for value, times in sorted(final.terms, key=lambda term: -term[1]):
            part = value
            if abs(times) != 1:
                part = _append(rows, f"mul i32 {value}, {abs(times)}", (value, str(abs(times))), name, at)
            if total or times < 0:
                operation = "add" if times > 0 else "sub"
                part = _append(rows, f"{operation} i32 {total or 0}, {part}", (total or "0", part), name, at)
            total = part
        constant = str(final.constant)
        if not total or not final.constant:
            return total or constant
        return _append(rows, f"add i32 {total}, {constant}", (total, constant), name, at)


def _atom(value: str) -> Affine:
    return Affine(constant=int(value)) if is_number(value) else Affine(((value, 1),))


def _least(relation: str, left: str, right: str, sign: str) -> Affine | None:
    """The distance between the values of a relation, which is at least one if the relation holds."""
    if relation[1:] in ("gt", "ge"):
        relation, left, right = SWAPPED[relation], right, left
    if relation[0] != sign or relation[1:] not in ("lt", "le"):
        return None
    return _atom(right).plus(_atom(left), -1).plus(Affine(constant=int(relation[1:] == "le")))


def _append(rows: list[Instruction], text: str, operands: tuple[str, ...], name: str, at: Instruction) -> str:
    result = f"{name}{MARK}{len(rows)}"
    rows.append(written(result, text, operands, at))
    return result


def _renamed(block: BasicBlock, names: dict[str, str]) -> BasicBlock:
    return replace(block, instructions=tuple(renamed(each, names) for each in block.instructions))


def _arriving(block: BasicBlock, home: str, names: dict[str, str]) -> BasicBlock:
    """A block whose phis get final values from the block `home`."""
    rows = []
    for each in block.instructions:
        if each.opcode == "phi":
            arms = arms_of(each)
            rows.append(with_values(each, {**arms, home: names.get(arms[home], arms[home])}))
        else:
            rows.append(each)
    return replace(block, instructions=tuple(rows))
