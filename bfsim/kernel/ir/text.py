"""LLVM IR as data: functions, blocks and instructions, each with its text, written anew with other names and values.

Our own passes (`rewrites`) take a routine and return another one. The text that they leave is what is costed, and what
is compiled for the host (`reading`, `writing`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from bfsim.kernel.intrinsics import BY_NAME, PREFIX, Intrinsic

NAME = re.compile(r"%[\w.$-]+")
TARGET = re.compile(r"label (%[\w.$-]+)")
TYPE = re.compile(r"\b(i\d+|ptr|float)\b")
PHI_ARM = re.compile(r"\[ ([^,\]]+), (%[\w.$-]+) \]")
CASE = re.compile(r"i\d+ (-?\d+), label (%[\w.$-]+)")
WIDTH = re.compile(r"\bi(\d+)\b")
INTRINSIC = re.compile(rf"@{re.escape(PREFIX)}(\w+)\(")
NO_HINT = (1 << 20, 1)
"""Weights of a branch about which the source says nothing; LLVM takes the first side for certain."""
LEAVES = (11, 189)
"""Weights of a branch whose first side leaves one of two loops that begin with the same test [PRED_LOOP_EXIT in predict.def of GCC 12, of two exits]."""
TRUTHS = {"false": 0, "true": 1}
"""Constants of an i1, as numbers."""
COMMUTATIVE = ("add", "mul", "and", "or", "xor")
"""Operations whose operands may change places."""
SWAPPED = {"slt": "sgt", "sgt": "slt", "sle": "sge", "sge": "sle",
           "ult": "ugt", "ugt": "ult", "ule": "uge", "uge": "ule", "eq": "eq", "ne": "ne"}  # fmt: skip
"""Each relation and the same one with its values in the other order."""
INVERTED = {"slt": "sge", "sge": "slt", "sle": "sgt", "sgt": "sle",
            "ult": "uge", "uge": "ult", "ule": "ugt", "ugt": "ule", "eq": "ne", "ne": "eq"}  # fmt: skip
"""Each relation and its opposite."""
ENTERS = "bfsim.enters."
"""Prefix, before a kernel's symbol, of a call that does nothing and marks where the code of that inlined kernel begins."""
STEPS = "bfsim.steps"
"""A call that does nothing, with start, stop and step of the next loop if its step is not constant: `guards` checks them."""
HOLDS = "bfsim.holds"
"""A call that does nothing, in the header of a loop that is not to be rotated; it stays until loops are rotated."""
OF_VARIABLE = "cut.variable"
"""In the name of a local variable that a store narrows, and of what LLVM makes of it: until then it is a whole word in C."""
COUNTS = "shift.count"
"""In the name of the language's mask on a shift count: the shifter applies it, but a mask in the source is an operation."""
HIDES = "bfsim.hides"
"""A call that returns its number, so that LLVM knows nothing of it."""


class SourceLine(NamedTuple):
    """Where an operation comes from: a line of the kernel `routine`. `site`: LLVM's number of the call that was inlined, 0 if none was."""

    routine: str
    line: int
    site: int = 0


class Entrance(NamedTuple):
    """Where the code of the kernel `symbol` begins, called from the line `caller`; `location` is the number of its note."""

    symbol: str
    caller: SourceLine
    location: str = ""


@dataclass(frozen=True, slots=True)
class Instruction:
    """One instruction. `operands` are the texts of its value operands: names such as %x, or constants."""

    result: str | None
    opcode: str
    text: str
    operands: tuple[str, ...]
    line: SourceLine
    weights: tuple[int, ...] = ()
    """For a branch, how likely each side is, if the source gives a hint."""
    location: str = ""
    """Number of the note that has its source line."""
    hint: str = ""
    """Number of the note that has its weights; empty if there is none yet."""

    @property
    def row(self) -> str:
        """The instruction as a line of LLVM's text."""
        target = f"{self.result} = " if self.result else ""
        location = f", !dbg !{self.location}" if self.location else ""
        return f"  {target}{self.text}{location}{f', !prof !{self.hint}' if self.hint else ''}"

    @property
    def is_division(self) -> bool:
        """Whether it is a routine of the run-time library, since the Blackfin has no instruction for it."""
        return self.opcode in ("sdiv", "udiv", "srem", "urem")

    @property
    def is_soft_float(self) -> bool:
        """Whether it calls the soft-float library."""
        named = self.opcode == "call" and ("@llvm.sqrt" in self.text or "@llvm.fpto" in self.text)
        return named or self.opcode in ("fadd", "fsub", "fmul", "fdiv", "fcmp", "sitofp", "uitofp")

    @property
    def is_call(self) -> bool:
        """Whether it is a call of another kernel."""
        return self.opcode == "call" and not self.is_computation and not self.is_mark

    @property
    def is_mark(self) -> bool:
        """Whether it is not code, but marks a place, such as one where something is to be checked."""
        return self.opcode == "call" and any(f"@{each}(" in self.text for each in (STEPS, HOLDS))

    @property
    def is_computation(self) -> bool:
        """Whether it is a call that stands for an operation of LLVM or of the kernel language."""
        names = ("@llvm.", f"@{PREFIX}", f"@{HIDES}")
        return self.opcode == "call" and any(each in self.text for each in names)

    @property
    def intrinsic(self) -> Intrinsic | None:
        """The intrinsic that it calls."""
        found = INTRINSIC.search(self.text) if self.opcode == "call" else None
        return BY_NAME[found[1]] if found else None

    @property
    def bits(self) -> int:
        """Width of the value that it loads, stores, extends or computes."""
        found = WIDTH.search(self.text) if " float" not in self.text else None
        return int(found.group(1)) if found else 32


