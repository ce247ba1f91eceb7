"""Paths that are copied for what is known on them, while variables are in memory, so that blocks can be copied as they are."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import count

from bfsim.kernel.estimate.switches.jump_tables import MARK
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import going_to
from bfsim.kernel.ir.text import (
    HIDES,
    INVERTED,
    TRUTHS,
    BasicBlock,
    Instruction,
    Routine,
    is_constant,
    is_number,
    predicate,
    renamed,
)

MOST_COPIED = 100
"""Most instructions, without loads and stores of variables, of the paths that are copied from a block [param_max_fsm_thread_path_insns]."""
MOST_NODES = 300
"""[ours] Most nodes, blocks with what is known before them, on the paths from one block."""
RELATIONS = {"eq": int.__eq__, "slt": int.__lt__, "sgt": int.__gt__}
Known = frozenset[tuple[str, int]]
"""The known values of variables, by name."""
Node = tuple[str, Known]
"""A block, and what is known before it."""


@dataclass(slots=True)
class Ways:
    """Where a block leads with what is known before it, and what is known after it."""

    block: BasicBlock
    ways: tuple[str, ...]
    known: Known
    is_past: bool
    """Whether it is a test to be skipped, and where it leads is known."""
    is_set: bool
    """Whether a variable is set to a number there: paths begin there, and none goes on."""


def _all(nodes: Mapping[Node, Ways], first: Node) -> set[Node]:
    return {*nodes}


@dataclass
class CopiedWays:
    """Copies paths of a routine that lead past tests; the given functions decide which tests these are, and which paths are copied."""

    flow: ControlFlow
    is_past: Callable[[BasicBlock, str], bool]
    """Whether a block makes a test to be skipped, if it surely leads to this block."""
    goes_on: Callable[[Ways], bool]
    """Whether a copied path goes on after a block."""
    short_ways: Callable[[Mapping[Node, Ways], Node], set[Node]] = _all
    """Of the nodes from which a path leads past a test: those on a path from the first one that is short enough to be copied."""
    ending: str = "in"
    """Goes into the names of copies, before a number; copies of copies need another one."""
    blocks: dict[str, BasicBlock] = field(init=False)
    variables: set[str] = field(init=False, default_factory=set)
    leading: set[str] = field(init=False, default_factory=set)
    copies: dict[Node, str] = field(init=False, default_factory=dict)
    numbers: count[int] = field(init=False, default_factory=count)

    def __post_init__(self) -> None:
        self.blocks = dict(self.flow.blocks)

    def routine(self) -> Routine:
        """Return the routine with the copies."""
        return replace(self.flow.routine, blocks=tuple(self.blocks.values()))

    def lead(self, labels: Iterable[str], leading: set[str], variables: set[str]) -> None:
        """Lead the blocks that set a number past its tests.

        `leading`: blocks that lead to the tests. `variables`: those of which something may be known.
        """
        self.leading, self.variables = leading, variables
        self.copies.clear()
        for label in labels:
            self._lead(label)

    def _lead(self, label: str) -> None:
        block = self.flow.blocks[label]
        found = self._ways(block, frozenset())
        if not found.is_set:
            return
        goals = {
            way: goal
            for way in dict.fromkeys(block.successors)  # in order, because copies are numbered
            if (goal := self._copy(way, found.known)) != way
        }
        for way, goal in goals.items():
            self.blocks[label] = going_to(self.blocks[label], way, goal)

    def _ways(self, block: BasicBlock, known: Known) -> Ways:
        """Go through a block with what is known before it."""
        variables, values, is_set = dict(known), dict[str, int](), False

        def value(name: str) -> int | None:
            return int(name) if is_number(name) else TRUTHS.get(name, values.get(name))

        for each in block.instructions:
            result, found = each.result or "", None
            if each.opcode == "store" and each.operands[-1] in self.variables:
                variables.pop(each.operands[-1], None)
                is_set |= is_constant(each.operands[0])
                if (stored := value(each.operands[0])) is not None:
                    variables[each.operands[-1]] = stored
            elif each.opcode == "load":
                found = variables.get(each.operands[-1])
            elif each.opcode in ("zext", "sext") or HIDES in each.text:
                found = value(each.operands[0])
            elif each.opcode == "icmp":
                found = answered(predicate(each), *map(value, each.operands[:2]))
            if found is not None:
                values[result] = found
        ways, end = block.successors, block.terminator
        decided = values.get(end.operands[0]) if end.operands else None
        if decided is not None:
            ways = (ways[0 if decided else 1],)
        is_past = decided is not None and self.is_past(block, ways[0])
        return Ways(block, ways, frozenset(variables.items()), is_past, is_set)

    def _copy(self, label: str, known: Known) -> str:
        """Return a copy of the paths from a block with what is known, or the block if none of them leads past the chain."""
        nodes = dict[Node, Ways]()
        waiting = [(label, known)]
        while waiting:
            node = waiting.pop()
            if len(nodes) > MOST_NODES:
                return label
            if node not in nodes and node[0] in self.leading and node[1]:
                found = nodes[node] = self._ways(self.flow.blocks[node[0]], node[1])
                if self.goes_on(found):
                    waiting += [(way, found.known) for way in found.ways]
        past = _leading_past(nodes)
        leads_past = self.short_ways(
            {node: each for node, each in nodes.items() if node in past}, (label, known)
        )
        rows = [
            row
            for node in leads_past
            for row in nodes[node].block.instructions
            if row.opcode not in ("load", "store")
        ]
        if (label, known) not in leads_past or len(rows) > MOST_COPIED:
            return label
        new = sorted(leads_past - self.copies.keys(), key=lambda each: (each[0], sorted(each[1])))
        for node in new:
            self.copies[node] = f"{node[0].removesuffix(MARK)}.{self.ending}{next(self.numbers)}"
        for node in new:
            self._add(self.copies[node], nodes[node])
        return self.copies[label, known]

    def _add(self, label: str, of: Ways) -> None:
        """Add the copy of a block; if the number is known, without its test."""
        block = copied_block(of.block, label, of.ways[0] if len(of.ways) == 1 else "")
        for way in set(of.ways):
            block = going_to(block, way, self.copies.get((way, of.known), way))
        self.blocks[label] = block


def copied_block(block: BasicBlock, label: str, goal: str = "") -> BasicBlock:
    """Return a block with new names that end like its `label`; if there is a `goal`, it leads there and makes no test."""
    ending = label.rsplit(".", 1)[1]
    names = {each.result: f"{each.result}.{ending}" for each in block.instructions if each.result}
    rows = [renamed(replace(each, result=names.get(each.result or "")), names) for each in block.instructions]
    if goal:
        end = block.terminator
        rows[-1] = Instruction(None, "br", f"br label %{goal}", (), end.line, location=end.location)
    return replace(block, label=label, instructions=tuple(rows))


def _leading_past(nodes: Mapping[Node, Ways]) -> set[Node]:
    """The nodes from which a path leads past a test."""
    leading = {node for node, each in nodes.items() if each.is_past}
    while more := {
        node
        for node, each in nodes.items()
        if node not in leading and any((way, each.known) in leading for way in each.ways)
    }:
        leading |= more
    return leading


def copied_to(flow: ControlFlow, variables: set[str]) -> set[str]:
    """Return variables, and those from which they are copied."""
    found, waiting = set(variables), [*variables]
    while waiting:
        wanted = waiting.pop()
        for each in flow.users.get(wanted, ()):
            source = flow.instruction(each.operands[0]) if each.opcode == "store" else None
            is_copy = source is not None and source.opcode == "load" and each.operands[-1] == wanted
            if source is not None and is_copy and source.operands[-1] not in found:
                found.add(source.operands[-1])
                waiting.append(source.operands[-1])
    return found


def answered(relation: str, one: int | None, other: int | None) -> int | None:
    """Return whether a relation holds between two numbers; None if one is not known."""
    if one is None or other is None or relation[0] == "u":
        return None
    holds = RELATIONS.get(relation) or RELATIONS[INVERTED[relation]]
    return int(holds(one, other) == (relation in RELATIONS))
