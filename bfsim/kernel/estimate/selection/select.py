"""Optimised IR → Blackfin operations: one rule per kind of instruction.

Each rule says what a C compiler emits for an instruction in its surroundings; what nothing needs is not emitted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from bfsim.kernel import operations
from bfsim.kernel.estimate.arithmetic.multiples import multiple
from bfsim.kernel.estimate.choices.if_conversion import ConversionKind, ConvertedIf
from bfsim.kernel.estimate.conditions.joined_tests import Range
from bfsim.kernel.estimate.loops.idioms import counting_ops
from bfsim.kernel.estimate.selection.accesses import Accesses
from bfsim.kernel.estimate.selection.constants import load_constant
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode, MachineInstruction, RegisterBank
from bfsim.kernel.ir.text import INVERTED, Instruction, is_number, predicate
from bfsim.kernel.ir.widths import WORD
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule

ANY, DATA, POINTER = RegisterBank.ANY, RegisterBank.DATA, RegisterBank.POINTER
SIGNS = {("slt", "0"), ("sgt", "-1")}
"""Tests of a sign, which is a shift."""
EXTENDING_MASKS = {"255": 8, "65535": 16}


def select(context: Context) -> MachineCode:
    """Return the operations of every block of a routine."""
    selector = _Selector(context)
    for loop in context.bit_counts.values():
        line = context.flow.blocks[loop.header].instructions[-1].line
        for op in counting_ops(context.flow, loop):
            selector.code.add(context.flow.entering(loop), MachineInstruction(op, line, None, DATA))
    for loop in context.fills.values():
        selector.fill(loop)
    for label in context.flow.order:
        if label in context.replaced:
            continue
        selector.counters(label)
        for each in context.flow.blocks[label].instructions:
            if context.demanded.emits(each):
                selector.emit(each, context.code_motion.of.get(each.result or "", label))
    selector.pointers()
    if context.profile.applies(Rule.NARROW_TREES):
        for label, block in selector.code.of.items():
            selector.code.of[label] = _extended_where_used(block)
    return selector.code


def _extended_where_used(block: list[MachineInstruction]) -> list[MachineInstruction]:
    """A narrow value that is used as it is, too, is extended right before the first use that wants it wide [TER in tree-ssa-ter.cc]."""
    wanted = {name for each in block for name, _ in each.uses}
    found: list[MachineInstruction] = []
    waiting: dict[str, MachineInstruction] = {}
    for each in block:
        found += [waiting.pop(name) for name, _ in each.uses if name in waiting]
        if each.op is Op.EXTEND and each.result and each.result.endswith(".wide") and each.result in wanted:
            waiting[each.result] = each
        else:
            found.append(each)
    return found


class _Selector(Accesses):
    def emit(self, each: Instruction, label: str) -> None:
        """Append the operations of one instruction to the block where it is computed."""
        self.label = label
        if each.opcode == "phi":
            for conversion in self.context.conversions_of(each):
                self.label = conversion.label
                self._converted(each, conversion)
            if self.context.folding.sunk_mask(each):
                self.append(Op.EXTEND, each, None, DATA, (each.result or "", DATA))
            return
        rule = RULES.get(each.opcode)
        if rule is not None:
            rule(self, each)

    # Arithmetic

    def add(self, each: Instruction) -> None:
        if self.context.folding.in_shifted_sum(each):
            return
        if (product := self.context.folding.accumulates(each)) is not None:
            sum_before = next(operand for operand in each.operands if operand != product.result)
            factors = ((operand, DATA) for operand in product.operands[:2])
            self.append(Op.MAC, each, each.result, DATA, (sum_before, DATA), *factors)
            return
        if (plan := self.context.folding.shift_add(each)) is not None:
            shifted, other = plan
            self.append(Op.ADD_SHIFT, each, each.result, POINTER, (other, POINTER), (shifted, POINTER))
            return
        if (division := self.context.folding.remainder(each)) is not None:
            rest = replace(each, opcode=division.opcode.replace("div", "rem"), operands=division.operands)
            self.divide(rest)
            return
        left, right = each.operands[:2]
        if (total := self.context.folding.added_flag(each)) is not None:
            self.append(Op.ALU, each, each.result, ANY, (total, ANY))
            return
        if self.context.narrow.narrowed(each):
            self.append(Op.MOVE, each, None, DATA)
            self.append(Op.ALU, each, None, DATA, (left, DATA))
        if is_number(right) and int(right) in operations.ADD_IMMEDIATE and each.opcode == "add":
            self.append(Op.ALU, each, each.result, ANY, (left, ANY), overwrites=(left,))
        elif each.opcode == "sub" and left == "0":
            self.append(Op.ALU, each, each.result, DATA, (right, DATA))
        else:
            self.append(Op.ALU, each, each.result, ANY, (left, ANY), (right, ANY))

    def shift(self, each: Instruction) -> None:
        if self.context.is_alias(each):
            return
        if self.context.folding.in_shift_add(each) or self._is_half_extension(each):
            return
        if (word := self.context.folding.counted_bits(each)) is not None:
            self.append(Op.ALU, each, each.result, DATA, (word, DATA))
            self.append(Op.EXTEND, each, each.result, DATA, (each.result or "", DATA))
            return
        value, amount = each.operands[:2]
        if (pair := self.context.folding.shifted_sum(each)) is not None:
            self.append(Op.ADD_SHIFT, each, each.result, ANY, (pair[0], ANY), (pair[1], ANY), overwrites=pair)
        elif each.opcode == "ashr" and (source := self.context.folding.extension_of(each)):
            self.append(Op.EXTEND, each, each.result, DATA, (source, DATA))
        elif amount.isdigit():
            near = int(amount) in operations.ADDRESS_SHIFTS and each.opcode != "ashr"
            kept = len(self.flow.users.get(value, [])) > 1  # three operands take the long form
            where = ANY if near else DATA
            nbytes = operations.LONG_FORM_BYTES if kept else None
            self.append(Op.SHIFT, each, each.result, where, (value, where), nbytes=nbytes)
        else:
            self.append(Op.SHIFT, each, each.result, DATA, (value, DATA), (amount, DATA), overwrites=(value,))

    def _is_half_extension(self, each: Instruction) -> bool:
        users = self.flow.users.get(each.result or "", [])
        return each.opcode == "shl" and bool(users) and all(
            self.context.folding.extension_of(user) == each.operands[0] for user in users
        )  # fmt: skip

    def logic(self, each: Instruction) -> None:
        left, right = each.operands[:2]
        folding = self.context.folding
        if each.bits == 1:
            (self._differ if each.opcode == "xor" else self._joined)(each)
            return
        if folding.in_bit_test(each) or folding.is_shift_mask(each) or folding.in_sunk_mask(each):
            return
        if each.opcode == "and" and right in EXTENDING_MASKS:
            self.append(Op.EXTEND, each, each.result, DATA, (left, DATA))
        elif self._is_single_bit(each.opcode, right):
            self.append(Op.ALU, each, each.result, DATA, (left, DATA), overwrites=(left,))
        else:
            self.append(Op.ALU, each, each.result, DATA, (left, DATA), (right, DATA))

    def _is_single_bit(self, opcode: str, right: str) -> bool:
        """Whether BITSET, BITCLR, BITTGL or NOT does it."""
        if not is_number(right) or not self.context.profile.applies(Rule.SINGLE_BITS):
            return False
        mask = int(right)
        bits = ~mask if opcode == "and" else mask
        return (opcode == "xor" and mask == -1) or (bits & 0xFFFFFFFF).bit_count() == 1

    def multiply(self, each: Instruction) -> None:
        left, right = each.operands[:2]
        if self._steps_along(each) or self.context.folding.accumulated(each) is not None:
            return
        if (
            is_number(right)
            and (plan := multiple(int(right))) is not None
            and (self.context.narrow.in_narrow_tree(each) or not self._short(each))
        ):
            value = left
            for number, op in enumerate(plan):
                result = each.result if number == len(plan) - 1 else f"{each.result}.{number}"
                is_sum = (
                    Op.SHIFT in plan[max(number - 1, 0) : number]
                )  # of (x << 7) + x: its shift is free in either bank
                bank = POINTER if op is Op.ADD_SHIFT and not is_sum else ANY
                self.append(op, each, result, bank, (value, bank), (left, bank))
                value = result or ""
        elif self._short(each) or self.context.narrow.in_narrow_tree(each):
            for factor in dict.fromkeys((left, right)):
                if self.context.narrow.extended_for_product(factor):
                    self.append(Op.EXTEND, each, None, DATA, (factor, DATA))
            self.append(Op.MUL16, each, each.result, DATA, (left, DATA), (right, DATA))
        else:
            self.append(
                Op.MUL32, each, each.result, DATA, (left, DATA), (right, DATA), overwrites=(left, right)
            )

    def _steps_along(self, each: Instruction) -> bool:
        """A product of a counter: an addition per iteration takes its place (strength reduction)."""
        loop, increment = self.flow.innermost(self.label), self.context.demanded.stepped(each)
        if loop is None or increment is None:
            return False
        stride = f"{each.result}.stride"
        self.code.add(self.flow.entering(loop), MachineInstruction(Op.IMM, each.line, each.result, ANY))
        uses = (
            ((each.result or "", ANY), (stride, ANY)) if increment.symbolic else ((each.result or "", ANY),)
        )
        self.code.add(loop.latch, MachineInstruction(Op.ALU, each.line, each.result, ANY, uses))
        return True

    def _short(self, each: Instruction) -> bool:
        return all(self.context.folding.is_short(operand) for operand in each.operands[:2])

    def extend(self, each: Instruction) -> None:
        if " i1 " in each.text:
            self.append(Op.CC_MOVE, each, each.result, DATA)
        elif not self.context.is_alias(each):
            self.append(Op.EXTEND, each, each.result, DATA, (each.operands[0], DATA))

    # Decisions

    def compare(self, each: Instruction) -> None:
        if self.context.folding.bit_tested(each) is not None:
            masked = self.context.folding.bit_tested(each) or ""
            self.append(Op.BIT_TEST, each, None, DATA, (masked, DATA))
            return
        if (joined := self.context.ranges.get(self.label)) is not None and _decides(
            self.flow.blocks[self.label].terminator, each
        ):
            if self.label == joined.first:
                self._in_range(each, joined)
            return
        left, right = self.context.folding.compared(each)
        if is_number(right) and _is_near(predicate(each), int(right)):
            self.append(Op.COMPARE, each, None, DATA, (left, ANY))
        elif is_number(right) and self.context.profile.applies(Rule.COMPARED):
            self.code.add(self.label, load_constant(f"#{right}", each.line, f"{each.result}.bound"))
            self.append(Op.COMPARE, each, None, DATA, (left, ANY), (f"{each.result}.bound", ANY))
        else:
            self.append(Op.COMPARE, each, None, DATA, (left, ANY), (right, ANY))

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
            self.code.add(self.label, load_constant(f"#{length}", each.line, f"{each.result}.bound"))
            self.append(Op.COMPARE, each, None, DATA, (value, ANY), (f"{each.result}.bound", ANY))

    def choose(self, each: Instruction) -> None:
        """A select that LLVM itself formed."""
        if each.text.split(",")[1].strip().startswith("i1"):
            self._joined(each)
        else:
            yes, no = each.operands[1:3]
            self.append(
                Op.COND_MOVE, each, each.result, ANY, (yes, ANY), (no, ANY), overwrites=self._either(yes, no)
            )

    def _joined(self, each: Instruction) -> None:
        """`and` or `or` of two conditions: in C, a branch of its own."""
        if all(user.opcode == "br" for user in self.flow.users.get(each.result or "", [])):
            self.append(Op.BRANCH_NOT_TAKEN, each, None, DATA)
        else:
            self.append(Op.CC_MOVE, each, each.result, DATA)
            self.append(Op.ALU, each, each.result, DATA)

    def _differ(self, each: Instruction) -> None:
        """Whether two conditions differ: both are moved to registers, which are compared, or one of them is inverted."""
        if each.operands[1] == "true":
            return
        flags = [f"{each.result}.{number}" for number in range(2)]
        for flag in flags:
            self.append(Op.CC_MOVE, each, flag, DATA)
        decides = all(user.opcode == "br" for user in self.flow.users.get(each.result or "", []))
        uses = ((flag, DATA) for flag in flags)
        self.append(Op.COMPARE if decides else Op.ALU, each, None if decides else each.result, DATA, *uses)

    def _converted(self, each: Instruction, conversion: ConvertedIf) -> None:
        """An `if` without a branch: its operation stands in the block that tests."""
        result = self.context.converted(conversion)
        if conversion.kind is ConversionKind.ABSOLUTE:
            self.append(Op.DSP_ALU, each, result, DATA, (conversion.operands[0], DATA))
            if self.context.folding.is_short(conversion.operands[0]):
                self.append(Op.EXTEND, each, result, DATA, (result, DATA))
        elif conversion.kind is ConversionKind.EXTREME:
            self.append(Op.DSP_ALU, each, result, DATA, *((value, DATA) for value in conversion.operands))
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
        self.append(Op.CC_MOVE, each, result, DATA)
        test = self.flow.instruction(self.flow.blocks[conversion.label].terminator.operands[0])
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
        tests = [each for each in self.code.of.get(self.label, ()) if each.op in (Op.COMPARE, Op.BIT_TEST)]
        for each in tests[-1:]:
            self.code.add(self.label, replace(each))

    def _either(self, yes: str, no: str) -> tuple[str, ...]:
        """What a conditional move may overwrite: to GCC, either operand."""
        return (yes, no) if self.context.profile.applies(Rule.CONDITIONAL_MOVES) else (no,)


def _decides(branch: Instruction, test: Instruction) -> bool:
    return branch.operands[:1] == (test.result,)


def _is_near(relation: str, bound: int) -> bool:
    """Whether a comparison takes its bound as an immediate; x < 4 may be written x <= 3."""
    if relation in ("eq", "ne"):
        return bound in operations.COMPARE_IMMEDIATE
    allowed = operations.COMPARE_UNSIGNED_IMMEDIATE if relation[0] == "u" else operations.COMPARE_IMMEDIATE
    other = bound - 1 if relation.endswith(("lt", "ge")) else bound + 1
    return bound in allowed or other in allowed


RULES: dict[str, Callable[[_Selector, Instruction], None]] = {
    "load": _Selector.load,
    "store": _Selector.store,
    "getelementptr": _Selector.element,
    "add": _Selector.add,
    "sub": _Selector.add,
    "shl": _Selector.shift,
    "lshr": _Selector.shift,
    "ashr": _Selector.shift,
    "and": _Selector.logic,
    "or": _Selector.logic,
    "xor": _Selector.logic,
    "mul": _Selector.multiply,
    "sext": _Selector.extend,
    "zext": _Selector.extend,
    "icmp": _Selector.compare,
    "select": _Selector.choose,
    "call": _Selector.call,
    "fadd": _Selector.float_operation,
    "fsub": _Selector.float_operation,
    "fmul": _Selector.float_operation,
    "fdiv": _Selector.float_operation,
    "fcmp": _Selector.float_operation,
    "sitofp": _Selector.float_operation,
    "uitofp": _Selector.float_operation,
    "fneg": _Selector.sign,
    "sdiv": _Selector.divide,
    "udiv": _Selector.divide,
    "srem": _Selector.divide,
    "urem": _Selector.divide,
}
