"""Ways to a switch on which its number is known lead past it [tree-ssa-threadbackward.cc of GCC 12].

Of `if state == 1: ..., elif state == 2: ...` in a loop, each way round the loop on which the state is set to a number leads straight to what is
done in that state. The ways are copied while variables are in memory, where blocks can be copied as they are.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import count

from bfsim.kernel.ir_text import (
    HIDES,
    INVERTED,
    BasicBlock,
    Instruction,
    Routine,
    is_number,
    predicate,
    renamed,
)
from bfsim.kernel.loops import ControlFlow
from bfsim.kernel.lowering.edges import going_to
from bfsim.kernel.lowering.jump_tables import MARK

MOST_COPIED = 100
"""Instructions, but loads and stores of variables, of the ways that are copied from a block [param_max_fsm_thread_path_insns]."""
RELATIONS = {"eq": int.__eq__, "slt": int.__lt__, "sgt": int.__gt__}
Known = frozenset[tuple[str, int]]
"""What is known to be in variables, by their names."""


def with_state_machines(routine: Routine) -> Routine:
    """Return `routine`, whose variables are in memory, with copies of such ways to the chains of tests that are marked."""
    return _Threading(ControlFlow(routine)).threaded()


@dataclass(slots=True)
class _Ways:
    """Where a block leads with what is known before it, and what is known behind it."""

    block: BasicBlock
    ways: tuple[str, ...]
    known: Known
    is_past: bool
    """Whether it is of a chain, and where that leads is known."""
    is_set: bool
    """Whether a variable is set to a number there: ways begin there, and none goes on."""


@dataclass
class _Threading:
    """Copies ways to the chains of a routine, of which variables are in memory."""

    flow: ControlFlow
    blocks: dict[str, BasicBlock] = field(init=False)
    copies: dict[tuple[str, Known], str] = field(init=False, default_factory=dict)
    numbers: count[int] = field(init=False, default_factory=count)

    def __post_init__(self) -> None:
        self.blocks = dict(self.flow.blocks)

    def threaded(self) -> Routine:
        """Return the routine with them."""
        for block in self.flow.routine.blocks:
            for each in block.instructions:
                number = self.flow.instruction(each.operands[0]) if HIDES in each.text else None
                if number is not None and number.opcode == "load":
                    users = self.flow.users.get(each.result or "", ())
                    kept = {user.operands[-1] for user in users if user.opcode == "store"}
                    self._thread(number.operands[-1], kept)
        return replace(self.flow.routine, blocks=tuple(self.blocks.values()))

    def _thread(self, variable: str, kept: set[str]) -> None:
        """Lead each block in the loop around a chain that sets its number past it. `kept`: where the hidden number is."""
        tests = {
            label
            for label, block in self.flow.blocks.items()
            if label.endswith(MARK)
            and any(each.operands[-1:] == (one,) for one in kept for each in block.instructions)
        }
        firsts = [each for each in sorted(tests) if not tests.intersection(self.flow.predecessors[each])]
        loop = self.flow.innermost(firsts[0]) if firsts else None
        self.variables, self.leading = self._copied_to({variable, *kept}), self._leading_to(firsts)
        self.copies.clear()
        for label in sorted(loop.blocks) if loop else ():
            block = self.flow.blocks[label]
            found = self._ways(block, frozenset())
            if found.is_set and not label.endswith(MARK):
                goals = {
                    way: goal
                    for way in dict.fromkeys(block.successors)  # in order, for copies are numbered
                    if (goal := self._copy(way, found.known)) != way
                }
                for way, goal in goals.items():
                    self.blocks[label] = going_to(self.blocks[label], way, goal)

    def _copied_to(self, variables: set[str]) -> set[str]:
        """Return variables, and those from which they are copied."""
        found, waiting = set(variables), [*variables]
        while waiting:
            wanted = waiting.pop()
            for each in self.flow.users.get(wanted, ()):
                source = self.flow.instruction(each.operands[0]) if each.opcode == "store" else None
                is_copy = source is not None and source.opcode == "load" and each.operands[-1] == wanted
                if source is not None and is_copy and source.operands[-1] not in found:
                    found.add(source.operands[-1])
                    waiting.append(source.operands[-1])
        return found

    def _leading_to(self, firsts: list[str]) -> set[str]:
        """Return the blocks from which there is a way to the first ones of a chain, and those of chains."""
        found, waiting = {label for label in self.flow.blocks if label.endswith(MARK)}, [*firsts]
        while waiting:
            for before in self.flow.predecessors[waiting.pop()]:
                if before not in found:
                    found.add(before)
                    waiting.append(before)
        return found

    def _ways(self, block: BasicBlock, known: Known) -> _Ways:
        """Go through a block with what is known before it."""
        variables, values, is_set = dict(known), dict[str, int](), False

        def value(name: str) -> int | None:
            return int(name) if is_number(name) else values.get(name)

        for each in block.instructions:
            result, found = each.result or "", None
            if each.opcode == "store" and each.operands[-1] in self.variables:
                variables.pop(each.operands[-1], None)
                is_set |= is_number(each.operands[0])
                if (stored := value(each.operands[0])) is not None:
                    variables[each.operands[-1]] = stored
            elif each.opcode == "load":
                found = variables.get(each.operands[-1])
            elif each.opcode in ("zext", "sext") or HIDES in each.text:
                found = value(each.operands[0])
            elif each.opcode == "icmp":
                found = _answer(predicate(each), *map(value, each.operands[:2]))
            if found is not None:
                values[result] = found
        ways, end = block.successors, block.terminator
        decided = values.get(end.operands[0]) if end.operands else None
        if decided is not None:
            ways = (ways[0 if decided else 1],)
        is_past = block.label.endswith(MARK) and decided is not None and not ways[0].endswith(MARK)
        return _Ways(block, ways, frozenset(variables.items()), is_past, is_set)

    def _copy(self, label: str, known: Known) -> str:
        """Return a copy of the ways from a block with what is known, or the block where none of them leads past the chain."""
        nodes = dict[tuple[str, Known], _Ways]()
        waiting = [(label, known)]
        while waiting:
            node = waiting.pop()
            if node not in nodes and node[0] in self.leading and node[1]:
                found = nodes[node] = self._ways(self.flow.blocks[node[0]], node[1])
                if not (found.is_past or found.is_set) and (
                    len(found.ways) == 1 or not node[0].endswith(MARK)
                ):
                    waiting += [(way, found.known) for way in found.ways]
        leads_past = {node for node, each in nodes.items() if each.is_past}
        while more := {
            node
            for node, each in nodes.items()
            if node not in leads_past and any((way, each.known) in leads_past for way in each.ways)
        }:
            leads_past |= more
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
            self.copies[node] = f"{node[0].removesuffix(MARK)}.in{next(self.numbers)}"
        for node in new:
            self._add(self.copies[node], nodes[node])
        return self.copies[label, known]

    def _add(self, label: str, of: _Ways) -> None:
        """Add the copy of a block; where the number is known its test is left out."""
        ending = label.rsplit(".", 1)[1]
        names = {each.result: f"{each.result}.{ending}" for each in of.block.instructions if each.result}
        rows = [
            renamed(replace(each, result=names.get(each.result or "")), names)
            for each in of.block.instructions
        ]
        end = of.block.terminator
        if len(of.ways) == 1:
            text = f"br label %{of.ways[0]}"
            rows[-1] = Instruction(None, "br", text, (), end.line, location=end.location)
        block = replace(of.block, label=label, instructions=tuple(rows))
        for way in set(of.ways):
            block = going_to(block, way, self.copies.get((way, of.known), way))
        self.blocks[label] = block


def _answer(relation: str, one: int | None, other: int | None) -> int | None:
    """Return whether a relation holds between two numbers, None where one is not known."""
    if one is None or other is None or relation[0] == "u":
        return None
    holds = RELATIONS.get(relation) or RELATIONS[INVERTED[relation]]
    return int(holds(one, other) == (relation in RELATIONS))
