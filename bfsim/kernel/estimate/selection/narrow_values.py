"""Bytes and half-words that are loaded: how they are used, and so whether, and how often, they are extended."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, auto

from bfsim.kernel.estimate.arithmetic.narrow_factors import BITWISE, NARROW, is_extended_for_product
from bfsim.kernel.estimate.induction_variables.induction_variable import InductionVariable
from bfsim.kernel.estimate.induction_variables.induction_variables import InductionVariables
from bfsim.kernel.estimate.induction_variables.kept_addresses import is_threaded
from bfsim.kernel.estimate.memory.predictive_commoning import ALONG
from bfsim.kernel.estimate.selection.folding import Folding
from bfsim.kernel.estimate.selection.loop_counters import LoopCounters
from bfsim.kernel.estimate.selection.narrow_trees import is_cut_tree
from bfsim.kernel.ir.control_flow import pointee_nbytes
from bfsim.kernel.ir.expansion import Expansion
from bfsim.kernel.ir.loads_along import FOLLOWING
from bfsim.kernel.ir.text import OF_VARIABLE, Instruction, is_number
from bfsim.kernel.ir.widths import BYTE
from bfsim.kernel.rules import Rule


class Use(Enum):
    """How a narrow value is used: as it was loaded, extended as a factor of a 16-bit product or of the distance of an element, or extended to a word."""

    RAW = auto()
    FACTOR = auto()
    DISTANCE = auto()
    WIDE = auto()


def is_distance(each: Instruction) -> bool:
    """Whether an address takes an index that counts elements of more than a byte."""
    return each.opcode == "getelementptr" and pointee_nbytes(each) > 1


class NarrowValues:
    """Those of one routine."""

    def __init__(
        self,
        folding: Folding,
        induction_variables: InductionVariables,
        counters: LoopCounters,
        emits: Callable[[Instruction], bool],
    ) -> None:
        """`emits`: whether an instruction becomes operations."""
        self.flow, self.profile, self.folding = folding.flow, folding.profile, folding
        self.induction_variables, self.counters, self.emits = induction_variables, counters, emits

    def extended_apart(self, load: Instruction) -> bool:
        """Whether a narrow value is taken as it is, or by a product, and computed with: it is loaded, then extended."""
        uses = self._uses(load)
        return not uses.isdisjoint({Use.WIDE, Use.DISTANCE}) and len(uses) > 1

    def extended_by_load(self, load: Instruction) -> bool:
        """Whether a narrow value is extended as it is loaded."""
        is_cut = all(user.opcode == "trunc" for user in self._wide_users(load))
        return self._uses(load) == {Use.WIDE} and not is_cut and not self.extended_late(load)

    def extended_for_distance(self, load: Instruction) -> bool:
        """Whether a byte that is extended to a word is also extended for the distance of an element, in the same block."""
        rows = next(each.instructions for each in self.flow.routine.blocks if load in each.instructions)
        near = any(user in rows and is_distance(user) for user in self._wide_users(load))
        return near and {Use.DISTANCE, Use.WIDE} <= self._uses(load)

    def extended_for_product(self, operand: str) -> bool:
        """Whether a factor is a byte that is also used in another way: it is extended once more, for the product."""
        each = self.flow.instruction(operand)
        if self.profile.applies(Rule.NARROW_FACTORS) and is_extended_for_product(self.flow, operand):
            return True
        if each is None or each.opcode != "zext":
            return False
        load = self.flow.instruction(each.operands[0])
        return (
            load is not None
            and load.opcode == "load"
            and Use.FACTOR in (uses := self._uses(load))
            and len(uses) > 1
        )

    def _uses(self, load: Instruction) -> set[Use]:
        """The ways in which a narrow value is used; none if it is a word."""
        if load.opcode != "load" or load.bits not in NARROW:
            return set()
        return {
            self._use(load, user)
            for user in self._wide_users(load)
            if user.result is None or self.emits(user) or self.folding.in_comparison(user)
        }

    def _use(self, load: Instruction, user: Instruction) -> Use:
        if self._is_raw(load, user):
            return Use.RAW
        if (
            user.opcode == "mul"
            and self.profile.applies(Rule.FACTORS)
            and self.folding.products.is_short(user)
        ):
            return Use.FACTOR if load.bits == BYTE else Use.RAW  # a product takes the low half of a register
        if is_distance(user) and load.bits == BYTE and self.profile.applies(Rule.FACTORS):
            return Use.DISTANCE  # a product, too [convert_mult_to_widen in tree-ssa-math-opts.cc]
        return Use.WIDE

    def _wide_users(self, load: Instruction) -> list[Instruction]:
        """Users of a loaded value, through its extension."""
        found: list[Instruction] = []
        for user in self.folding.users(load.result or ""):
            found += self.folding.users(user.result or "") if user.opcode in ("zext", "sext") else [user]
        return found

    def _is_raw(self, load: Instruction, user: Instruction) -> bool:
        """Whether a use takes the narrow value as it is: a store, a mask of it, or arithmetic that is stored as narrow."""
        chosen = user.opcode == "phi" and user.bits in NARROW and self.profile.applies(Rule.NARROW_CHOICES)
        stored = chosen and all(each.opcode == "store" for each in self.folding.users(user.result or ""))
        along = user.opcode == "phi" and (
            ALONG in (user.result or "") or (user.result or "").endswith(FOLLOWING)
        )
        narrow = (self.in_narrow_tree(user) and user.opcode != "shl") or self.narrowed(user)
        changed = user.opcode in BITWISE and self.folding.products.is_narrow_factor(user)
        return user.opcode == "store" or stored or along or narrow or changed or self._masks(load, user)

    def _masks(self, load: Instruction, user: Instruction) -> bool:
        """Whether a mask takes some bits of what was loaded, and so none that an extension makes."""
        mask = user.operands[1] if user.opcode == "and" else ""
        is_within = mask.isdigit() and int(mask) < 1 << load.bits
        is_operation = not self.folding.is_shift_mask(user)
        return is_within and is_operation and self.profile.applies(Rule.NARROW_BITS)

    def in_narrow_tree(self, each: Instruction) -> bool:
        """Whether only the low bits of a result are wanted, for a narrow value that is stored."""
        return self.profile.applies(Rule.NARROW_TREES) and is_cut_tree(self.folding.users, each)

    def narrowed(self, each: Instruction) -> bool:
        """Whether a sum is stored as a narrow value and used as a wide one: C compilers compute it twice.

        That of a variable they do where both operands are narrow ["narrowing conversion of an arithmetic operation" in match.pd of GCC 12].
        """
        users = self.folding.users(each.result or "")
        is_of_narrow = all(map(self._was_narrow, each.operands[:2]))
        cut = [
            user
            for user in users
            if user.opcode == "trunc" and (is_of_narrow or OF_VARIABLE not in (user.result or ""))
        ]
        stored = [
            user
            for user in cut
            if all(one.opcode == "store" for one in self.folding.users(user.result or ""))
        ]
        both = bool(stored) and len(stored) < len(users)
        return each.opcode in ("add", "sub") and both and self.profile.applies(Rule.NARROW_SUMS)

    def _was_narrow(self, value: str) -> bool:
        each = self.flow.instruction(value)
        return is_number(value) or (each is not None and each.opcode in ("zext", "sext"))

    def extended_late(self, load: Instruction) -> bool:
        """Whether the load with the post-increment is extended on its own: others through its pointer come before its use."""
        variable = self.induction_variables.of.get(id(load))
        if self._is_stepped_between(load, variable):
            return True
        if not self.profile.applies(Rule.LATE_EXTENSION):
            return False
        if (
            load.bits not in NARROW
            or variable is None
            or not variable.steps_free
            or variable.keeps_address
            or is_threaded(variable.loop, self.flow)
            or variable.accesses[0][1] is not load
        ):
            return False
        users = self.folding.users(load.result or "")
        if len(variable.accesses) < 2 or len(users) != 1 or not self._is_extension(users[0]):
            return False
        label = variable.accesses[0][0]
        if load not in self.flow.blocks[label].instructions:
            return False  # what is loaded comes from where several ways meet
        rows = Expansion(self.flow, label, stepping=load).order()
        if users[0] not in rows:
            return False
        between = rows[rows.index(load) + 1 : rows.index(users[0])]
        return any(each is access for each in between for _, access, _ in variable.accesses)

    def _is_extension(self, each: Instruction) -> bool:
        """Whether a conversion is an operation: where only 16 bits are wanted, that of a half-word is none."""
        is_done = self.folding.products.does_extension(each)
        return not is_done and (each.opcode == "zext" or (each.opcode == "sext" and not self._is_cut(each)))

    def _is_cut(self, each: Instruction) -> bool:
        return all(self.in_narrow_tree(user) for user in self.folding.users(each.result or ""))

    def _is_stepped_between(self, load: Instruction, variable: InductionVariable | None) -> bool:
        """Whether a pointer that a counter is computed from is stepped between a load and the extension [modified_between_p in combine.cc]."""
        kept = any(
            each.variable is variable and not each.is_stepped and each.variable.steps_free
            for each in self.counters.eliminated.values()
        )
        wide = any(user.opcode in ("zext", "sext") for user in self.folding.users(load.result or ""))
        return (
            self.profile.applies(Rule.STEPPED_BETWEEN)
            and variable is not None
            and kept
            and wide
            and load in self.flow.blocks[variable.loop.header].instructions
        )
