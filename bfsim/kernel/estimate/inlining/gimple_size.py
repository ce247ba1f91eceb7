"""Size and time of a routine as GCC's inliner estimates them, in statements of GCC's intermediate code.

Sizes are those of its statements (`statements`). Half of an access to a fixed element of a parameter, such as state[0],
is expected to disappear when the routine is inlined [eliminated_by_inlining_prob in ipa-fnsummary.cc]. The size of 549
routines was 7.5 % off on average.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache, cached_property
from math import floor

import llvmlite.binding as llvm

from bfsim.files import store
from bfsim.kernel import function_keys
from bfsim.kernel.emitting.emit import emit_alone
from bfsim.kernel.estimate.arithmetic.bits_set import STATEMENTS as WORD_COUNT
from bfsim.kernel.estimate.arithmetic.bits_set import counted_word
from bfsim.kernel.estimate.inlining.statements import statement_size
from bfsim.kernel.estimate.prediction.frequencies import frequencies
from bfsim.kernel.estimate.prediction.predict import Likelihood
from bfsim.kernel.estimate.ranges.range_arithmetic import ANY, LARGEST, Range
from bfsim.kernel.estimate.ranges.unsigned_ranges import UnsignedRanges
from bfsim.kernel.ir import llvm_passes
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.ir.text import Instruction, Routine, is_number, without_marks
from bfsim.kernel.language.function import Function

GONE = 0.5  # [ipa-fnsummary.cc] of an access that may disappear
# [tree-inline.cc] time of a call, of a division by a variable, of a return; the time of everything else is its size
CALL_TIME, DIVISION_TIME, RETURN_TIME = 10, 10, 2
EARLY_PASSES = (
    "sroa", "simplify_cfg", "instruction_combine", "new_gvn", "simplify_cfg", "instruction_combine", "aggressive_dce",
    "simplify_cfg",
)  # fmt: skip
ANSWERING = (
    "instruction_combine",
    "sccp",
    "instruction_combine",
    "simplify_cfg",
    "aggressive_dce",
    "simplify_cfg",
)
"""The same, with known ranges of arguments."""

Given = tuple[Range | None, ...]


@dataclass(frozen=True, slots=True)
class CallSite:
    """A call in a routine: its line, how often it runs per run of the routine, and its own size and time.

    `spared_size`, `spared_time`: what of the callee disappears when it is inlined, because its arguments answer tests
    [evaluate_properties_for_edge in ipa-fnsummary.cc].
    """

    callee: str
    line: int
    frequency: float
    size: int
    time: int
    spared_size: int
    spared_time: float


@dataclass(frozen=True, slots=True)
class Estimate:
    """The size and time of one routine when it is inlined, and what disappears then besides its prologue and its return.

    `fixed_size`, `fixed_time`: of the sums that compute the addresses of fixed elements of its parameters; they are
    free if these elements are fixed in the source.
    """

    size: int
    time: float
    calls: tuple[CallSite, ...]
    gone_size: int
    gone_time: float
    fixed_size: int
    fixed_time: float


@cache
def estimate(function: Function) -> Estimate:
    """Estimate one kernel, with nothing inlined, or take the estimate from the cache on disk: profiles and programs share it."""
    found = store.kept(function_keys.estimate_key(function), lambda: asdict(_estimated(function)))
    return Estimate(**{**found, "calls": tuple(CallSite(**each) for each in found["calls"])})


@cache
def _estimated(function: Function, given: Given = ()) -> Estimate:
    """Estimate a kernel; `given`: what is known of its arguments, in the order of the parameters in LLVM's IR."""
    module = llvm_passes.parsed(emit_alone(function))
    llvm_passes.run(EARLY_PASSES, module)
    (routine,) = map(without_marks, read_module(str(module)))
    known = _unchanged(routine, given)
    if any(known):
        module = llvm.parse_assembly(_with_ranges(str(module), function.symbol, known))
        llvm_passes.run(ANSWERING, module)
        (routine,) = map(without_marks, read_module(str(module)))
    return _Estimator(ControlFlow(routine), {each.symbol: each for each in function.callees()}).run()


def _unchanged(routine: Routine, given: Given) -> Given:
    """What is known of arguments, except those that the routine changes: then a test is not of the argument."""
    merged = {
        value
        for block in routine.blocks
        for each in block.instructions
        if each.opcode == "phi"
        for value in each.operands
    }
    return tuple(
        None if name in merged else known for name, known in zip(routine.parameters, given, strict=False)
    )


