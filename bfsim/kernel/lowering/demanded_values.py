"""Demanded values: what of the optimised IR a Blackfin has to compute at all, and in which form.

Post-increments, hardware loops, folded offsets and extending loads do much of what the IR spells out.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

from bfsim.kernel.divisions import FLOOR, ROUNDED, SIGNED
from bfsim.kernel.ir_text import OF_VARIABLE, Instruction, is_number
from bfsim.kernel.loops import ControlFlow, Loop
from bfsim.kernel.lowering.bits_set import counted_word
from bfsim.kernel.lowering.endless_loops import EndlessLoops
from bfsim.kernel.lowering.folding import NARROW, Folding
from bfsim.kernel.lowering.if_conversion import ConversionKind, IfConversion
from bfsim.kernel.lowering.induction_variable_elimination import eliminated_counters
from bfsim.kernel.lowering.induction_variables import InductionVariable, InductionVariables
from bfsim.kernel.lowering.jump_threading import JumpThreading
from bfsim.kernel.lowering.narrow_trees import is_cut_tree
from bfsim.kernel.lowering.narrow_uses import Use, is_distance
from bfsim.kernel.lowering.powers import divided_by_power
from bfsim.kernel.lowering.predictive_commoning import ALONG
from bfsim.kernel.lowering.range_arithmetic import ANY, Range, is_positive
from bfsim.kernel.lowering.redundant import AGAIN
from bfsim.kernel.lowering.scalar_evolution import Increment, ScalarEvolution
from bfsim.kernel.lowering.unsigned_ranges import UnsignedRanges
from bfsim.kernel.lowering.widths import BYTE
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule

FEWEST_ITERATIONS = (
    3  # a loop of so few iterations keeps its branch ["too few iterations" in loop-doloop.cc of GCC 12]
)


class DemandedValues(Folding):
    """Which instructions of one routine are emitted, and which are part of others."""

    def __init__(
        self,
        flow: ControlFlow,
        evolution: ScalarEvolution,
        if_conversion: IfConversion,
        induction_variables: InductionVariables,
        jump_threading: JumpThreading,
        calling: frozenset[str],
        frequency: Mapping[str, float],
        profile: CompilerProfile,
    ) -> None:
        """`calling`: blocks that become calls of the library; `frequency`: how often each block runs."""
        super().__init__(flow, profile, if_conversion.flags)
        self.evolution, self.if_conversion, self.induction_variables, self.jump_threading = (
            evolution,
            if_conversion,
            induction_variables,
            jump_threading,
        )
        self.calling = calling
        self.endless_loops = EndlessLoops(flow, evolution, induction_variables, profile)
        self.counted = {loop.header for loop in flow.loops if self._iterations_by_counter(loop)}
        eliminates = profile.applies(Rule.ELIMINATED_COUNTERS)
        self.eliminated = (
            eliminated_counters(
                flow,
                evolution,
                induction_variables,
                self.counted,
                frequency if profile.applies(Rule.FREQUENT_COUNTERS) else {},
                prepares=profile.applies(Rule.PREPARED_DIFFERENCES),
            )
            if eliminates
            else {}
        )

    def _iterations_by_counter(self, loop: Loop) -> bool:
        """Counted, and without calls and computed jumps: a register counts the iterations, not the program's variable."""
        inside = (each for label in self.flow.inside(loop) for each in self.flow.blocks[label].instructions)
        library = any(
            each.is_call
            or each.opcode == "switch"
            or each.is_soft_float
            or (each.is_division and self.divides_by_call(each))
            for each in inside
        ) or not self.calling.isdisjoint(loop.blocks)
        iterations = self.evolution.iterations(loop)
        many = iterations is None or iterations > FEWEST_ITERATIONS
        counted = self.evolution.is_counted(loop) and not self.endless_loops.may_be(loop)
        return not library and many and counted and (iterations is not None or self._steps_by_power(loop))

    def _steps_by_power(self, loop: Loop) -> bool:
        """Whether the number of iterations takes a shift to find, not a division ["Costs of niter computation too high" there]."""
        if not self.profile.applies(Rule.DIVIDED_COUNTS):
            return True
        test = self.flow.instruction(self.evolution.exit_test(loop) or "")
        gains = (
            [self.evolution.increment(operand, loop) for operand in test.operands[:2]]
            if test is not None
            else []
        )
        return all(gain is None or abs(gain.constant).bit_count() <= 1 for gain in gains)

    def emits(self, each: Instruction) -> bool:
        """Whether `each` becomes operations."""
        if each.result is None:
            return True
        if each.result in self.evolution.code_motion.same:
            return False
        return (
            each.result in self._needed and self.flow.defined[each.result][0] not in self.if_conversion.gone
        )

    @cached_property
    def _needed(self) -> set[str]:
        needed: set[str] = set()
        waiting = [
            each for block in self.flow.routine.blocks for each in block.instructions if self._is_root(each)
        ]
        roots = {id(each) for each in waiting}
        while waiting:
            each = waiting.pop()
            if each.result and (each.result not in needed or id(each) in roots):
                needed.add(each.result)
            for used in self._really_used(each):
                if used in self.eliminated and not self._is_own_step(each, used):
                    continue
                operand = self.evolution.code_motion.same.get(used, used)
                source = self.flow.instruction(operand)
                if source is not None and operand not in needed:
                    needed.add(operand)
                    waiting.append(source)
        return needed

    def _is_own_step(self, each: Instruction, counter: str) -> bool:
        phi = self.flow.instruction(counter)
        return phi is not None and each.result in phi.operands

    def _is_root(self, each: Instruction) -> bool:
        along = AGAIN in (each.result or "")
        return each.opcode in ("store", "br", "switch", "ret") or each.is_call or along

    def _really_used(self, each: Instruction) -> tuple[str, ...]:
        if each.opcode in ("load", "store") and id(each) in self.induction_variables.of:
            variable = self.induction_variables.of[id(each)]
            return (*each.operands[:-1], *(name for name, _ in (*variable.start, *variable.distance)))
        if each.opcode == "br":
            return () if self.jump_threading.decides(each) or self._is_guard(each) else self._of_branch(each)
        if each.opcode == "icmp":
            return self._of_compare(each)
        if (word := self.counted_bits(each)) is not None:
            return (word,)
        if (other := self.added_flag(each)) is not None:
            return (other,)
        if each.opcode == "mul" and self.stepped(each) is not None:
            return tuple(operand for operand in each.operands if self._stays(operand, each))
        if (division := self.remainder(each)) is not None:
            return division.operands
        if each.opcode in ("select", "and", "or") and each.bits == 1:
            counting = {
                self.evolution.exit_test(loop) for loop in self.flow.loops if loop.header in self.counted
            }
            return tuple(operand for operand in each.operands if operand not in counting)
        return each.operands

    def counted_bits(self, each: Instruction) -> str | None:
        """The word whose bits an instruction ends up with, counted in parallel: an instruction does that."""
        return counted_word(self.flow, each) if self.profile.applies(Rule.PARALLEL_COUNTS) else None

    def stepped(self, product: Instruction) -> Increment | None:
        """By how much a product of a counter grows with each iteration: an addition takes its place (strength reduction)."""
        loop = self.flow.innermost(self.evolution.code_motion.of[product.result or ""])
        increment = self.evolution.increment(product.result or "", loop) if loop is not None else None
        return increment if increment is not None and increment.moves else None

    def _stays(self, operand: str, product: Instruction) -> bool:
        loop = self.flow.innermost(self.evolution.code_motion.of[product.result or ""])
        return loop is not None and self.evolution.code_motion.is_invariant(operand, loop)

    def _is_guard(self, branch: Instruction) -> bool:
        return any(
            block.terminator is branch and self.flow.is_overflow_guard(block)
            for block in self.flow.routine.blocks
        )

    def _of_branch(self, each: Instruction) -> tuple[str, ...]:
        """The test of a loop that a counter ends is not made, nor that of a minimum or an absolute value."""
        label = next(block.label for block in self.flow.routine.blocks if block.terminator is each)
        for loop in self.flow.loops:
            if self.flow.ending(loop) == label and loop.header in self.counted:
                return tuple(
                    operand for operand in each.operands if operand != self.evolution.exit_test(loop)
                )
        conversion = self.if_conversion.by_label.get(label)
        if conversion is not None and conversion.kind in (
            ConversionKind.ABSOLUTE,
            ConversionKind.EXTREME,
            ConversionKind.CLAMP,
        ):
            return ()
        return each.operands

    def _of_compare(self, each: Instruction) -> tuple[str, ...]:
        """A counter that only walks by a constant and is compared with a bound that ends the loop: the pointer is compared instead.

        [may_eliminate_iv in tree-ssa-loop-ivopts.cc]
        """
        label = self.flow.defined[each.result or ""][0]
        loop = self.flow.innermost(label)
        if (
            loop is None
            or label not in self.flow.exits(loop)
            or not any(
                variable.loop is loop and not variable.stride for variable in self.induction_variables.all
            )
        ):
            return self.compared(each)
        gains = {operand: self.evolution.increment(operand, loop) for operand in each.operands[:2]}
        moving = [gain for gain in gains.values() if gain is None or gain.moves]
        if len(moving) != 1 or moving[0] is None or moving[0].symbolic:
            return self.compared(each)
        return tuple(operand for operand, gain in gains.items() if gain and not gain.moves)

    # Divisions

    def has_quotient(self, rest: Instruction) -> bool:
        """Whether the quotient of the same two values is computed as well, or its negative: the remainder follows from it."""
        value, divisor = rest.operands[:2]
        divisors = {divisor, str(-int(divisor)) if is_number(divisor) else divisor}
        return any(
            each.is_division
            and each.opcode.endswith("div")
            and each.operands[0] == value
            and each.operands[1] in divisors
            and self.emits(each)
            for block in self.flow.routine.blocks
            for each in block.instructions
        )

    def rounds_down(self, rest: Instruction) -> bool:
        """Whether a remainder only tells whether a quotient is rounded down; LLVM makes it one with that of `%`, which C calls the library for."""
        users = self.users(rest.result or "")
        only_asked = all(each.opcode in ("icmp", "xor", "ashr", "lshr") for each in users)
        return FLOOR in (rest.result or "") and only_asked and self.has_quotient(rest)

    def divides_by_call(self, each: Instruction) -> bool:
        """Whether a division calls the library; the others are products with a reciprocal."""
        if divided_by_power(each):
            return False
        return self.divides_signed(each) or not each.operands[1].isdigit()

    def divides_signed(self, each: Instruction) -> bool:
        """Whether a quotient comes from the signed routine: it was signed, or the compiler knows its dividend's sign.

        GCC then takes the cheaper of the two ways, and counts a call as one [expand_divmod in expmed.cc of GCC 12];
        a byte or half-word that was just extended is not known to be positive there.
        """
        constant = each.operands[1].lstrip("-").isdigit()
        if each.bits in NARROW and not constant:
            return True  # C widens bytes and half-words to int before it divides them
        name = self._name_of(each)
        dividend = self.flow.instruction(each.operands[0])
        narrow = (
            dividend is not None
            and (dividend.opcode == "zext" or (dividend.opcode == "load" and dividend.bits in NARROW))
            and each.opcode[0] == "u"
            and ROUNDED not in name
        )
        if SIGNED in name or FLOOR in name or each.opcode[0] == "s":
            return not (constant and narrow)
        known = constant and not narrow and self.profile.applies(Rule.KNOWN_SIGN)
        return known and is_positive(self._ranges.get(each.operands[0], ANY))

    @cached_property
    def _ranges(self) -> Mapping[str, Range]:
        return UnsignedRanges(self.flow).found

    def _name_of(self, each: Instruction) -> str:
        """Return the name of a division. Where LLVM has made it one of bytes, what extends it to an i32 has it."""
        result = each.result or ""
        extended = [user for user in self.flow.users.get(result, ()) if user.opcode == "zext"]
        return " ".join([result, *(user.result or "" for user in extended)])

    # Narrow values

    def extended_apart(self, load: Instruction) -> bool:
        """Whether a narrow value is taken as it is, or by a product, and computed with: it is loaded, then extended."""
        uses = self._uses(load)
        return not uses.isdisjoint({Use.WIDE, Use.DISTANCE}) and len(uses) > 1

    def extended_for_distance(self, load: Instruction) -> bool:
        """Whether a byte that is extended to a word is also extended for the distance of an element, in the same block."""
        rows = next(each.instructions for each in self.flow.routine.blocks if load in each.instructions)
        near = any(user in rows and is_distance(user) for user in self._wide_users(load))
        return near and {Use.DISTANCE, Use.WIDE} <= self._uses(load)

    def extended_for_product(self, operand: str) -> bool:
        """Whether a factor is a byte that is also used in another way: it is extended once more, for the product."""
        each = self.flow.instruction(operand)
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
            if user.result is None or self.emits(user)
        }

    def _use(self, load: Instruction, user: Instruction) -> Use:
        if self._is_raw(load, user):
            return Use.RAW
        if (
            user.opcode == "mul"
            and self.profile.applies(Rule.FACTORS)
            and all(map(self.is_short, user.operands[:2]))
        ):
            return Use.FACTOR if load.bits == BYTE else Use.RAW  # a product takes the low half of a register
        if is_distance(user) and load.bits == BYTE and self.profile.applies(Rule.FACTORS):
            return Use.DISTANCE  # a product, too [convert_mult_to_widen in tree-ssa-math-opts.cc]
        return Use.WIDE

    def _wide_users(self, load: Instruction) -> list[Instruction]:
        """Users of a loaded value, through its extension."""
        found: list[Instruction] = []
        for user in self.users(load.result or ""):
            found += self.users(user.result or "") if user.opcode in ("zext", "sext") else [user]
        return found

    def _is_raw(self, load: Instruction, user: Instruction) -> bool:
        """Whether a use takes the narrow value as it is: a store, a mask of it, or arithmetic that is stored as narrow."""
        chosen = user.opcode == "phi" and user.bits in NARROW and self.profile.applies(Rule.NARROW_CHOICES)
        stored = chosen and all(each.opcode == "store" for each in self.users(user.result or ""))
        along = user.opcode == "phi" and ALONG in (user.result or "")
        narrow = (self.in_narrow_tree(user) and user.opcode != "shl") or self.narrowed(user)
        return user.opcode == "store" or stored or along or narrow or self._masks(load, user)

    def _masks(self, load: Instruction, user: Instruction) -> bool:
        """Whether a mask takes some bits of what was loaded, and so none that an extension makes."""
        mask = user.operands[1] if user.opcode == "and" else ""
        is_within = mask.isdigit() and int(mask) < 1 << load.bits
        return is_within and self.profile.applies(Rule.NARROW_BITS)

    def in_narrow_tree(self, each: Instruction) -> bool:
        """Whether only the low bits of a result are wanted, for a narrow value that is stored."""
        return self.profile.applies(Rule.NARROW_TREES) and is_cut_tree(self.users, each)

    def narrowed(self, each: Instruction) -> bool:
        """Whether a sum is stored as a narrow value and used as a wide one: C compilers compute it twice.

        That of a variable they do where both operands are narrow ["narrowing conversion of an arithmetic operation" in match.pd of GCC 12].
        """
        users = self.users(each.result or "")
        is_of_narrow = all(map(self._was_narrow, each.operands[:2]))
        cut = [
            user
            for user in users
            if user.opcode == "trunc" and (is_of_narrow or OF_VARIABLE not in (user.result or ""))
        ]
        stored = [user for user in cut if all(one.opcode == "store" for one in self.users(user.result or ""))]
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
            or variable.accesses[0][1] is not load
        ):
            return False
        users = self.users(load.result or "")
        if len(variable.accesses) < 2 or len(users) != 1 or users[0].opcode != "zext":
            return False
        label = variable.accesses[0][0]
        rows = self.flow.blocks[label].instructions
        ends = {id(user) for user in self.users(users[0].result or "")}
        if load not in rows:
            return False  # what is loaded comes from where several ways meet
        between = rows[rows.index(load) + 1 :]
        first_use = next((number for number, each in enumerate(between) if id(each) in ends), len(between))
        return any(each is access for each in between[:first_use] for _, access, _ in variable.accesses)

    def _is_stepped_between(self, load: Instruction, variable: InductionVariable | None) -> bool:
        """Whether a pointer that a counter is computed from is stepped between a load and the extension [modified_between_p in combine.cc]."""
        kept = any(each.variable is variable for each in self.eliminated.values())
        wide = any(user.opcode in ("zext", "sext") for user in self.users(load.result or ""))
        return (
            self.profile.applies(Rule.STEPPED_BETWEEN)
            and variable is not None
            and kept
            and wide
            and load in self.flow.blocks[variable.loop.header].instructions
        )

    def ends_in(self, value: str, call: Instruction) -> bool:
        """Whether `call` is the only use of a value: then it is computed in the argument's register."""
        return value in self.flow.defined and self.users(value) == [call]
