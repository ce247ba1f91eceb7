"""If-conversion: small `if`s that a compiler turns into one operation: minimum, maximum, absolute value, conditional move.

As GCC does it [phiopt and ifcvt.cc of GCC 12]: a branch goes away only if all that its arms do is to choose
between two values that are there already (or to negate one that was tested for its sign).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto

from bfsim.kernel.estimate.choices.conditional_moves import are_conditional_moves, is_conditional_move
from bfsim.kernel.estimate.choices.narrow_choices import is_narrowed, is_of_one_type, stored_bits
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.loads_along import FOLLOWING, goes_along
from bfsim.kernel.ir.text import TRUTHS, Instruction, arms_of, is_number, predicate
from bfsim.kernel.ir.widths import BYTE, WORD, widest
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule

MOVED = ("add", "sub", "shl", "and", "or", "xor")
RENAMING = ("trunc", "zext", "sext", "freeze")


class ConversionKind(Enum):
    """What becomes of a small `if`."""

    ABSOLUTE = auto()
    EXTREME = auto()
    """Minimum or maximum."""
    CLAMP = auto()
    """Minimum and maximum: `if x > most: x = most`, `elif x < least: x = least`."""
    CHOICE = auto()
    """A conditional move."""
    FLAG = auto()
    """The condition itself as 0 or 1."""
    SHIFTED_FLAG = auto()
    """The same as 0 or a power of two, or as 0 or -1."""


STATEMENTS = ("then", "else")
FLAGS = (ConversionKind.FLAG, ConversionKind.SHIFTED_FLAG)


@dataclass(frozen=True, slots=True)
class ConvertedIf:
    """An `if` in block `label` that needs no branch; `phi` is what it computes, from `operands`."""

    kind: ConversionKind
    label: str
    phi: Instruction
    operands: tuple[str, ...]
    arms: frozenset[str]
    """Blocks that vanish."""
    besides: tuple[ConvertedIf, ...] = ()
    """Further conditional moves by the same test, before each of which it is made again."""

    @property
    def all(self) -> Iterator[ConvertedIf]:
        """Itself and those besides."""
        yield self
        yield from self.besides


class IfConversion:
    """The small `if`s of one routine, by the block that tests."""

    def __init__(self, flow: ControlFlow, profile: CompilerProfile) -> None:
        self.flow, self.profile = flow, profile
        self.by_label: dict[str, ConvertedIf] = {}
        for label in flow.order:
            conversion = self._conversion(label)
            if conversion:
                self.by_label[label] = conversion
        for label in flow.order:
            clamp = self._clamp(label)
            if clamp:
                for arm in clamp.arms & self.by_label.keys():
                    del self.by_label[arm]
                self.by_label[label] = clamp
        self.flags = frozenset(each.phi.result for each in self.by_label.values() if each.kind in FLAGS)
        """What is computed from conditions without a branch."""
        self.gone = frozenset(arm for conversion in self.by_label.values() for arm in conversion.arms)

    def _conversion(self, label: str) -> ConvertedIf | None:
        block = self.flow.blocks[label]
        if block.terminator.opcode != "br" or len(set(block.successors)) != 2:
            return None
        yes, no = block.successors
        arms = [way for way in (yes, no) if self._is_arm(way, label)]
        ends = {self.flow.blocks[way].successors[0] if way in arms else way for way in (yes, no)}
        if not arms or len(ends) != 1:
            return None
        join = ends.pop()
        sources = [way if way in arms else label for way in (yes, no)]
        phis = [each for each in self.flow.blocks[join].instructions if each.opcode == "phi"]
        choices: list[tuple[Instruction, str, str]] = []
        for each in phis:
            chosen, other = (self._plain(_arm_value(each, source), each) for source in sources)
            if chosen != other:
                choices.append((each, chosen, other))
        if len(choices) != 1:
            return self._of_choices(label, frozenset(arms), choices)
        return self._of_choice(label, frozenset(arms), *choices[0])

    def _of_choices(
        self, label: str, arms: frozenset[str], choices: Sequence[tuple[Instruction, str, str]]
    ) -> ConvertedIf | None:
        """Conditional moves to several registers [cond_move_process_if_block in ifcvt.cc]."""
        test = self.flow.instruction(self.flow.blocks[label].terminator.operands[0])
        if test is None or test.opcode != "icmp" or not self.profile.applies(Rule.CONDITIONAL_MOVES):
            return None
        if any(self._work(arm) or self._converts(arm, phi) for arm in arms for phi, *_ in choices):
            return None
        bounds = frozenset(self._plain(each) for each in self._bounds(test))
        if not choices or not are_conditional_moves(self.flow, choices, bounds):
            return None
        first, *besides = (
            ConvertedIf(ConversionKind.CHOICE, label, phi, (yes, no), arms) for phi, yes, no in choices
        )
        return replace(first, besides=tuple(besides))

    def _clamp(self, label: str) -> ConvertedIf | None:
        """A minimum of a constant and of a maximum, or the other way round [minmax_replacement in tree-ssa-phiopt.cc]."""
        block = self.flow.blocks[label]
        inner = next((self.by_label[way] for way in block.successors if way in self.by_label), None)
        if (
            inner is None
            or inner.kind is not ConversionKind.EXTREME
            or self.flow.predecessors[inner.label] != [label]
        ):
            return None
        join = self.flow.defined[inner.phi.result or ""][0]
        if set(block.successors) != {inner.label, join}:
            return None
        test = self.flow.instruction(block.terminator.operands[0])
        if test is None or test.opcode != "icmp":
            return None
        bound = self._plain(_arm_value(inner.phi, label), inner.phi)
        value = self._plain(test.operands[0])
        rest = [each for each in self._work(inner.label) if each.opcode != "icmp"]
        if rest or not is_number(bound) or bound not in self._bounds(test) or value not in inner.operands:
            return None
        return ConvertedIf(
            ConversionKind.CLAMP, label, inner.phi, (*inner.operands, bound), inner.arms | {inner.label}
        )

    def _is_arm(self, way: str, label: str) -> bool:
        block = self.flow.blocks[way]
        return (
            self.flow.predecessors[way] == [label]
            and len(set(block.successors)) == 1
            and block.terminator.opcode == "br"
            and not any(each.opcode == "phi" for each in block.instructions)
            and len(self._work(way)) <= 1
        )

    def _work(self, arm: str) -> list[Instruction]:
        """What a block does but for renaming and its branch."""
        return [each for each in self.flow.blocks[arm].instructions[:-1] if each.opcode not in RENAMING]

    def _is_moved(self, arm: str, phi: Instruction) -> bool:
        """Whether all that a side computes is the same in each iteration, and a narrow value: it is done before the loop [move_invariants in loop-invariant.cc].

        Not so where it is computed into the variable that has been limited before: that is a word.
        """
        loop = self.flow.innermost(arm)
        if loop is None or phi.bits >= WORD:
            return False
        limited = (self.flow.instruction(self._plain(value)) for value in phi.operands)
        return all(
            each.opcode in MOVED
            and all(self.flow.is_invariant(self._plain(value), loop) for value in each.operands)
            for each in self._work(arm)
        ) and not any(each is not None and each.is_computation for each in limited)

    def _plain(self, value: str, phi: Instruction | None = None) -> str:
        """The 32-bit value behind one that LLVM has narrowed."""
        if is_number(value):
            narrow = phi is not None and f"phi i{BYTE} " in phi.text + " "
            return str(int(value) & 0xFF) if narrow else value
        each = self.flow.instruction(value)
        while each is not None and each.opcode in RENAMING and " i1 " not in each.text:
            value = each.operands[0]
            each = self.flow.instruction(value)
        return value

    def _of_choice(
        self, label: str, arms: frozenset[str], phi: Instruction, yes: str, no: str
    ) -> ConvertedIf | None:
        work = [each for arm in arms if not self._is_moved(arm, phi) for each in self._work(arm)]
        test = self.flow.instruction(self.flow.blocks[label].terminator.operands[0])
        is_flag = not work and {yes, no} in ({"1", "0"}, {*TRUTHS})
        if test is not None and is_flag and (test.opcode == "icmp" or (test.opcode, test.bits) == ("xor", 1)):
            return ConvertedIf(ConversionKind.FLAG, label, phi, (yes, no), arms)
        if test is None or test.opcode != "icmp":
            return None
        if any(self._converts(arm, phi) for arm in arms):
            return None
        if work:
            return self._negation(label, arms, phi, work, test)
        if "0" in (yes, no) and self._is_bit(no if yes == "0" else yes, phi):
            return ConvertedIf(ConversionKind.SHIFTED_FLAG, label, phi, (yes, no), arms)
        bounds = {self._plain(each) for each in self._bounds(test)}
        of_loads = all(self._is_narrow_load(each) for each in (yes, no))
        if of_loads and stored_bits(self.flow, phi) < WORD:
            bits = stored_bits(self.flow, phi)
            of_loads = test.bits == bits or is_of_one_type(self.flow, test.operands, bits)
        narrows = self.profile.applies(Rule.NARROW_CHOICES)
        is_extreme = {yes, no} <= bounds and (of_loads or not (narrows and is_narrowed(self.flow, phi)))
        unsigned = predicate(test)[0] == "u"
        of_bytes = narrows and of_loads and unsigned
        if is_extreme and not of_bytes and (predicate(test)[0] == "s" or self._is_positive(test)):
            return ConvertedIf(ConversionKind.EXTREME, label, phi, (yes, no), arms)
        stays_narrow = stored_bits(self.flow, phi) < WORD or (phi.result or "").endswith(FOLLOWING)
        is_unsigned_extreme = is_extreme and unsigned and (not of_bytes or stays_narrow)
        moves = (
            not self.profile.applies(Rule.CONDITIONAL_MOVES)
            or is_unsigned_extreme
            or is_conditional_move(self.flow, phi, (yes, no), frozenset(bounds))
        )
        return ConvertedIf(ConversionKind.CHOICE, label, phi, (yes, no), arms) if moves else None

    def _is_bit(self, value: str, phi: Instruction) -> bool:
        """Whether a value is a number of a single bit, or of all of them ["a ? powerof2cst : 0" and "a ? -1 : 0" in match.pd]."""
        if not is_number(value):
            return False
        all_of_byte = (1 << phi.bits) - 1 if self.profile.applies(Rule.OPPOSITE_FLAGS) else -1
        number = int(value)
        return number in (-1, all_of_byte) or (number > 0 and number & (number - 1) == 0)

    def _converts(self, arm: str, phi: Instruction) -> bool:
        """Whether a side that stores a word as narrow has to extend what is left of it: GCC promotes the choice to a word [PROMOTE_MODE in bfin.h].

        A word that does not change in a loop was extended before it.
        """
        loop = self.flow.innermost(arm)
        for each in self.flow.blocks[arm].instructions if arm.startswith(STATEMENTS) else ():
            is_chosen = each.opcode == "trunc" and each.result in phi.operands
            if is_chosen and widest(self.flow, each.operands[0]) > phi.bits:
                return loop is None or not self.flow.is_invariant(each.operands[0], loop)
        return False

    def _is_narrow_load(self, value: str) -> bool:
        each = self.flow.instruction(value)
        return (
            each is not None and (each.opcode == "load" or goes_along(self.flow, value)) and each.bits < WORD
        )

    def _bounds(self, test: Instruction) -> tuple[str, ...]:
        """What a comparison with a constant bounds, by values that are there before it: LLVM writes x <= 255 as x < 256."""
        tested, bound = test.operands
        if not is_number(bound):
            return test.operands
        return (tested, *(str(int(bound) + beside) for beside in (-1, 0, 1)))

    def _is_positive(self, test: Instruction) -> bool:
        """Whether an unsigned comparison is as good as a signed one: LLVM makes them of values that are never negative."""
        if predicate(test)[0] != "u":
            return False
        source = self.flow.instruction(self._plain(test.operands[0]))
        return "samesign" in test.text or test.bits < WORD or (source is not None and source.bits < WORD)

    def _negation(
        self, label: str, arms: frozenset[str], phi: Instruction, work: list[Instruction], test: Instruction
    ) -> ConvertedIf | None:
        if len(work) != 1 or work[0].opcode != "sub" or work[0].operands[0] != "0":
            return None
        if self.profile.applies(Rule.NARROW_CHOICES) and is_narrowed(self.flow, phi):
            return None  # what is negated is narrow, and what is tested is a word
        value = work[0].operands[1]
        difference = self.flow.instruction(self._plain(value))
        written_as_if = any(arm.startswith("then") for arm in arms)
        branches = written_as_if and self.profile.applies(Rule.DIFFERENCE)
        if branches and difference is not None and difference.opcode == "sub":
            return None  # -(x - y) has become y - x before anyone looks for an absolute value
        tested = self._plain(test.operands[0]) == self._plain(value)
        chosen = value in phi.operands and work[0].result in phi.operands
        by_sign = predicate(test) in ("slt", "sgt", "sle", "sge") and test.operands[1] in ("0", "-1", "1")
        return (
            ConvertedIf(ConversionKind.ABSOLUTE, label, phi, (value, value), arms)
            if chosen and tested and by_sign
            else None
        )


def _arm_value(phi: Instruction, source: str) -> str:
    values = arms_of(phi)
    return values[source]
