"""How often each block of a routine runs, as guessed from the likelihood of its branches [Wu and Larus, MICRO 1994; predict.cc of GCC 12]."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from bfsim.kernel.ir.control_flow import ControlFlow

MOST_ITERATIONS = 100  # [params.opt, max-predicted-iterations] of a loop
Taken = Mapping[tuple[str, str], float]


def frequencies(flow: ControlFlow, taken: Taken) -> dict[str, float]:
    """Return the runs of each block per run of the routine: inner loops first. `taken`: of (block, successor), its probability."""
    turns: dict[str, float] = {}
    for loop in flow.loops:
        inside = loop.blocks | loop.leaving
        within = _passed(flow, loop.header, inside, taken, turns)
        again = sum(
            within[label] * taken[label, loop.header]
            for label in flow.predecessors[loop.header]
            if label in inside and loop.header in flow.dominators[label]
        )
        turns[loop.header] = min(MOST_ITERATIONS, 1 / max(1e-9, 1 - again))
    return _passed(flow, flow.routine.blocks[0].label, flow.blocks, taken, turns)


def _passed(
    flow: ControlFlow, start: str, inside: Collection[str], taken: Taken, turns: Mapping[str, float]
) -> dict[str, float]:
    """How often each block of a region runs if it is entered once at `start` and left for good by a jump back there."""
    found = dict.fromkeys(flow.blocks, 0.0)
    for label in flow.order:
        if label not in inside:
            continue
        into = sum(
            found[before] * taken[before, label]
            for before in flow.predecessors[label]
            if before in inside and label not in flow.dominators[before]
        )
        found[label] = (1.0 if label == start else into) * turns.get(label, 1.0)
    return found
