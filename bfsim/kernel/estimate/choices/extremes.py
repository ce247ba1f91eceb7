"""Minima and maxima, found before anything is moved to the paths on which their values come [minmax_replacement in tree-ssa-phiopt.cc of GCC 12].

GCC sees a minimum in `if v > 255: v = 255` as soon as it has read a function, whatever is done with `v` later. LLVM
would shift, mask or store it on each path separately, and see a branch.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.estimate.choices.narrow_choices import (
    is_extended,
    is_narrowed,
    is_narrowed_behind,
    stored_bits,
)
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import (
    BasicBlock,
    Instruction,
    Routine,
    arms_of,
    is_number,
    predicate,
    renamed,
    with_values,
)
from bfsim.kernel.ir.widths import WORD

SWAPPED = {"lt": "gt", "le": "ge", "gt": "lt", "ge": "le"}
BESIDE = {"lt": -1, "le": 1, "gt": 1, "ge": -1}
"""What is added to a comparison's constant to get the same comparison with its neighbour: x < 256 is x <= 255."""
OPPOSITE = {"min": "max", "max": "min"}
EXTREME = "bfsim.extreme"
SUMS = {"add": 1, "sub": -1}


def with_extremes(routine: Routine, *, narrows: bool) -> Routine:
    """Return `routine` with calls of LLVM's minimum and maximum in place of branches that choose them.

    `narrows`: whether both sides of a choice that is stored as narrow are converted first (`narrow_choices`).
    """
    while True:
        flow = ControlFlow(routine)
        found = next(
            filter(None, (_choice(flow, each, narrows=narrows) for each in reversed(routine.blocks))), None
        )
        if found is None:
            return routine
        routine = _chosen(routine, flow, found)


@dataclass(frozen=True, slots=True)
class _Choice:
    """A block that tests, and the `phi` that chooses after it: `name` is what it is of which operands, `arms` are the paths to it."""

    label: str
    phi: Instruction
    home: str
    name: str
    operands: tuple[str, str]
    arms: frozenset[str]
    rows: tuple[Instruction, ...] = ()
    """What an arm computes, and is now computed in any case."""
    sum_of: Instruction | None = None
    """What an arm adds, and is now added to the extreme."""


def _choice(flow: ControlFlow, block: BasicBlock, *, narrows: bool) -> _Choice | None:
    """The choice of a block's branch, if it is an extreme and the only one."""
    if block.terminator.opcode != "br" or len(set(block.successors)) != 2:
        return None
    test = flow.instruction(block.terminator.operands[0])
    comparison = _comparison(test) if test is not None else None
    if comparison is None:
        return None
    arms = frozenset(way for way in block.successors if _is_arm(flow, way, block.label))
    homes = {flow.blocks[way].successors[0] if way in arms else way for way in block.successors}
    if not arms or len(homes) != 1 or any(loop.header in homes for loop in flow.loops):
        return None
    home = homes.pop()
    sources = [way if way in arms else block.label for way in block.successors]
    phis = [each for each in flow.blocks[home].instructions if each.opcode == "phi"]
    here, there = sources
    choices = ((each, arms_of(each)) for each in phis)
    differing = [(each, arms[here], arms[there]) for each, arms in choices if arms[here] != arms[there]]
    if len(differing) != 1 or differing[0][0].bits != WORD:
        return None
    phi, yes, no = differing[0]
    if narrows and _is_none(flow, phi, yes, no):
        return None
    rows = tuple(row for arm in arms for row in flow.blocks[arm].instructions[:-1])
    sum_of = next((row for row in rows if row.opcode in SUMS and row.result in (yes, no)), None)
    if sum_of is not None:
        if (
            is_narrowed(flow, phi)
            or len(flow.users[sum_of.result or ""]) > 1
            or not is_number(no if yes == sum_of.result else yes)
        ):
            return None
        rows, (yes, no) = (), _before_sum(yes, no, sum_of)
        name = _plain(comparison, yes, no) if comparison.tested == sum_of.operands[0] else None
    else:
        name = _nested(flow, comparison, yes, no, rows[0]) if rows else _plain(comparison, yes, no)
    return (
        _Choice(block.label, phi, home, comparison.sign + name, (yes, no), arms, rows, sum_of)
        if name
        else None
    )


def _is_arm(flow: ControlFlow, way: str, label: str) -> bool:
    """Whether a block is only on one path from the test, and computes no more than an extreme or a sum with a number."""
    block = flow.blocks[way]
    rows = block.instructions[:-1]
    is_one = len(rows) == 1 and (
        (rows[0].result or "").startswith(f"%{EXTREME}")
        or (rows[0].opcode in SUMS and is_number(rows[0].operands[1]))
    )
    alone = (
        flow.predecessors[way] == [label] and block.terminator.opcode == "br" and len(block.successors) == 1
    )
    return alone and not block.enters and (not rows or is_one)


@dataclass(frozen=True, slots=True)
class _Comparison:
    """The tested value, `sign` (s or u), `kind` (lt ...), and what it is compared with: a value, or a number and its neighbour."""

    tested: str
    sign: str
    kind: str
    bounds: tuple[str, ...]

    @property
    def is_less(self) -> bool:
        """Whether the tested value is the smaller one if the comparison holds."""
        return self.kind in ("lt", "le")


