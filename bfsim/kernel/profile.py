"""Compiler profiles: what stands between Python source and Blackfin code, as data.

LLVM optimises for one fixed 32-bit target whatever the host is, so that the same source costs the same cycles
everywhere. Sources: [SIM] GNU simulator, [EE-171], [VLIB] ADI's run-time library manual (see HARDWARE notes in
the README); [libgcc] measured: GCC 12.2's library for the Blackfin under the GNU simulator 13.1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

from bfsim.errors import ConfigError
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule

# A plain 32-bit machine with multiply and divide: 32-bit pointers as on the Blackfin, no vectors, and LLVM
# knows it on every host.
GENERIC_TRIPLE, GENERIC_FEATURES = "riscv32-unknown-elf", "+m"


@dataclass(frozen=True, slots=True)
class LibraryRoutine:
    """A routine of the run-time library: cycles from its first operation to its return, the call not included.

    `mix` tells how often each kind of operation runs, where that is known.
    """

    cclk: int
    mix: tuple[tuple[Op, int], ...] = ()


@dataclass(frozen=True, slots=True)
class MemoryRoutine:
    """A routine that fills or moves memory: cycles of a call, of each byte, and more if the piece has whole words."""

    cclk: int
    byte_cclk: int
    words_from: int
    """The shortest piece with whole words, in bytes."""
    words_cclk: int
    block_cclk: int
    """Cycles of each whole block of 16 bytes."""

    def of(self, nbytes: int) -> int:
        """Return the cycles of a piece of `nbytes` bytes."""
        return (
            self.cclk
            + nbytes * self.byte_cclk
            + (self.words_cclk if nbytes >= self.words_from else 0)
            + self.blocks_of(nbytes)
        )

    def blocks_of(self, nbytes: int) -> int:
        """Return the cycles of the whole blocks of a piece."""
        return nbytes // MEMORY_BLOCK_BYTES * self.block_cclk


MEMORY_BLOCK_BYTES = 16


@dataclass(frozen=True, slots=True)
class Library:
    """Integer division. Remainders come from routines of their own.

    `fill`, `move_bytes` and `move_words` (if both ends may be word-aligned): None if loops that fill or move stay
    loops.
    """

    divide_signed: LibraryRoutine
    divide_unsigned: LibraryRoutine
    remainder_signed: LibraryRoutine
    remainder_unsigned: LibraryRoutine
    fill: MemoryRoutine | None
    move_bytes: MemoryRoutine | None
    move_words: MemoryRoutine | None


@dataclass(frozen=True, slots=True)
class FloatLibrary:
    """Soft floats: the Blackfin has no floating-point unit."""

    add: LibraryRoutine
    subtract: LibraryRoutine
    multiply: LibraryRoutine
    divide: LibraryRoutine
    compare: LibraryRoutine
    from_integer: LibraryRoutine
    to_integer: LibraryRoutine
    square_root: LibraryRoutine


class Inlines(StrEnum):
    """Which calls a compiler may inline: those of kernels that it sees."""

    NOTHING = "nothing"
    FILE = "file"
    """Kernels of the caller's file; C files are compiled one by one."""
    PROGRAM = "program"
    """All kernels: one C file, or optimised when it is linked."""


@dataclass(frozen=True, slots=True)
class CompilerProfile:
    """How a compiler for the Blackfin treats a kernel."""

    name: str
    optimises: bool
    """Whether values live in registers (-O2) or every variable on the stack (-O0)."""
    interlocks: bool
    """Whether waits for pointer registers are counted."""
    parallel_issue: bool
    """Whether the compiler bundles memory accesses with 32-bit DSP operations (counts with `interlocks` only)."""
    accumulates: bool
    """Whether sums of 16-bit products stay in an accumulator: A0 += R.L * R.L."""
    push_multiple_cclk: int | None
    """Cycles of a push of several registers; None: one per register."""
    pop_multiple_cclk: int | None
    library: Library
    floats: FloatLibrary | None
    """None: kernels with floats are refused."""
    inlines: Inlines
    without: tuple[Rule, ...] = ()
    """Rules that are left out: those of another compiler, or to see what they are worth."""

    def applies(self, rule: Rule) -> bool:
        """Whether a rule is followed."""
        return rule not in self.without


