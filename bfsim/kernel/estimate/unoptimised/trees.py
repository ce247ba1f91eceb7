"""Plain IR → the statements of the C program that it stands for.

`emit` writes one load for every mention of a variable and one block for every branch of the source, so that the C
statements can be read back. Code that C would not have is dropped here: the correction of a division that rounds down,
the mask of a shift count, the second counter of a loop.
"""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel.estimate.unoptimised.expressions import (
    Expr,
    TreeStatement,
    compare,
    const,
    extreme_of,
    simplified,
)
from bfsim.kernel.ir.text import COUNTS, TRUTHS, BasicBlock, Instruction, Routine
from bfsim.kernel.ir.widths import BYTE

ARITHMETIC = {"add": "+", "sub": "-", "mul": "*", "and": "&", "or": "|", "xor": "^", "shl": "<<", "lshr": ">>",
              "ashr": ">>", "udiv": "udiv", "urem": "urem", "sdiv": "sdiv", "srem": "srem"}  # fmt: skip
INTRINSICS = {"smin": "min", "smax": "max", "umin": "umin", "umax": "umax", "abs": "abs"}
UNSIGNED = ("lshr", "udiv", "urem")


def base(label: str) -> str:
    """Return the word that `emit` gave a block, without LLVM's number."""
    return label.split(".", maxsplit=1)[0]


