"""Decisions: comparisons, conditions, and choices without a branch."""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel import operations
from bfsim.kernel.estimate.choices.if_conversion import ConversionKind, ConvertedIf
from bfsim.kernel.estimate.choices.narrow_choices import CHOSEN
from bfsim.kernel.estimate.conditions.joined_tests import Range
from bfsim.kernel.estimate.selection.emitter import Emitter
from bfsim.kernel.estimate.selection.machine_code import RegisterBank
from bfsim.kernel.estimate.selection.narrow_bits import is_masked_for_test
from bfsim.kernel.ir.control_flow import BEFORE_TESTS
from bfsim.kernel.ir.loads_along import goes_along
from bfsim.kernel.ir.text import INVERTED, Instruction, arms_of, is_number, predicate
from bfsim.kernel.ir.widths import BYTE, WORD
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule

ANY, DATA = RegisterBank.ANY, RegisterBank.DATA
SIGNS = {("slt", "0"), ("sgt", "-1")}
"""Tests of a sign, which is a shift."""


class Decisions:
    """Comparisons, and what is chosen or told by them."""

    def __init__(self, emitter: Emitter) -> None:
        self.emitter, self.append = emitter, emitter.append
        self.context, self.flow = emitter.context, emitter.context.flow
        self._extended = set[str]()
        """Masks that have been extended to be compared."""

    def compare(self, each: Instruction) -> None:
        if (masked := self.context.folding.bit_tested(each)) is not None:
            if self._is_masked(each.operands[0]) and self._decides_way(each):
                self.append(Op.ALU, each, None, DATA, (masked, DATA))
            self.append(Op.BIT_TEST, each, None, DATA, (masked, DATA))
            return
        if (joined := self.context.ranges.get(self.emitter.label)) is not None and _decides(
            self.flow.blocks[self.emitter.label].terminator, each
        ):
            if self.emitter.label == joined.first:
                self._in_range(each, joined)
            return
        values = self.context.folding.compared_difference(each) or each.operands[:2]
        left, right = (self._compared(each, value) for value in values)
        if is_number(right) and _is_near(_relation(each), _unsigned(each, int(right))):
            self.append(Op.COMPARE, each, None, DATA, (left, ANY))
        elif is_number(right) and self.context.profile.applies(Rule.COMPARED):
            bound = self.emitter.load_bound(each, right)
            self.append(Op.COMPARE, each, None, DATA, (left, ANY), (bound, ANY))
        else:
            self.append(Op.COMPARE, each, None, DATA, (left, ANY), (right, ANY))

    def _is_masked(self, value: str) -> bool:
        """Whether a mask of a narrow value is done by itself, for tests alone."""
        made = self.flow.instruction(value)
        applies = self.context.profile.applies(Rule.NARROW_BITS)
        return applies and made is not None and is_masked_for_test(self.flow, made)

    def _is_hoisted(self, value: str) -> bool:
        """Whether a value was loaded before a test that comes before this block."""
        return value.endswith(BEFORE_TESTS) and self.flow.defined[value][0] != self.emitter.label

    def _decides_way(self, test: Instruction) -> bool:
        """Whether a test decides where to go: one that is itself what is wanted, or chooses between 0 and 1, is a bit that is shifted."""
        ways = [
            block.successors
            for block in self.flow.blocks.values()
            if block.terminator.operands[:1] == (test.result,)
        ]
        return any(not any(map(self._gives_truth, each)) for each in ways)

    def _gives_truth(self, label: str) -> bool:
        """Whether a choice is made on the way to a block, unless it is one of other numbers than 0 and 1."""
        choices = [each for each in self.flow.blocks[label].instructions if each.opcode == "phi"]
        numbers = {value for each in choices for value in arms_of(each).values() if is_number(value)}
        return label.startswith(CHOSEN) and numbers <= {"0", "1"}

    def _compared(self, each: Instruction, value: str) -> str:
        """What is compared of a value: one that goes along or was loaded before a test is extended each time, what a mask leaves of one once."""
        made = self.flow.instruction(value)
        if made is None or made.bits >= WORD:
            return value
        is_mask = self._is_masked(value)
        if not (is_mask or goes_along(self.flow, value) or self._is_hoisted(value)):
            return value
        if not is_mask or value not in self._extended:
            self.append(Op.EXTEND, each, f"{value}.compared", DATA, (value, DATA))
            self._extended.add(value)
        return f"{value}.compared"

    def _in_range(self, each: Instruction, tested: Range) -> None:
        """The distance from the lower end, compared as an unsigned number."""
        value, distance, length = tested.value, f"{each.result}.distance", tested.high - tested.low
        if -tested.low in operations.ADD_IMMEDIATE and tested.low:
            self.append(Op.ALU, each, distance, ANY, (value, ANY), overwrites=(value,))
        elif tested.low:
            self.append(Op.ALU, each, distance, ANY, (value, ANY), (f"#{-tested.low}", ANY))
        value = distance if tested.low else value
        if length in operations.COMPARE_UNSIGNED_IMMEDIATE:
            self.append(Op.COMPARE, each, None, DATA, (value, ANY))
        else:
            bound = self.emitter.load_bound(each, str(length))
            self.append(Op.COMPARE, each, None, DATA, (value, ANY), (bound, ANY))

    def choose(self, each: Instruction) -> None:
        """A select that LLVM itself formed."""
        if each.text.split(",")[1].strip().startswith("i1"):
            self.joined(each)
        else:
            yes, no = each.operands[1:3]
            self.append(
                Op.COND_MOVE, each, each.result, ANY, (yes, ANY), (no, ANY), overwrites=self._either(yes, no)
            )

    def joined(self, each: Instruction) -> None:
        """`and` or `or` of two conditions: in C, a branch of its own."""
        if all(user.opcode == "br" for user in self.flow.users.get(each.result or "", [])):
            self.append(Op.BRANCH_NOT_TAKEN, each, None, DATA)
        else:
            self.append(Op.CC_MOVE, each, each.result, DATA)
            self.append(Op.ALU, each, each.result, DATA)

    def differ(self, each: Instruction) -> None:
        """Whether two conditions differ: both are moved to registers, which are compared, or one of them is inverted."""
        if each.operands[1] == "true":
            return
        flags = [f"{each.result}.{number}" for number in range(2)]
        for flag in flags:
            self.append(Op.CC_MOVE, each, flag, DATA)
        converted = self.context.if_conversion.by_label.get(self.emitter.label)
        if converted is not None and converted.kind is ConversionKind.FLAG:
            return  # the difference is the flag
        decides = all(user.opcode == "br" for user in self.flow.users.get(each.result or "", []))
        uses = ((flag, DATA) for flag in flags)
        self.append(Op.COMPARE if decides else Op.ALU, each, None if decides else each.result, DATA, *uses)

    def converted(self, each: Instruction, conversion: ConvertedIf) -> None:
        """An `if` without a branch: its operation stands in the block that tests."""
        result = self.context.converted(conversion)
        if conversion.kind is ConversionKind.ABSOLUTE:
            self.append(Op.DSP_ALU, each, result, DATA, (conversion.operands[0], DATA))
            if self.context.folding.products.is_short_factor(conversion.operands[0]):
                self.append(Op.EXTEND, each, result, DATA, (result, DATA))
        elif conversion.kind is ConversionKind.EXTREME:
            operands = conversion.operands
            if each.bits == BYTE:  # there is an instruction for half-words [smaxhi3 in bfin.md]
                operands = tuple(self._compared(each, value) for value in operands)
            self.append(Op.DSP_ALU, each, result, DATA, *((value, DATA) for value in operands))
        elif conversion.kind is ConversionKind.CLAMP:
            *inner, bound = conversion.operands
            self.append(Op.DSP_ALU, each, f"{result}.inner", DATA, *((value, DATA) for value in inner))
            self.append(Op.DSP_ALU, each, result, DATA, (f"{result}.inner", DATA), (bound, DATA))
        elif conversion.kind is ConversionKind.FLAG:
            self._flag(each, result, conversion)
        elif conversion.kind is ConversionKind.SHIFTED_FLAG:
            self._flag(each, f"{result}.flag", conversion)
            op = Op.ALU if "-1" in conversion.operands else Op.SHIFT
            self.append(op, each, result, DATA, (f"{result}.flag", DATA))
        else:
            if conversion is not self.context.if_conversion.by_label[conversion.label]:
                self._test_again()
            uses = tuple((value, ANY) for value in conversion.operands)
            over = self._either(*conversion.operands)
            self.append(Op.COND_MOVE, each, result, ANY, *uses, overwrites=over)

    def _flag(self, each: Instruction, result: str, conversion: ConvertedIf) -> None:
        """The condition as 0 or 1: what no comparison says is the opposite of what one does [cstoresi4 in bfin.md]."""
        test = self.flow.instruction(self.flow.blocks[conversion.label].terminator.operands[0])
        if test is not None and test.opcode == "xor" and test.operands[1] != "true":
            flags = ((f"{test.result}.{number}", DATA) for number in range(2))
            self.append(Op.ALU, each, result, DATA, *flags)
        else:
            self.append(Op.CC_MOVE, each, result, DATA)
        tells = test is not None and test.opcode == "icmp" and conversion.label not in self.context.ranges
        if test is None or not tells or not self.context.profile.applies(Rule.OPPOSITE_FLAGS):
            return
        relation = predicate(test) if conversion.operands[1] == "0" else INVERTED[predicate(test)]
        if self.context.folding.bit_tested(test) is not None:
            is_opposite = relation == "eq"
        elif is_number(test.operands[1]):
            is_opposite = (
                relation[1:] in ("gt", "ge") and (predicate(test), test.operands[1]) not in SIGNS
            ) or (relation == "ne" and conversion.kind is ConversionKind.FLAG and conversion.phi.bits < WORD)
        else:
            is_opposite = relation == "ne"
        if is_opposite:
            self.append(Op.ALU, each, result, DATA, (result, DATA), overwrites=(result,))

    def _test_again(self) -> None:
        """Each of several conditional moves has a comparison of its own [noce_emit_cmove in ifcvt.cc]."""
        tests = [
            each
            for each in self.emitter.code.of.get(self.emitter.label, ())
            if each.op in (Op.COMPARE, Op.BIT_TEST)
        ]
        for each in tests[-1:]:
            self.emitter.code.add(self.emitter.label, replace(each))

    def _either(self, yes: str, no: str) -> tuple[str, ...]:
        """What a conditional move may overwrite: to GCC, either operand."""
        return (yes, no) if self.context.profile.applies(Rule.CONDITIONAL_MOVES) else (no,)


