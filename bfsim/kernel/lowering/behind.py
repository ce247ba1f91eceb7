"""Counters that a pointer stands for: where only some turns want `i`, it is the pointer less the array [tree-ssa-loop-ivopts.cc].

So it is where every turn accesses neighbours, a[i] and a[i + 1]; beside a single access, GCC keeps the counter.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from bfsim.kernel.ir_text import PHI_ARM, Instruction
from bfsim.kernel.loops import Flow, Loop
from bfsim.kernel.lowering.groups import Group, Groups
from bfsim.kernel.lowering.walks import Walks


@dataclass(frozen=True, slots=True)
class Behind:
    """A counter that is computed from the pointer of `group`, in the blocks `places`."""

    counter: str
    group: Group
    places: frozenset[str]

    @property
    def name(self) -> str:
        """What its value is called there."""
        return f"{self.counter}.behind"


def counters_behind(flow: Flow, walks: Walks, groups: Groups, counted: set[str]) -> dict[str, Behind]:
    """Return such counters of the `counted` loops (by header): of bytes, so that the distance is the index."""
    found: dict[str, Behind] = {}
    for group in groups.all:
        loop = group.loop
        bytewise = not group.advance.symbolic and abs(group.advance.constant) == 1
        steady = {offset for label, _, offset in group.accesses if flow.every_turn(label, loop)}
        if loop.header not in counted or not bytewise or len(steady) < 2:
            continue
        for each in flow.blocks[loop.header].instructions:
            name = each.result or ""
            form = dict(walks.form(group.accesses[0][1].operands[-1]).terms)
            if each.opcode != "phi" or name in found or form != {name: 1, group.root: 1}:
                continue
            places = frozenset(_wanted(flow, walks, loop, name))
            if places and all(
                flow.innermost(label) is loop and not flow.every_turn(label, loop) for label in places
            ):
                found[name] = Behind(name, group, places)
    return found


def _wanted(flow: Flow, walks: Walks, loop: Loop, counter: str) -> Iterator[str]:
    """Blocks that want the value of a counter itself: not its step, nor an address, nor the end of the loop."""
    phi = flow.instruction(counter)
    for user in flow.users.get(counter, []):
        if user.opcode == "getelementptr" or user.result == walks.exit_test(loop):
            continue
        if user.opcode == "phi":
            yield from (source[1:] for value, source in PHI_ARM.findall(user.text) if value == counter)
        elif phi is not None and user.result in phi.operands:
            yield from _wanted_of_step(flow, walks, loop, user, phi)
        else:
            yield _home(flow, user)


def _wanted_of_step(
    flow: Flow, walks: Walks, loop: Loop, step: Instruction, phi: Instruction
) -> Iterator[str]:
    for user in flow.users.get(step.result or "", []):
        if user is not phi and user.opcode != "getelementptr" and user.result != walks.exit_test(loop):
            yield loop.latch


def _home(flow: Flow, user: Instruction) -> str:
    return next(
        label for label, block in flow.blocks.items() if any(each is user for each in block.instructions)
    )