UDIV_MIX = (
    (Op.IMM, 2), (Op.LOOP_SETUP, 1), (Op.SHIFT, 65), (Op.ALU, 33), (Op.COMPARE, 32), (Op.COND_MOVE, 32),
    (Op.RETURN, 1),
)  # fmt: skip
DIV_MIX = (
    *UDIV_MIX[:3], (Op.ALU, 37), (Op.COMPARE, 34), (Op.COND_MOVE, 35), (Op.CC_MOVE, 3), (Op.PUSH, 2), (Op.POP, 2),
    (Op.CALL, 1), (Op.RETURN, 2),
)  # fmt: skip

LIBGCC = Library(
    divide_unsigned=LibraryRoutine(170, UDIV_MIX),  # [libgcc] lib1funcs.S: 32 iterations of five operations, whatever the operands
    divide_signed=LibraryRoutine(196, DIV_MIX),     # [libgcc] the signs, and a call of the former
    remainder_unsigned=LibraryRoutine(183, (*UDIV_MIX, (Op.PUSH, 1), (Op.POP, 1), (Op.MOVE, 1), (Op.CALL, 1), (Op.RETURN, 1))),
    remainder_signed=LibraryRoutine(
        216, (*DIV_MIX, (Op.PUSH, 3), (Op.POP, 3), (Op.MUL32, 1), (Op.ALU, 1), (Op.CALL, 1), (Op.RETURN, 1))
    ),
    fill=MemoryRoutine(60, 0, 4, 46, 5),  # [libgcc] memset of newlib, by length: 1 byte 59, 16 bytes 114, 256 bytes 189, 2000 bytes 734 cycles; from no multiple of four on: 11 to 23 more, or 20 less for 4 to 6 bytes
    move_bytes=MemoryRoutine(65, 2, 16, 8, 0),  # [libgcc] memmove of newlib by no multiple of four: 1 byte 67, 15 bytes 95, 200 bytes 473; downwards 2 less
    move_words=MemoryRoutine(80, 0, 16, 47, 10),  # [libgcc] by a multiple of four: 4 bytes 73, 12 bytes 89, 16 bytes 127, 28 bytes 158, 32 bytes 137, 800 bytes 617
)  # fmt: skip
ADI = Library(
    divide_signed=LibraryRoutine(47),       # [VLIB] ___div32: 25 to 91 cycles with the call, 52 on average
    divide_unsigned=LibraryRoutine(47),     # [assumed] as signed
    remainder_signed=LibraryRoutine(51),    # [assumed] a division, a multiplication and a subtraction
    remainder_unsigned=LibraryRoutine(51),  # [assumed] the same
    fill=None,                       # [assumed] ADI's compiler manual mentions no such calls
    move_bytes=None,
    move_words=None,
)  # fmt: skip

LIBGCC_FLOATS = FloatLibrary(  # [libgcc] means of 2000 operands of magnitudes 2**-8 to 2**12, both signs; (least, most)
    add=LibraryRoutine(318),          # (298, 401) ___addsf3
    subtract=LibraryRoutine(321),     # (301, 412) ___subsf3
    multiply=LibraryRoutine(367),     # (356, 412) ___mulsf3
    divide=LibraryRoutine(599),       # (542, 658) ___divsf3
    compare=LibraryRoutine(163),      # (154, 181) ___ltsf2 and its like
    from_integer=LibraryRoutine(200), # (199, 203) ___floatsisf
    to_integer=LibraryRoutine(77),    # (72, 82) ___fixsfsi
    square_root=LibraryRoutine(545),  # (531, 554) sqrtf of newlib
)  # fmt: skip
ADI_FLOATS = FloatLibrary(     # the manual counts the call: 5 cycles less here
    add=LibraryRoutine(68),           # [VLIB] __float32_add: 30 to 103 cycles, 73 on average
    subtract=LibraryRoutine(68),      # [assumed] as an addition
    multiply=LibraryRoutine(66),      # [VLIB] __float32_mul: 41 to 146 cycles, typically 71
    divide=LibraryRoutine(235),       # [measured] 240 cycles on a BF561, as reported by a user of VisualDSP++
    compare=LibraryRoutine(30),       # [VLIB] 34 to 36 cycles
    from_integer=LibraryRoutine(25),  # [assumed] 20 to 40 cycles
    to_integer=LibraryRoutine(25),    # [assumed] the same
    square_root=LibraryRoutine(395),  # [assumed] 300 to 500 cycles
)  # fmt: skip