@dataclass(frozen=True, slots=True)
class BasicBlock:
    """A basic block: phi nodes, other instructions, terminator last. Labels are written without %."""

    label: str
    instructions: tuple[Instruction, ...]
    enters: tuple[Entrance, ...] = ()
    """Those of inlined kernels whose code begins here."""

    def rows(self) -> Iterator[str]:
        """The block as LLVM's text."""
        yield f"{self.label}:"
        phis = [each for each in self.instructions if each.opcode == "phi"]
        yield from (each.row for each in phis)
        for entrance in self.enters:
            location = f", !dbg !{entrance.location}" if entrance.location else ""
            yield f"  call void @{ENTERS}{entrance.symbol}(){location}"
        yield from (each.row for each in self.instructions[len(phis) :])

    @property
    def terminator(self) -> Instruction:
        """The last instruction."""
        return self.instructions[-1]

    @property
    def successors(self) -> tuple[str, ...]:
        """Labels that the terminator can go to: for a branch the true side first, for a switch the default first."""
        return tuple(each[1:] for each in TARGET.findall(self.terminator.text))

    @property
    def cases(self) -> tuple[tuple[int, str], ...]:
        """(value, label) of each case of a switch."""
        return tuple((int(value), label[1:]) for value, label in CASE.findall(self.terminator.text))


@dataclass(frozen=True, slots=True)
class Routine:
    """A function of the module."""

    symbol: str
    parameters: tuple[str, ...]
    blocks: tuple[BasicBlock, ...]


def without_marks(routine: Routine) -> Routine:
    """Return `routine` without marks, as for the Blackfin, which checks nothing."""
    blocks = (
        replace(block, instructions=tuple(each for each in block.instructions if not each.is_mark))
        for block in routine.blocks
    )
    return replace(routine, blocks=tuple(blocks))


def each_arm(phi: Instruction) -> list[tuple[str, str]]:
    """Return each (value, label of its block) of a phi; twice if that block leads there by two cases of a switch."""
    return [(value, label[1:]) for value, label in PHI_ARM.findall(phi.text)]


def arms_of(phi: Instruction) -> dict[str, str]:
    """Return the values of a phi by the labels of the blocks that they come from."""
    return {label: value for value, label in each_arm(phi)}


def phi_of(result: str, kind: str, arms: Iterable[tuple[str, str]], at: Instruction) -> Instruction:
    """Return the phi of values of an LLVM type, each with the label of its block, at the same place in the source as `at`."""
    arms = [*arms]
    text = ", ".join(f"[ {value}, %{label} ]" for value, label in arms)
    return written(result, f"phi {kind} {text}", tuple(value for value, _ in arms), at)


def with_each_arm(phi: Instruction, arms: Iterable[tuple[str, str]]) -> Instruction:
    """Return a phi with other values, each with the label of the block that it comes from."""
    return phi_of(phi.result or "", phi.text.split()[1], arms, phi)


def with_values(phi: Instruction, arms: Mapping[str, str]) -> Instruction:
    """Return a phi with other values, by the labels of the blocks that they come from."""
    return with_each_arm(phi, ((value, label) for label, value in arms.items()))


def renamed(each: Instruction, names: Mapping[str, str]) -> Instruction:
    """Return an instruction that reads other values in place of those in `names`, as it says."""
    if not any(name in names for name in each.operands):
        return each
    text = NAME.sub(lambda found: names.get(found[0], found[0]), each.text)
    return replace(each, text=text, operands=tuple(names.get(name, name) for name in each.operands))


def written(result: str, text: str, operands: tuple[str, ...], at: Instruction) -> Instruction:
    """Return the instruction `text`, at the same place in the source as the instruction `at`."""
    return Instruction(result, text.split(maxsplit=1)[0], text, operands, at.line, location=at.location)


def is_number(value: str) -> bool:
    """Whether a value is an integer in the text."""
    return value.lstrip("-").isdigit()


def is_constant(value: str) -> bool:
    """Whether a value is an integer or a truth value in the text."""
    return is_number(value) or value in TRUTHS


def predicate(compare: Instruction) -> str:
    """Return the relation that an `icmp` or `fcmp` tests: eq, slt, ult, ..."""
    words = compare.text.split()
    return words[2] if words[1] in ("samesign", "fast") else words[1]


def type_of(each: Instruction) -> str:
    """Return the type of an instruction's result, in LLVM's words."""
    if each.opcode in ("icmp", "fcmp"):
        return "i1"
    if each.opcode == "getelementptr":
        return "ptr"
    found = TYPE.findall(each.text)
    return str(found[-1] if each.opcode in ("zext", "sext", "trunc") else found[0])