def _with_ranges(text: str, symbol: str, given: Given) -> str:
    """Return a module in which the parameters of a routine have their known ranges, or are numbers if a range has only one."""
    before, head, behind = re.split(rf"(define \w+ @{re.escape(symbol)}\(.*?\))", text, maxsplit=1)
    name, parameters = head.split("(", 1)
    parts = [
        each if known is None else each.replace("i32", f"i32 range(i32 {known[0]}, {known[1] + 1})", 1)
        for each, known in zip(parameters.split(", "), given, strict=True)
    ]
    for each, known in zip(parameters.rstrip(")").split(", "), given, strict=True):
        if known is not None and known[0] == known[1]:
            behind = re.sub(rf"{re.escape(each.split()[-1])}(?![\w.$-])", str(known[0]), behind)
    return f"{before}{name}({', '.join(parts)}{behind}"


@dataclass(frozen=True)
class _Estimator:
    flow: ControlFlow
    callees: Mapping[str, Function]
    """By symbol."""

    def run(self) -> Estimate:
        size, time, calls, accesses, gone_time = 0, 0.0, [], 0, 0.0
        fixed: dict[str, float] = {}
        for label in self.flow.order:
            frequency = self.frequency[label]
            for each in self.flow.blocks[label].instructions:
                own = self._size(each)
                size += own
                time += frequency * self._time(each, own)
                if self._is_of_parameter(each):
                    accesses += 1
                    gone_time += GONE * frequency
                    fixed.setdefault(self._address(each), frequency)
                if each.is_call:
                    site = CallSite(
                        _callee(each),
                        each.line.line,
                        frequency,
                        own,
                        self._time(each, own),
                        *self._spared(each),
                    )
                    calls.append(site)
        gone = floor(GONE * accesses)
        return Estimate(
            size - gone, time - gone_time, tuple(calls), gone, gone_time, len(fixed), sum(fixed.values())
        )

    def _spared(self, call: Instruction) -> tuple[int, float]:
        """Return by how much the callee is smaller and faster with the arguments of a call."""
        given = tuple(map(self._known, call.operands))
        if not any(given):
            return 0, 0.0
        callee = self.callees[_callee(call)]
        plain, known = estimate(callee), _estimated(callee, given)
        size = plain.size + plain.gone_size - known.size - known.gone_size
        time = plain.time + plain.gone_time - known.time - known.gone_time
        # if only the index is given, its sum with the array's address remains
        size -= max(0, known.fixed_size - plain.fixed_size)
        time -= max(0.0, known.fixed_time - plain.fixed_time)
        return max(0, size), max(0.0, time)

    def _known(self, argument: str) -> Range | None:
        """The range of an argument, if anything is known and all its values are positive."""
        if argument.startswith("%"):
            found = self._ranges.get(argument, ANY)
        elif is_number(argument):
            found = int(argument), int(argument)
        else:
            return None
        return found if found[0] >= 0 and found[1] < LARGEST else None

    @cached_property
    def _ranges(self) -> Mapping[str, Range]:
        return UnsignedRanges(self.flow).found

    def _address(self, access: Instruction) -> str:
        """What an address is computed from."""
        place = access.operands[-1]
        made = self.flow.instruction(place)
        return place if made is None else " ".join((*made.operands, made.text.split()[1]))

    def _is_of_parameter(self, access: Instruction) -> bool:
        """Whether it loads or stores a fixed element of a parameter."""
        if access.opcode not in ("load", "store"):
            return False
        place = access.operands[-1]
        made = self.flow.instruction(place)
        if made is not None and made.opcode == "getelementptr" and not made.operands[-1].startswith("%"):
            place = made.operands[0]
        return place in self.flow.routine.parameters

    def _size(self, each: Instruction) -> int:
        if each.is_call:
            callee = self.callees[_callee(each)]
            return 1 + len(callee.parameters) + len(callee.measured) + int(each.result in self.flow.users)
        size = statement_size(self.flow, each)
        return size if counted_word(self.flow, each) is None else size - WORD_COUNT + 1

    def _time(self, each: Instruction, size: int) -> int:
        if each.is_call:
            return size - 1 + CALL_TIME
        if each.is_division and each.operands[1].startswith("%"):
            return DIVISION_TIME
        return size

    @cached_property
    def frequency(self) -> dict[str, float]:
        """Runs of each block per run of the routine."""
        return frequencies(self.flow, Likelihood(self.flow).taken)


def _callee(call: Instruction) -> str:
    return call.text[call.text.index("@") + 1 : call.text.index("(", call.text.index("@"))]
