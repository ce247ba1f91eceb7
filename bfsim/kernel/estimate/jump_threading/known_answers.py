"""Tests whose answer an earlier test gives on one side: they are made only on the other one [pass_thread_jumps of GCC 12].

After `if g > most: most = g`, with `most` equal to r, comes `if g < least: least = g`, with `least` equal to r, too. In
Bresenham's line, where `dy` is not positive and `dx` not negative, `if e >= dy` comes before `if e <= dx`. LLVM's jump
threading knows the answer of a phi of constants, but neither relations nor ranges of variables: so the answers of both
sides become such a phi.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.estimate.choices.narrow_choices import is_extended
from bfsim.kernel.estimate.ranges.value_ranges import answer
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import SWAPPED, Instruction, Routine, is_number, phi_of, predicate, renamed

EXCLUDED = {"sgt": ("slt", "sle"), "slt": ("sgt", "sge"), "ugt": ("ult", "ule"), "ult": ("ugt", "uge")}
"""Which relations of two values cannot hold if one does."""
SAID = (1, 4)
"""How likely an answer is on the side where it is not known, and the other answer, if the first is known on the other
side: of two sides and two answers that are equally likely, three quarters of it are taken off
[update_bb_profile_for_threading in cfg.cc]. Comparisons with constants are threaded before it is guessed."""
EVEN = (1, 1)
"""For the earlier test: LLVM would take the hint of the later one for this one."""


@dataclass(frozen=True, slots=True)
class _Known:
    """A `test` after block `join`, to which block `asked` leads directly and by block `arm`: on the path from `known` its answer is `says`."""

    test: Instruction
    asked: str
    arm: str
    join: str
    known: str
    says: bool

    @property
    def open(self) -> str:
        """The block from which its answer is not known."""
        return self.asked if self.known == self.arm else self.arm


def with_known_answers(routine: Routine) -> Routine:
    """Return `routine` with a phi of its answers in place of each such test."""
    while True:
        flow = ControlFlow(routine)
        found = next(filter(None, (_known(flow, label) for label in flow.order)), None)
        if found is None:
            return routine
        routine = _answered(flow, found)


def _known(flow: ControlFlow, label: str) -> _Known | None:
    block = flow.blocks[label]
    first = flow.instruction(block.terminator.operands[0]) if len(set(block.successors)) == 2 else None
    if first is None or first.opcode != "icmp":
        return None
    arm, join = block.successors  # if it holds, and if not
    if (
        flow.predecessors[arm] != [label]
        or set(flow.blocks[arm].successors) != {join}
        or set(flow.predecessors[join]) != {arm, label}
    ):
        return None
    for test in _tests_behind(flow, join):
        if not all(_is_there(flow, each, label) for each in test.operands):
            continue
        if _excludes(flow, first, test):
            return _Known(test, label, arm, join, arm, says=False)
        for known, holds in ((arm, True), (label, False)):
            if (says := answer(flow, first, test, holds=holds)) is not None:
                return _Known(test, label, arm, join, known, says)
    return None


def _excludes(flow: ControlFlow, first: Instruction, test: Instruction) -> bool:
    """Whether a test of the same two values cannot hold if the first one does."""
    relation, pair, others = predicate(test), _values(flow, first), _values(flow, test)
    if others == pair[::-1]:
        relation = SWAPPED.get(relation, relation)
    elif others != pair:
        return False
    return relation in EXCLUDED.get(predicate(first), ())


def _tests_behind(flow: ControlFlow, join: str) -> Iterator[Instruction]:
    for label in flow.order:
        end = flow.blocks[label].terminator
        test = flow.instruction(end.operands[0]) if join in flow.dominators[label] and end.operands else None
        if test is not None and test.opcode == "icmp" and flow.users[test.result or ""] == [end]:
            yield test


def _values(flow: ControlFlow, test: Instruction) -> tuple[str, ...]:
    """The compared values, without their extensions to words."""
    found = []
    for operand in test.operands:
        each = flow.instruction(operand)
        found.append(each.text if each is not None and is_extended(each) else operand)
    return tuple(found)


def _is_there(flow: ControlFlow, value: str, label: str) -> bool:
    """Whether a value is known at the end of a block, or is made from one that is."""
    each = flow.instruction(value)
    if each is not None and is_extended(each):
        value = each.operands[0]
    home = flow.defined.get(value)
    return home is None or home[0] in flow.dominators[label]


def _answered(flow: ControlFlow, known: _Known) -> Routine:
    test = known.test
    name, asked = f"{test.result}.known", f"{test.result}.asked"
    rows: list[Instruction] = []
    names = dict[str, str]()
    for operand in test.operands:
        each = flow.instruction(operand)
        if each is not None and is_extended(each):
            names[operand] = f"{operand}.asked"
            rows.append(replace(each, result=names[operand]))
    rows.append(replace(renamed(test, names), result=asked))
    says = str(known.says).lower()
    phi = phi_of(name, "i1", [(says, known.known), (asked, known.open)], test)
    blocks, is_guessed = [], not is_number(test.operands[1])
    for block in flow.routine.blocks:
        own = [renamed(each, {test.result or "": name}) for each in block.instructions if each is not test]
        if is_guessed and block.terminator.operands[:1] == (test.result,):
            own[-1] = replace(own[-1], weights=SAID if known.says else SAID[::-1], hint="")
        elif is_guessed and block.label == known.asked and not own[-1].weights:
            own[-1] = replace(own[-1], weights=EVEN)
        if block.label == known.open:
            own = [*own[:-1], *rows, own[-1]]
        elif block.label == known.join:
            own = [phi, *own]
        blocks.append(replace(block, instructions=tuple(own)))
    return replace(flow.routine, blocks=tuple(blocks))
