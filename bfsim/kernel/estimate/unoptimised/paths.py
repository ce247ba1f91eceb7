"""Control flow of unoptimised code: the order of the blocks, and both targets of every branch.

`and`, `or` and `not` leave only jumps: the part that decides goes straight to where the whole condition leads. Loops
are tested at the bottom, as GCC lays them out at -O0.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.kernel.estimate.unoptimised.trees import Trees, base
from bfsim.kernel.ir.text import BasicBlock, Routine


@dataclass(frozen=True, slots=True)
class Branch:
    """A decision: the tested i1 value, and the blocks that run next when it is true and when it is false."""

    value: str
    if_true: str
    if_false: str


class Paths:
    """Branches and order of the blocks of a routine. `order` leaves out blocks that cannot be reached."""

    def __init__(self, routine: Routine, trees: Trees) -> None:
        self.trees = trees
        self.blocks = {block.label: block for block in routine.blocks}
        self.labels = [block.label for block in routine.blocks]
        self.order: list[str] = []
        self.landings: dict[str, list[str]] = {}
        """Where lone jumps out of a block go: the blocks of these jumps, in order."""
        self._open: set[str] = set()
        self._place(self.labels[0], None)
        self.order += self.landings.get("", [])
        self.landed = {label for labels in self.landings.values() for label in labels}
        self.branches = {label: self._branch(self.blocks[label]) for label in self.order}
        self.empty = {label for label in self.order if self._is_empty(self.blocks[label])}

    def next_of(self, label: str) -> str | None:
        """The block whose code follows that of `label`; None at the end."""
        rest = self.order[self.order.index(label) + 1 :]
        return next((each for each in rest if each not in self.empty), None)

    def target(self, label: str) -> str:
        """The first block with code that control reaches from the start of `label`."""
        seen: set[str] = set()
        while label in self.empty and label not in seen:
            seen.add(label)
            label = self.only_way(self.blocks[label]) or label
        return label

    def only_way(self, block: BasicBlock) -> str | None:
        """Where a block that does not branch goes; None if it returns or the value of a condition is needed."""
        successors = block.successors
        if len(successors) == 1:
            return successors[0]
        if self._is_extreme(block):
            return self._nth_after(successors[0], 2)
        if successors and (decided := self._truth(block)) is not None:
            return successors[0 if decided else 1]
        return None

    # Order

    def _place(self, label: str | None, end: str | None) -> None:
        """Put the blocks from `label` on in order, up to `end` or where control leaves."""
        while label is not None and label != end and label not in self._open:
            self._open.add(label)
            block, after = self.blocks[label], self._nth_after(label, 2)
            kind = base(label)
            if (landing := self._landing(block)) is not None:
                self.landings.setdefault(landing, []).append(label)
                return
            if kind == "for":
                body, step, after = (self._nth_after(label, n) for n in (1, 2, 3))
                self._place(body, step)
                self._open.add(step)
                self.order += [*self.landings.get(step, []), step, label, *self.landings.get(after, [])]
                label = after
            elif kind == "test":
                first = len(self.order)
                self._place_condition(label)
                condition = self.order[first:]
                del self.order[first:]
                self._place(self._nth_after(label, 1), label)
                self.order += [*condition, *self.landings.get(after, [])]
                label = after
            else:
                self.order.append(label)
                label = self._onward(block)

    def _landing(self, block: BasicBlock) -> str | None:
        """Where GCC puts the jump of `if test: break` and the like: after the rest, with a NOP for the debugger.

        The branch then goes there when the test is true. "" is the end of the function.
        """
        if base(block.label) not in ("then", "else") or len(block.instructions) > 1:
            return None
        if not block.successors:
            return None if block.terminator.operands else ""
        target = block.successors[0]
        is_own_end = target == self._nth_after(block.label, 2 if base(block.label) == "then" else 1)
        return None if is_own_end or base(target) not in ("step", "after") else target

    def _place_condition(self, label: str) -> None:
        """Put the blocks of a `while`'s test in order."""
        inside: str | None = label
        while inside is not None:
            self.order.append(inside)
            self._open.add(inside)
            inside = self._onward(self.blocks[inside], condition=True)

    def _onward(self, block: BasicBlock, *, condition: bool = False) -> str | None:
        """Place both sides of a branch and return what follows them; or what follows a block without a branch."""
        successors = block.successors
        kinds = [base(each) for each in successors]
        if len(successors) == 1:
            return (
                successors[0]
                if kinds[0] in ("for", "test", "decided") and successors[0] not in self._open
                else None
            )
        if len(successors) == 2 and {"and", "or"} & set(kinds):
            return successors[0] if kinds[0] in ("and", "or") else successors[1]
        if kinds[:1] in (["then"], ["yes"]):
            after = self._nth_after(successors[0], 2)
            self._place(successors[0], after)
            self._place(successors[1], after)
            return after
        return None

    def _nth_after(self, label: str, n: int) -> str:
        """`emit` appends the blocks of one statement together: then, else, after; for, body, step, after; and so on."""
        at = self.labels.index(label) + n
        return self.labels[at] if at < len(self.labels) else label

    # Branches

    def _branch(self, block: BasicBlock) -> Branch | None:
        value = self._decides(block)
        if value is None:
            return None
        if_true, if_false = (self._follow(block, value, truth) for truth in (True, False))
        return Branch(value, if_true, if_false)

    def _decides(self, block: BasicBlock) -> str | None:
        """The value that `block` computes and branches by."""
        if self._is_extreme(block):
            return None
        if len(block.successors) == 2:
            return self._leaf(block, block.terminator.operands[0])
        if len(block.successors) == 1 and base(block.successors[0]) == "decided":
            slot = self.blocks[block.successors[0]].instructions[0].operands[0]
            stored = self._stored(block, slot)
            return self._leaf(block, stored) if stored else None
        return None

    def _is_extreme(self, block: BasicBlock) -> bool:
        """Whether the branch belongs to a minimum or the like, which needs none."""
        if [base(each) for each in block.successors] != ["yes", "no"]:
            return False
        return self.blocks[block.successors[0]].instructions[-2].operands[-1] in self.trees.extremes

    def _leaf(self, block: BasicBlock, value: str) -> str | None:
        """Look through `not` and hidden slots; None if an earlier block or the compiler knows the value."""
        if value not in self.trees.home:
            return None
        each = self.trees.home[value][1]
        if each.opcode == "xor":
            return self._leaf(block, each.operands[0])
        if each.opcode == "load" and self.trees.is_hidden(each.operands[0]):
            stored = self._stored(block, each.operands[0])
            return self._leaf(block, stored) if stored else None
        tree = self.trees.condition(value)
        return None if all(arg.is_const for arg in tree.args) and tree.args else value

    def _stored(self, block: BasicBlock, slot: str) -> str | None:
        stores = [each for each in block.instructions if each.opcode == "store" and each.operands[1] == slot]
        return stores[-1].operands[0] if stores else None

    def _follow(self, block: BasicBlock, leaf: str, truth: bool) -> str:
        """Where `block` leads when its value `leaf` is `truth`."""
        known = {leaf: truth}
        while True:
            self._learn(block, known)
            at = 0
            if len(block.successors) == 2:
                if (operand := block.terminator.operands[0]) not in known:
                    return block.label
                at = 0 if known[operand] else 1
            target = self.blocks[block.successors[at]]
            if base(target.label) != "decided" or not self._only_logic(target):
                return target.label
            block = target

    def _learn(self, block: BasicBlock, known: dict[str, bool]) -> None:
        """Add to `known` (values and hidden slots) what follows from it in `block`."""
        for each in block.instructions:
            if each.opcode == "store" and self.trees.is_hidden(each.operands[1]):
                if each.operands[0] in known:
                    known[each.operands[1]] = known[each.operands[0]]
            elif each.opcode == "load" and each.operands[0] in known:
                known[each.result or ""] = known[each.operands[0]]
            elif each.opcode == "xor" and each.operands[0] in known:
                known[each.result or ""] = not known[each.operands[0]]

    def _only_logic(self, block: BasicBlock) -> bool:
        hidden = [
            (each.opcode == "load" and self.trees.is_hidden(each.operands[0]))
            or (each.opcode == "store" and self.trees.is_hidden(each.operands[1]))
            or (each.opcode == "xor" and " i1 " in each.text)
            or each.opcode == "br"
            for each in block.instructions
        ]
        return all(hidden)

    def _truth(self, block: BasicBlock) -> bool | None:
        """Whether a branch tests a number, as in `while True`."""
        tree = self.trees.condition(block.terminator.operands[0])
        if tree.op == "compare" and all(arg.is_const for arg in tree.args):
            return tree.name == "ne" and tree.args[0] != tree.args[1]
        return None

    def _is_empty(self, block: BasicBlock) -> bool:
        """Whether `block` makes no code: it only goes on, or only passes on what `and` and `or` decided."""
        is_first = block.label == self.labels[0]
        if is_first or self.branches[block.label] or not block.successors or block.label in self.landed:
            return False
        if base(block.label) in ("then", "else") and base(block.successors[0]) == "test":
            return False  # `continue` in a `while` is a separate jump
        if base(block.label) == "decided" and self._only_logic(block):
            return True
        return not list(self.trees.statements(block)) and self.only_way(block) is not None
