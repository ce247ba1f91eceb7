"""Induction-variable elimination: counters that a pointer stands for. Where only some iterations want `i`, it is the pointer less the array [tree-ssa-loop-ivopts.cc].

A counter of its own costs a step in each iteration, and a register. A difference to the array costs two operations where it is wanted,
which is worth it where every iteration accesses neighbours, a[i] and a[i + 1]; a difference to what is computed before the loop
anyway, a + y * w, costs one [get_computation_cost]; it is worth that if an iteration wants the counter at most once, by the guess of how
often each block runs [get_scaled_computation_cost_at].
"""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from bfsim.kernel.estimate.induction_variables.counter_wishes import homes_of, is_multiple, wishes_of
from bfsim.kernel.estimate.induction_variables.induction_variable import InductionVariable
from bfsim.kernel.estimate.induction_variables.induction_variables import InductionVariables
from bfsim.kernel.estimate.induction_variables.pointer_differences import Choice
from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.preheaders import preheader_of
from bfsim.kernel.ir.text import Instruction
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule


@dataclass(frozen=True, slots=True)
class EliminatedCounter:
    """A counter, or a sum of one, that is computed from the pointer of `variable`, in the blocks `blocks`."""

    counter: str
    variable: InductionVariable
    blocks: frozenset[str]
    sums: int
    """Operations: one where what the pointer differs by is computed before the loop."""
    is_stepped: bool = False
    """Whether the pointer has been stepped when it is wanted."""
    is_compared: bool = False
    """Whether it is only compared, where comparisons are: in a data register."""

    @property
    def name(self) -> str:
        """What its value is called there."""
        return f"{self.counter}.eliminated"


def eliminated_counters(
    flow: ControlFlow,
    evolution: ScalarEvolution,
    variables: InductionVariables,
    counted: set[str],
    frequency: Mapping[str, float],
    *,
    prepares: bool,
    weighs: bool,
) -> dict[str, EliminatedCounter]:
    """Return such counters of the `counted` loops (by header): of bytes, so that the distance is the index.

    `frequency`: how often each block runs; empty where that is not asked. `prepares`: whether differences to what is computed before the
    loop count. `weighs`: whether GCC's costs are added up (`pointer_differences`), for sums
    of a counter, and for the counter itself where it alone indexes the array.
    """
    found: dict[str, EliminatedCounter] = {}
    for variable in variables.all:
        loop = variable.loop
        bytewise = not variable.increment.symbolic and abs(variable.increment.constant) == 1
        steady = {offset for label, _, offset in variable.accesses if flow.every_iteration(label, loop)}
        shares = (
            len(variable.accesses) > 1
        )  # a pointer of their own is worth it though some iterations do without
        if loop.header not in counted or not bytewise or not (steady or shares):
            continue
        affine = dict(evolution.affine(variable.accesses[0][1].operands[-1]).terms)
        for each in flow.blocks[loop.header].instructions:
            name = each.result or ""
            if each.opcode != "phi" or name in found or affine.get(name) != 1:
                continue
            is_plain = affine.keys() == {name, variable.root}
            prepared = prepares and not is_plain and not evolution.ends_behind_start(loop)
            wishes = wishes_of(flow, evolution, loop, name) if weighs else None
            is_only = is_plain or (prepared and [each.loop for each in variables.all].count(loop) == 1)
            if not steady and (wishes is None or any(one.test is None for one in wishes.all)):
                continue
            if wishes and (not wishes.has_counter or (is_only and len(steady) <= 1)):
                choice = Choice(flow, evolution, variable, wishes)
                found |= _differences(choice) if choice.spares else {}
                continue
            blocks = _seldom_wanted(flow, evolution, loop, name, frequency)
            # a multiple of it is a variable of its own, which steps by more
            is_multiplied = any(map(is_multiple, flow.users.get(name, ())))
            if blocks and not is_multiplied and (len(steady) > 1 or prepared):
                found[name] = EliminatedCounter(name, variable, blocks, 1 if prepared else 2)
    return found


def pointed_counters(flow: ControlFlow, profile: CompilerProfile) -> frozenset[str]:
    """Return the counters of which nothing is left but a pointer once GCC has chosen what its loops step, in passes behind that."""
    if not (profile.applies(Rule.ELIMINATED_COUNTERS) and profile.applies(Rule.POINTER_DIFFERENCES)):
        return frozenset()
    evolution = ScalarEvolution(flow, InvariantCodeMotion(flow))
    variables = InductionVariables(flow, evolution, profile)
    headers = {loop.header for loop in flow.loops}
    found = eliminated_counters(flow, evolution, variables, headers, {}, prepares=True, weighs=True)
    walking = Tally(each.loop.header for each in variables.all)
    return frozenset(
        name for name, each in found.items() if each.is_compared and walking[each.variable.loop.header] == 1
    )


def _differences(choice: Choice) -> dict[str, EliminatedCounter]:
    counter, found = choice.wishes.counter, dict[str, EliminatedCounter]()
    for each in choice.wishes.all:
        alike = [other for other in choice.wishes.all if other.name == each.name]
        blocks = frozenset(label for other in alike for label in other.blocks)
        is_compared = all(other.test is not None for other in alike)
        is_stepped = each.name != counter or is_compared
        found[each.name] = EliminatedCounter(
            each.name, choice.variable, blocks, choice.sums(each), is_stepped, is_compared
        )
    return found


def _seldom_wanted(
    flow: ControlFlow,
    evolution: ScalarEvolution,
    loop: Loop,
    counter: str,
    frequency: Mapping[str, float],
) -> frozenset[str]:
    """Blocks that want a counter, at most once in an iteration and none in every one; else none."""
    wanted = [_before_inner(flow, loop, label) for label in _wanted(flow, evolution, loop, counter)]
    often = sum(frequency.get(label, 0) for label in wanted) / frequency.get(loop.header, 1)
    is_seldom = often <= 1 and all(
        flow.innermost(label) is loop and not flow.every_iteration(label, loop) for label in wanted
    )
    return frozenset(wanted) if is_seldom else frozenset()


def _wanted(flow: ControlFlow, evolution: ScalarEvolution, loop: Loop, counter: str) -> Iterator[str]:
    """Blocks that want the value of a counter itself: not its step, nor an address, nor the end of the loop."""
    phi = flow.instruction(counter)
    for user in flow.users.get(counter, []):
        if user.opcode == "getelementptr" or user.result == evolution.exit_test(loop):
            continue
        if user.opcode != "phi" and phi is not None and user.result in phi.operands:
            yield from _wanted_of_step(flow, evolution, loop, user, phi)
        else:
            yield from homes_of(flow, user, counter)


def _wanted_of_step(
    flow: ControlFlow, evolution: ScalarEvolution, loop: Loop, step: Instruction, phi: Instruction
) -> Iterator[str]:
    for user in flow.users.get(step.result or "", []):
        if user is not phi and user.opcode != "getelementptr" and user.result != evolution.exit_test(loop):
            yield loop.latch


def _before_inner(flow: ControlFlow, loop: Loop, label: str) -> str:
    """Where a value that does not change in the loops inside `loop` is computed for block `label`: before them.

    Of a preheader it is the test which leads there [ours]: GCC eliminates a counter there, too, but `pressure` charges reloads then that GCC
    does not make.
    """
    around = flow.loops_of(label)
    inner = around[: around.index(loop)] if loop in around else []
    if not inner:
        return label
    before = flow.entering(inner[-1])
    return flow.predecessors[before][0] if before == preheader_of(inner[-1]) else before