def _comparison(test: Instruction) -> _Comparison | None:
    relation = predicate(test) if test.opcode == "icmp" and test.bits == WORD else "eq"
    if relation in ("eq", "ne"):
        return None
    (left, right), sign, kind = test.operands, relation[0], relation[1:]
    if is_number(left):
        left, right, kind = right, left, SWAPPED[kind]
    bounds = (right, str(int(right) + BESIDE[kind])) if is_number(right) else (right,)
    return _Comparison(left, sign, kind, bounds)


def _is_none(flow: ControlFlow, phi: Instruction, yes: str, no: str) -> bool:
    """Whether a choice of narrow values is no extreme, or one of unsigned numbers, for which there is no instruction."""
    unsigned = stored_bits(flow, phi) < WORD and _are_unsigned(flow, yes, no)
    return unsigned or (is_narrowed(flow, phi) and not is_narrowed_behind(flow, phi, yes, no))


def _are_unsigned(flow: ControlFlow, *values: str) -> bool:
    """Whether narrow values are extended with zeros, and numbers could be such values."""
    made = [flow.instruction(each) for each in values if not is_number(each)]
    most = max((each.bits for each in made if each is not None and each.opcode == "zext"), default=0)
    numbers = [int(each) for each in values if is_number(each)]
    return all(each is not None and each.opcode == "zext" for each in made) and all(
        0 <= each < 1 << most for each in numbers
    )


def _is_of_narrow(flow: ControlFlow, comparison: _Comparison) -> bool:
    """Whether the sign of a shifted narrow value is tested: that is not the wide value that is chosen [match.pd]."""
    each = flow.instruction(comparison.tested)
    if comparison.bounds[0] != "0" or each is None or each.opcode != "ashr":
        return False
    made_of = flow.instruction(each.operands[0])
    return made_of is not None and is_extended(made_of)


def _plain(comparison: _Comparison, yes: str, no: str) -> str | None:
    """The minimum or maximum of the compared values, if `yes` is chosen when the comparison holds, and `no` otherwise."""
    tested, bounds = comparison.tested, comparison.bounds
    if yes == tested and no in bounds:
        return "min" if comparison.is_less else "max"
    if no == tested and yes in bounds:
        return "max" if comparison.is_less else "min"
    return None


def _before_sum(yes: str, no: str, sum_of: Instruction) -> tuple[str, str]:
    """The extreme, if the number of a sum is added after the choice: `x - 20 if x > 20 else 0` is one of x and 20 [match.pd].

    If both sides are converted first, the sum is of a narrow number, which is not the tested value.
    """
    value, added = sum_of.operands[0], SUMS[sum_of.opcode] * int(sum_of.operands[1])
    if yes == sum_of.result:
        return value, str(int(no) - added)
    return str(int(yes) - added), value


def _nested(flow: ControlFlow, comparison: _Comparison, yes: str, no: str, inner: Instruction) -> str | None:
    """The same for a number and the extreme `inner` of the tested value and a number beyond the first one."""
    number, value = (yes, no) if inner.result == no else (no, yes)
    others = [each for each in inner.operands if each != comparison.tested]
    alone = value == inner.result and len(flow.users[value]) == 1
    if not alone or len(others) != 1 or not is_number(others[0]) or number not in comparison.bounds:
        return None
    if _is_of_narrow(flow, comparison):
        return None
    name = OPPOSITE["min" if "min." in inner.text else "max"]
    is_below = comparison.is_less == (number == yes)  # the number is chosen if the tested value is less
    beyond = int(others[0]) - int(number)
    return name if is_below == (name == "max") and (beyond >= 0 if name == "max" else beyond <= 0) else None


def _chosen(routine: Routine, flow: ControlFlow, choice: _Choice) -> Routine:
    """Return `routine` with the extreme computed in place of the branch, which now leads straight to the choice."""
    branch = flow.blocks[choice.label].terminator
    name = f"%{EXTREME}.{choice.name}.{choice.label}"
    unused = branch.operands[0] if flow.users[branch.operands[0]] == [branch] else None
    left, right = choice.operands
    call = replace(
        branch,
        result=name,
        opcode="call",
        text=f"call i{WORD} @llvm.{choice.name}.i{WORD}(i{WORD} {left}, i{WORD} {right})",
        operands=choice.operands,
        weights=(),
        hint="",
    )
    sums = [renamed(each, {each.operands[0]: name}) for each in (choice.sum_of,) if each is not None]
    jump = replace(branch, text=f"br label %{choice.home}", operands=(), weights=(), hint="")
    rows = [each for each in flow.blocks[choice.label].instructions[:-1] if each.result != unused]
    changed = {
        choice.label: (*rows, *choice.rows, call, *sums, jump),
        choice.home: tuple(
            _arrivals(flow.blocks[choice.home], choice, (sums[-1].result or "") if sums else name)
        ),
    }
    blocks = (
        replace(block, instructions=changed.get(block.label, block.instructions))
        for block in routine.blocks
        if block.label not in choice.arms
    )
    return replace(routine, blocks=tuple(blocks))


def _arrivals(block: BasicBlock, choice: _Choice, name: str) -> Iterator[Instruction]:
    """The rows of the block after a choice, whose phis get one value from the test instead of two."""
    gone = {choice.label, *choice.arms}
    for each in block.instructions:
        if each.opcode != "phi":
            yield each
            continue
        values = arms_of(each)
        one = name if each is choice.phi else next(values[label] for label in values if label in gone)
        arms = {label: value for label, value in values.items() if label not in gone}
        yield with_values(each, arms | {choice.label: one})
