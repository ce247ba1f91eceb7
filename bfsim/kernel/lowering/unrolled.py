"""Loops of so few and so small iterations that a compiler writes them out [try_unroll_loop_completely in tree-ssa-loop-ivcanon.cc].

GCC does so at -O2 where the code does not grow by its own estimate: two thirds of the iterations without what becomes
constant in them, against one iteration. LLVM is asked to unroll those and no others.
"""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel.ir_text import Instruction, Routine, placed_rows, read_module
from bfsim.kernel.loops import ControlFlow, Loop, pointee_nbytes
from bfsim.kernel.lowering.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.lowering.invariant_loads import hoist_loads
from bfsim.kernel.lowering.scalar_evolution import ScalarEvolution

MOST_ITERATIONS = 8  # [max-completely-peel-times]
CONTROL = 4  # statements that vanish with the loop: two counters, and a test that counts as two
FREE = ("phi", "br", "zext", "sext", "trunc", "freeze")
LOOP_NOTE = ", !llvm.loop !"
FULL, DISABLED = "llvm.loop.unroll.full", "llvm.loop.unroll.disable"


def marked(text: str) -> str | None:
    """Return the module `text` with a request to unroll on each such loop, and one not to on all others; None if there is none."""
    wishes = {
        (routine.symbol, loop.latch): FULL if unrolls else DISABLED
        for routine in read_module(text)
        for loop, unrolls in _loops(routine)
    }
    if FULL not in wishes.values():
        return None
    rows, notes = list(_annotated(text, wishes)), len(text)  # numbers that no other note has
    for number, wish in enumerate(wishes.values()):
        own = notes + 2 * number
        rows += [f"!{own} = distinct !{{!{own}, !{own + 1}}}", f'!{own + 1} = !{{!"{wish}"}}']
    return "\n".join(rows)


def _annotated(text: str, wishes: dict[tuple[str, str], str]) -> Iterator[str]:
    numbers = {place: len(text) + 2 * number for number, place in enumerate(wishes)}
    for symbol, label, row in placed_rows(text):
        latch = row.startswith("  br ") and (symbol, label) in numbers
        yield f"{row.split(LOOP_NOTE)[0]}{LOOP_NOTE}{numbers[symbol, label]}" if latch else row


def _loops(routine: Routine) -> Iterator[tuple[Loop, bool]]:
    flow = ControlFlow(hoist_loads(routine))
    evolution = ScalarEvolution(flow, InvariantCodeMotion(flow))
    for loop in flow.loops:
        yield loop, not loop.inner and _shrinks(flow, evolution, loop)


def _shrinks(flow: ControlFlow, evolution: ScalarEvolution, loop: Loop) -> bool:
    inside = [each for label in flow.inside(loop) for each in flow.blocks[label].instructions]
    iterations = evolution.iterations(loop)
    if iterations is None or iterations > MOST_ITERATIONS or flow.exits(loop) != [loop.latch]:
        return False
    if any(each.is_call or each.is_division for each in inside):
        return False
    control = _control(flow, evolution, loop)
    size = sum(_size(flow, evolution, loop, each) for each in inside if each.result not in control)
    return 2 * iterations * size <= 3 * (size + CONTROL)


def _control(flow: ControlFlow, evolution: ScalarEvolution, loop: Loop) -> set[str | None]:
    """The test that ends the loop, and the step of its counter."""
    counters = {each.result for each in flow.blocks[loop.header].instructions if each.opcode == "phi"}
    steps = [
        each.result
        for each in flow.blocks[loop.latch].instructions
        if each.opcode == "add" and each.operands[0] in counters and each.operands[1].lstrip("-").isdigit()
    ]
    return {evolution.exit_test(loop), *steps}


def _size(flow: ControlFlow, evolution: ScalarEvolution, loop: Loop, each: Instruction) -> int:
    """Statements that C has for an instruction; what does not change in the loop has left it."""
    if each.opcode in FREE or (each.result and evolution.code_motion.is_invariant(each.result, loop)):
        return 0
    if each.opcode != "getelementptr":
        return 1
    base = flow.instruction(each.operands[0])
    summed = (
        base is not None and base.opcode == "getelementptr"
    )  # C sums indices first, in an operation of its own
    return 1 + summed + (pointee_nbytes(each) > 1)