class Trees:
    """The expressions of a routine."""

    def __init__(self, routine: Routine) -> None:
        self.routine = routine
        self.home = {
            each.result: (block.label, each)
            for block in routine.blocks for each in block.instructions if each.result
        }  # fmt: skip
        self.used_in: dict[str, set[str]] = {}
        for block in routine.blocks:
            for each in block.instructions:
                for operand in each.operands:
                    self.used_in.setdefault(operand, set()).add(block.label)
        self.choices = {
            block.instructions[0].operands[0] for block in routine.blocks if base(block.label) == "chosen"
        }
        """Slots of conditional expressions, which C keeps in a register."""
        self.extensions = self._extensions()
        self.extremes: dict[str, Expr] = {}
        """The slots that are a minimum, maximum or absolute value, inner ones first."""
        self._find_extremes()

    def statements(self, block: BasicBlock) -> Iterator[TreeStatement]:
        """The statements of `block`, in order, without its branch."""
        for each in block.instructions:
            if each.opcode == "store":
                yield from self._store(each, block.label)
            elif each.is_call and each.result not in self.used_in:
                yield TreeStatement(self._call(each, block.label), None, each.line)
            elif each.result and self._outlives(each, block) and not self._is_bound(each):
                yield TreeStatement(self._value(each), Expr("register"), each.line)

    def condition(self, operand: str) -> Expr:
        """The truth value `operand`."""
        return self.expr(operand, None)

    def expr(self, operand: str, label: str | None) -> Expr:
        """The value of `operand` in block `label`; if None, where it was computed, as C computes a loop's bound."""
        if not operand.startswith("%"):
            return const(TRUTHS.get(operand) or int(operand if operand[-1].isdigit() else 0))
        if operand not in self.home:
            return Expr("local", name=operand[1:])
        place, each = self.home[operand]
        elsewhere = label is not None and place != label
        if elsewhere or (place != label and each.is_call):
            return Expr("register", name=operand)
        return self._value(each)

    def _extensions(self) -> dict[str, bool]:
        """Whether the elements of an array are unsigned, by how they are extended once loaded."""
        found = {}
        for _, each in self.home.values():
            if each.opcode in ("zext", "sext") and each.operands[0] in self.home:
                load = self.home[each.operands[0]][1]
                if load.opcode == "load":
                    found[self.home[load.operands[0]][1].operands[-2]] = each.opcode == "zext"
        return found

    def _find_extremes(self) -> None:
        blocks = {block.label: block for block in self.routine.blocks}
        for block in self.routine.blocks:
            test = self.home.get(next(iter(block.terminator.operands), ""))
            if (
                test
                and test[1].opcode == "icmp"
                and [base(each) for each in block.successors] == ["yes", "no"]
            ):
                sides = [self._chosen(blocks[each]) for each in block.successors]
                operands = [self.expr(each, block.label) for each in test[1].operands]
                if extreme := extreme_of(test[1].text.split()[1], operands, sides):
                    self.extremes[blocks[block.successors[0]].instructions[-2].operands[1]] = extreme

    def _chosen(self, block: BasicBlock) -> Expr:
        """One side of a conditional expression, if nothing else happens in its block."""
        stores = [each for each in block.instructions if each.opcode == "store"]
        return self.expr(stores[-1].operands[0], block.label) if len(stores) == 1 else Expr("register")

    def is_hidden(self, slot: str) -> bool:
        """Whether a slot belongs to `and` and `or` and not to a variable."""
        return slot.startswith("%.")

    def _outlives(self, each: Instruction, block: BasicBlock) -> bool:
        return bool(self.used_in.get(each.result or "", set()) - {block.label}) and each.opcode != "alloca"

    def _is_bound(self, each: Instruction) -> bool:
        """Whether a value is only compared with a loop's counter (C computes it in the comparison), or is that counter."""
        if self.is_counter(each.result or ""):
            return True
        outside = self.used_in[each.result or ""]
        return all(base(label) == "for" for label in outside) and not self._value(each).calls

    def is_counter(self, operand: str) -> bool:
        """Whether `operand` is read from the hidden counter of a loop."""
        each = self.home[operand][1] if operand in self.home else None
        return each is not None and each.opcode == "load" and ".iteration" in each.operands[0]

    def _store(self, each: Instruction, label: str) -> Iterator[TreeStatement]:
        value, target = each.operands
        if self.is_hidden(target) and target in self.home and self.home[target][1].opcode == "alloca":
            return
        if target in self.extremes:
            return
        if target in self.choices:
            yield TreeStatement(self.expr(value, label), Expr("register"), each.line)
        elif self.home[target][1].opcode == "alloca":
            if not self.is_counter(value) and value not in self.routine.parameters:
                yield TreeStatement(self.expr(value, label), self._variable(target), each.line)
        else:
            element = self._element(self.home[target][1], each, label)
            yield TreeStatement(self.expr(value, label), element, each.line)

    def _variable(self, slot: str) -> Expr:
        if slot in self.choices:
            return self.extremes.get(slot, Expr("register", name=slot))
        return Expr("decided" if self.is_hidden(slot) else "local", name=slot, bits=self.home[slot][1].bits)

    def _element(self, address: Instruction, access: Instruction, label: str) -> Expr:
        (array, index), bits = address.operands[-2:], access.bits
        unsigned = self.extensions.get(array, bits == BYTE)  # if only stored: bytes are pixels
        return Expr(
            "load", (self.expr(index, label),), name=array[1:], bits=bits, unsigned=unsigned, access=access
        )

    def _value(self, each: Instruction) -> Expr:
        label = self.home[each.result or ""][0]
        if each.opcode == "load":
            place = self.home[each.operands[0]][1]
            if place.opcode == "alloca":
                return self._variable(each.operands[0])
            return self._element(place, each, label)
        if each.is_call:
            return self._call(each, label)
        if self._is_corrected(each):
            return self.expr(each.operands[0], label)
        if each.opcode == "trunc" and " i64 " in each.text:
            is_lower = self.home[each.operands[0]][1].opcode == "load"
            return Expr("word", name="lower" if is_lower else "upper")
        bound = each.opcode == "icmp" and base(label) == "for"
        args = tuple(self.expr(operand, None if bound else label) for operand in each.operands)
        if each.opcode == "icmp":
            return compare(each.text.split()[1], *args)
        if each.opcode in ("zext", "sext"):
            return Expr("widen", args, bits=each.bits, unsigned=each.opcode == "zext")
        if each.opcode == "trunc":
            return Expr("narrow", args, bits=int(each.text.rsplit(" i", 1)[1]))
        if each.opcode == "call":
            return _operation(each, args)
        return self._arithmetic(each, *args)

    def _call(self, each: Instruction, label: str) -> Expr:
        """A call of another kernel; C passes arrays without their lengths."""
        given = (operand for operand in each.operands if not operand.endswith(".len"))
        return Expr("call", tuple(self.expr(operand, label) for operand in given))

    def _is_corrected(self, each: Instruction) -> bool:
        """Whether `each` corrects a quotient or remainder from rounding towards zero to rounding down."""
        if each.opcode not in ("add", "sub") or each.operands[1] not in self.home:
            return False
        other = self.home[each.operands[1]][1]
        return other.opcode == "select" or (other.opcode == "zext" and " i1 " in other.text)

    def _arithmetic(self, each: Instruction, left: Expr, right: Expr) -> Expr:
        operands = each.operands
        if each.opcode in ("shl", "lshr", "ashr") and operands[1] in self.home:
            count = self.home[operands[1]][1]
            if COUNTS in (count.result or ""):
                right = self.expr(count.operands[0], self.home[operands[1]][0])
        if each.opcode == "xor" and right == const(1) and " i1 " in each.text:
            return Expr("not", (left,))
        return simplified(ARITHMETIC[each.opcode], left, right, unsigned=each.opcode in UNSIGNED)


def _operation(call: Instruction, args: tuple[Expr, ...]) -> Expr:
    """An operation that LLVM, or the kernel language, writes as a call."""
    if (intrinsic := call.intrinsic) is not None:
        return Expr("intrinsic", args, name=intrinsic.name)
    found = next(INTRINSICS[name] for name in INTRINSICS if f"@llvm.{name}." in call.text)
    return Expr(found, args[:1] if found == "abs" else args)