def _decides(branch: Instruction, test: Instruction) -> bool:
    return branch.operands[:1] == (test.result,)


def _unsigned(test: Instruction, bound: int) -> int:
    """Return the number that a byte is tested to equal; LLVM writes 255 as -1. [assumed] that bytes are unsigned, as those of pictures are."""
    is_byte = test.text.split()[2] == f"i{BYTE}" and predicate(test) in ("eq", "ne")
    return bound % (1 << BYTE) if is_byte else bound


def _relation(test: Instruction) -> str:
    """Return the relation that the source asks for: LLVM makes unsigned ones of words that are never negative.

    In code that was inlined, the number may be another one in C: LLVM divides both sides by a factor that an argument has.
    """
    relation, is_inlined = predicate(test), bool(test.line.site)
    is_signed = "samesign" in test.text and relation not in ("eq", "ne") and not is_inlined
    return f"s{relation[1:]}" if is_signed else relation


def _is_near(relation: str, bound: int) -> bool:
    """Whether a comparison takes its bound as an immediate; x < 4 may be written x <= 3."""
    if relation in ("eq", "ne"):
        return bound in operations.COMPARE_IMMEDIATE
    allowed = operations.COMPARE_UNSIGNED_IMMEDIATE if relation[0] == "u" else operations.COMPARE_IMMEDIATE
    other = bound - 1 if relation.endswith(("lt", "ge")) else bound + 1
    return bound in allowed or other in allowed
