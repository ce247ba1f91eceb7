"""The analyses that the lowering of one routine needs, made once."""

from __future__ import annotations

from functools import cached_property

from bfsim.kernel.estimate.choices.if_conversion import ConvertedIf, IfConversion
from bfsim.kernel.estimate.conditions.joined_tests import ranges
from bfsim.kernel.estimate.induction_variables.field_addresses import FieldAddresses
from bfsim.kernel.estimate.induction_variables.induction_variables import HIDDEN, InductionVariables
from bfsim.kernel.estimate.jump_threading.flags import JumpThreading
from bfsim.kernel.estimate.loops.bit_counts import bit_counting_loops
from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.memory_calls import memory_calls
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.estimate.memory.predictive_commoning import ALONG
from bfsim.kernel.estimate.prediction.predict import Likelihood
from bfsim.kernel.estimate.selection.demanded_values import DemandedValues
from bfsim.kernel.estimate.selection.folding import Folding
from bfsim.kernel.estimate.selection.library_divisions import LibraryDivisions
from bfsim.kernel.estimate.selection.loop_counters import LoopCounters
from bfsim.kernel.estimate.selection.narrow_bits import is_joined_before
from bfsim.kernel.estimate.selection.narrow_values import NarrowValues
from bfsim.kernel.estimate.selection.tail_calls import TailCall, tail_calls
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, each_arm
from bfsim.kernel.ir.widths import PAIR, widest
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule


class Context:
    """Analyses of one routine."""

    def __init__(self, routine: Routine, profile: CompilerProfile) -> None:
        self.routine, self.profile = routine, profile
        self.flow = ControlFlow(routine, joins_split=profile.applies(Rule.SPLIT_LOOPS))
        self.jump_threading = JumpThreading(self.flow)
        for loop in self.flow.loops if profile.applies(Rule.THREADED_EXITS) else ():
            loop.leaving = frozenset(self.jump_threading.leaving(loop))
            loop.blocks -= loop.leaving
        self.code_motion = InvariantCodeMotion(self.flow)
        evaluates = profile.applies(Rule.EVALUATED_LOOPS)
        self.evolution = ScalarEvolution(self.flow, self.code_motion, evaluates=evaluates)
        for loop in self.flow.loops:
            loop.counting = self.evolution.counting_exit(loop)
        self.if_conversion = IfConversion(self.flow, profile)
        converted = frozenset({*self.if_conversion.by_label, *self.if_conversion.gone})
        self.ranges = ranges(self.flow, converted, neighbours=profile.applies(Rule.NEIGHBOURS))
        self.second_parts = {each.second: each.inside for each in self.ranges.values()}
        """Blocks whose test is part of the previous one, and where they lead if both hold."""
        self.likelihood = Likelihood(self.flow, self.second_parts, profile.without)
        self.induction_variables = InductionVariables(self.flow, self.evolution, profile)
        has_fields = profile.applies(Rule.FIELD_ADDRESSES)
        self.fields = FieldAddresses(self.flow, self.induction_variables) if has_fields else None
        counts_bits = profile.applies(Rule.BIT_COUNTS)
        self.bit_counts = bit_counting_loops(self.flow, self.evolution) if counts_bits else {}
        self.memory_calls = memory_calls(self.flow, self.evolution, profile.library)
        self.folding = Folding(self.flow, profile, self.if_conversion.flags)
        self.divisions = LibraryDivisions(self.flow, profile)
        self.counters = LoopCounters(
            self.evolution,
            self.induction_variables,
            self.divisions,
            frozenset(
                self.flow.entering(call.nest) if call.nest else header
                for header, calls in self.memory_calls.items()
                for call in calls
                if not call.is_inline
            ),
            self.likelihood.frequency,
        )
        self.demanded = DemandedValues(
            self.evolution,
            self.if_conversion,
            self.induction_variables,
            self.jump_threading,
            self.folding,
            self.counters,
        )
        self.narrow = NarrowValues(self.folding, self.induction_variables, self.counters, self.demanded.emits)
        self.replaced = frozenset({*self.bit_counts, *self.memory_calls})
        """Loops of one block that become an operation or a call."""

    @cached_property
    def tail_calls(self) -> dict[str, TailCall]:
        """Calls that become jumps, by the labels of their blocks."""
        return tail_calls(self.flow, self.arguments, len(self.parameters()), self.memory_calls)

    def is_kept(self, block: BasicBlock) -> bool:
        """Whether the condition at the end of a block was computed before the loop: a register keeps it, and CC gets it back."""
        if block.terminator.opcode != "br" or not block.terminator.operands:
            return False
        condition = block.terminator.operands[0]
        moved = self.code_motion.of.get(condition, block.label) != block.label
        tested = self.flow.innermost(block.label)
        hoisted = moved and tested is not None and self.code_motion.is_invariant(condition, tested)
        return (
            hoisted and self.profile.applies(Rule.GUARDS) and block.label not in self.if_conversion.by_label
        )

    def tests_flag(self, block: BasicBlock) -> bool:
        """Whether the branch at the end of a block tests a flag in a register, 0 or 1, such as one that the previous iteration has set."""
        flag = self.flow.instruction(block.terminator.operands[0])
        return flag is not None and flag.opcode == "phi" and not self.conversions_of(flag)

    @cached_property
    def _conversions_by_phi(self) -> dict[str, list[ConvertedIf]]:
        found: dict[str, list[ConvertedIf]] = {}
        for first in self.if_conversion.by_label.values():
            for conversion in first.all:
                found.setdefault(conversion.phi.result or "", []).append(conversion)
        return found

    def conversions_of(self, phi: Instruction) -> list[ConvertedIf]:
        """The branchless `if`s that compute a phi, each on its own edges."""
        return self._conversions_by_phi.get(phi.result or "", [])

    def others(self, phi: Instruction) -> list[tuple[str, str]]:
        """Arms of a phi that do not come from a branchless `if` that computes it."""
        own = {label for each in self.conversions_of(phi) for label in (each.label, *each.arms)}
        return [(value, label) for value, label in each_arm(phi) if label not in own]

    def converted(self, conversion: ConvertedIf) -> str:
        """Name of the result of a branchless `if`: a separate value if other edges also lead to the phi."""
        phi = conversion.phi
        is_alone = not self.others(phi) and len(self.conversions_of(phi)) == 1
        return phi.result or "" if is_alone else f"{phi.result}.converted.{conversion.label}"

    def is_alias(self, each: Instruction) -> bool:
        """Whether an instruction only renames a register: narrowing, or widening a value that a load has extended, or a flag in a register."""
        if each.opcode in ("trunc", "freeze") or (each.opcode == "lshr" and each.bits == PAIR):
            return True
        if each.opcode == "zext" and " i1 " in each.text:
            flag = self.flow.instruction(each.operands[0])
            return flag is not None and flag.opcode == "phi"
        if each.opcode not in ("sext", "zext") or " i1 " in each.text:
            return False
        if self.folding.products.does_extension(each):
            return True
        return self._is_clean(each.operands[0]) and not self.is_extended_late(each)

    def _is_clean(self, narrow: str, depth: int = 8) -> bool:
        """Whether the register of a narrow value already holds it extended: all its operands are, and nothing overflows."""
        each = self.flow.instruction(narrow)
        if each is None or each.opcode == "load" or depth == 0:
            return True
        if ALONG in narrow:
            return False
        if each.opcode in ("add", "sub", "mul", "shl") and not {"nuw", "nsw"} & set(each.text.split()):
            return False
        if each.opcode == "and":
            return any(self._is_clean(operand, depth - 1) for operand in each.operands)
        if each.opcode == "trunc":
            keeps = widest(self.flow, each.operands[0]) <= int(each.text.rsplit("i", 1)[1])
            return keeps and self.profile.applies(Rule.KEPT_BITS)
        if each.opcode == "call":
            return False
        return all(self._is_clean(operand, depth - 1) for operand in each.operands)

    def is_extended_late(self, extension: Instruction) -> bool:
        """Whether the extended value was masked, or joined bit by bit, before the extension (`narrow_bits`)."""
        return self.profile.applies(Rule.NARROW_BITS) and is_joined_before(self.flow, extension)

    def name(self, value: str) -> str:
        """The register that holds `value`; constants are written #5."""
        if not value.startswith(("%", "@")):
            return f"#{value}"
        value = self.code_motion.same.get(value, value)
        if value in self.counters.eliminated:
            return self.counters.eliminated[value].name
        each = self.flow.instruction(value)
        if each is not None and self.folding.in_sunk_mask(each):
            return self.name(each.operands[0])
        if each is not None and self.is_alias(each):
            source = self.flow.instruction(each.operands[0])
            if source is not None and source.opcode == "load" and self.narrow.extended_apart(source):
                return f"{source.result}.wide"
            return self.name(each.operands[0])
        return value

    def chosen(self, phi: Instruction, value: str) -> str:
        """The register of a phi's operand: for a narrow load that is extended separately, that of the word."""
        load = self.flow.instruction(value)
        is_word = load is not None and ALONG not in (phi.result or "") and self.narrow.extended_apart(load)
        return f"{value}.wide" if is_word else self.name(value)

    def base(self, pointer: str) -> str:
        """The pointer behind constant offsets, as far as an access has them."""
        each, own = self.flow.instruction(pointer), self.fields.own if self.fields else ()
        while (
            each is not None
            and each.opcode == "getelementptr"
            and not each.operands[-1].startswith("%")
            and pointer not in own
        ):
            pointer = each.operands[0]
            each = self.flow.instruction(pointer)
        return pointer

    def arguments(self, call: Instruction) -> list[str]:
        """The arguments that C code would pass: without the lengths that follow the arrays."""
        inside = call.text[call.text.index("(") + 1 : call.text.rindex(")")].split(",")
        values = [part.split() for part in inside if part.strip()]
        kept = []
        for before, part in zip([["i32"], *values], values, strict=False):
            if before[0] != "ptr":
                kept.append(part[-1])
        return kept

    def parameters(self) -> list[str]:
        """Parameters of the C function, in order, followed by the lengths that it asks for."""
        lengths = [each for each in self.routine.parameters if each.endswith(HIDDEN)]
        own = [each for each in self.routine.parameters if each not in lengths]
        return [*own, *(each for each in lengths if each in self.flow.users)]

    def is_there(self, value: str, number: int, call: Instruction) -> bool:
        """Whether a value is already in the register of argument `number`: computed there, or passed on in its place."""
        if self.demanded.ends_in(value, call):
            return True
        parameters, users = self.parameters(), self.flow.users.get(value)
        repeats = any(
            call in self.flow.blocks[label].instructions for loop in self.flow.loops for label in loop.blocks
        )
        return value in parameters[number : number + 1] and users == [call] and not repeats

    def operands_of(self, *opcodes: str) -> set[str]:
        """What any instruction with one of these opcodes takes."""
        instructions = (each for block in self.routine.blocks for each in block.instructions)
        return {operand for each in instructions if each.opcode in opcodes for operand in each.operands}
