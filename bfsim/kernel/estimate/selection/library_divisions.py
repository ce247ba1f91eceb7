"""Divisions that call a routine of the library, and which of its routines."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

from bfsim.kernel.emitting.divisions import FLOOR, ROUNDED, SIGNED
from bfsim.kernel.estimate.arithmetic.narrow_factors import NARROW
from bfsim.kernel.estimate.arithmetic.powers import divided_by_power
from bfsim.kernel.estimate.ranges.range_arithmetic import ANY, Range, is_positive
from bfsim.kernel.estimate.ranges.unsigned_ranges import UnsignedRanges
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule


class LibraryDivisions:
    """The divisions of one routine."""

    def __init__(self, flow: ControlFlow, profile: CompilerProfile) -> None:
        self.flow, self.profile = flow, profile

    def divides_by_call(self, each: Instruction) -> bool:
        """Whether a division calls the library; the others are products with a reciprocal."""
        if divided_by_power(each):
            return False
        return self.divides_signed(each) or not each.operands[1].isdigit()

    def divides_signed(self, each: Instruction) -> bool:
        """Whether a quotient comes from the signed routine: it was signed, or the compiler knows the sign of its dividend.

        GCC then takes the cheaper of the two ways, and counts a call as one [expand_divmod in expmed.cc of GCC 12];
        a byte or half-word that was just extended is not known to be positive there.
        """
        constant = is_number(each.operands[1])
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
        """Return the name of a division. If LLVM has narrowed it to bytes, its extension to an i32 has the name."""
        result = each.result or ""
        extended = [user for user in self.flow.users.get(result, ()) if user.opcode == "zext"]
        return " ".join([result, *(user.result or "" for user in extended)])