GCC_O0 = CompilerProfile(
    name="gcc-O0", optimises=False, interlocks=False, parallel_issue=False, accumulates=False, push_multiple_cclk=14, pop_multiple_cclk=11,  # [SIM]
    library=LIBGCC, floats=None, inlines=Inlines.NOTHING,
)  # fmt: skip
GCC_O2 = CompilerProfile(
    name="gcc-O2", optimises=True, interlocks=False, parallel_issue=False, accumulates=False, push_multiple_cclk=14, pop_multiple_cclk=11,  # [SIM]
    library=LIBGCC, floats=LIBGCC_FLOATS, inlines=Inlines.FILE,
)  # fmt: skip
GCC = replace(GCC_O2, name="gcc")
"""Kernels run as the code that GCC makes of them, instruction by instruction; kernels without such code are as GCC_O2."""
VDSP_O2 = CompilerProfile(
    name="vdsp-O2", optimises=True, interlocks=True, parallel_issue=True, accumulates=True, push_multiple_cclk=None, pop_multiple_cclk=None,  # [EE-171]
    library=ADI, floats=ADI_FLOATS, inlines=Inlines.FILE,  # [assumed] as GCC
    without=(Rule.LAGGING_COUNTERS, Rule.SPILLED_RANGES, Rule.FINAL_VALUES, Rule.PARALLEL_COUNTS, Rule.DOWNWARD_POINTERS,
             Rule.FREQUENT_COUNTERS, Rule.COPIED_BREAKS, Rule.PARTIAL_REDUNDANCIES, Rule.CONDITIONAL_MOVES, Rule.BUNDLES,
             Rule.SUNK_STORES, Rule.NARROW_CHOICES, Rule.SKIPPED_ITERATIONS,
             Rule.PREDICTIVE_COMMONING, Rule.SUM_CLASSES, Rule.NARROW_TREES, Rule.STEPPED_BETWEEN, Rule.KEPT_ADDRESSES,
             Rule.COUNTER_REGISTERS, Rule.STRENGTH_REDUCTION, Rule.COPIES_IN_FRONT, Rule.JUMP_TABLES,
             Rule.BIT_TESTS, Rule.CONSTANT_TABLES, Rule.STATE_MACHINES, Rule.ARGUMENT_LOADS, Rule.NARROW_BITS,
             Rule.CODE_HOISTING, Rule.THREADED_CHOICES, Rule.KEPT_BOUNDS, Rule.CROSS_JUMPS, Rule.POINTER_DIFFERENCES,
             Rule.FIELD_ADDRESSES, Rule.HALF_WORD_POINTERS, Rule.SHIFTED_COUNTS, Rule.STEPPED_VALUES, Rule.ROW_POINTERS, Rule.SPILLED_SUMS, Rule.INDEX_REGISTERS, Rule.OPPOSITE_FLAGS, Rule.EVEN_ADDRESSES,
             Rule.FIRST_ITERATIONS, Rule.COMPUTED_STARTS, Rule.ENDS_OF_RANGES, Rule.EITHER_BANK,
             Rule.COMMON_FACTORS, Rule.KNOWN_VALUES,
             Rule.ADJACENT_NUMBERS, Rule.SMALL_NUMBERS, Rule.ADDRESS_CLASSES, Rule.NARROW_FACTORS, Rule.PRODUCT_STEPS, Rule.STEPPED_BEFORE),  # GCC's alone: nothing says that VisualDSP++ does so
)  # fmt: skip
GCC_ADI = replace(
    GCC, name="gcc-adi", interlocks=True, push_multiple_cclk=None, pop_multiple_cclk=None,  # [EE-171]
    library=ADI, floats=ADI_FLOATS,
)  # fmt: skip
"""The same code on Analog Devices' documented pipeline, with their library."""
PROFILES = {each.name: each for each in (GCC_O0, GCC_O2, GCC, GCC_ADI, VDSP_O2)}
DEFAULT = GCC_ADI
"""The profile if none is named: real code where there is some, and documented times."""
RUN_AS_COMPILED = {GCC.name, GCC_ADI.name}
"""Profiles whose kernels run as their compiler's own code where there is some."""


def profile_named(name: str) -> CompilerProfile:
    """Return a profile by its name; raise ConfigError if there is none."""
    if name not in PROFILES:
        raise ConfigError(f"the compiler profile must be one of {', '.join(PROFILES)}, not {name!r}")
    return PROFILES[name]
