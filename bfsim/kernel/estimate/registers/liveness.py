"""Liveness: which values are alive where."""

from __future__ import annotations

from dataclasses import dataclass, field

from bfsim.kernel.estimate.selection.machine_code import MachineCode
from bfsim.kernel.ir.control_flow import ControlFlow


@dataclass(slots=True)
class Liveness:
    """Names alive at the start and at the end of each block."""

    into: dict[str, set[str]] = field(default_factory=dict)
    out: dict[str, set[str]] = field(default_factory=dict)


def liveness(flow: ControlFlow, code: MachineCode, merged: dict[str, list[tuple[str, str]]]) -> Liveness:
    """Solve the data flow equations. `merged`: for each phi, the (value, source block) of its arms.

    A phi reads its arms at the ends of their source blocks, and is written at the start of its own.
    """
    at_end: dict[str, set[str]] = {label: set() for label in flow.blocks}
    for arms in merged.values():
        for value, label in arms:
            at_end[label].add(value)
    written = {
        label: {flow_phi for flow_phi in merged if flow.defined[flow_phi][0] == label}
        for label in flow.blocks
    }
    reads: dict[str, set[str]] = {}
    for label in flow.blocks:
        needed: set[str] = set()
        for instruction in reversed(code.of[label]):
            needed.discard(instruction.result or "")
            needed.update(name for name, _ in instruction.uses if not name.startswith("#"))
        reads[label] = needed
        written[label] |= {instruction.result for instruction in code.of[label] if instruction.result}
    live = Liveness({label: set() for label in flow.blocks}, {label: set() for label in flow.blocks})
    changed = True
    while changed:
        changed = False
        for label in reversed(flow.order):
            out = set(at_end[label]).union(*(live.into[way] for way in flow.blocks[label].successors))
            phis = {each for each in merged if flow.defined[each][0] == label}
            into = (reads[label] - phis) | (out - written[label])
            if out != live.out[label] or into != live.into[label]:
                live.out[label], live.into[label], changed = out, into, True
    return live
