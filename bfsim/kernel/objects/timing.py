"""Which timing counts the cycles of object code: as a profile has interlocks and a library.

Where a profile counts interlocks, it stands for Analog Devices' documents. Then a routine of the library counts as ADI's manual
says that it does on average, whichever instructions the compiler's own library has for it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from bfsim.blackfin.timing.tables import ADI, GNU, Timing
from bfsim.kernel.profile import CompilerProfile, FloatLibrary, Library

COMPARISONS = tuple(f"___{each}sf2" for each in ("eq", "ne", "lt", "le", "gt", "ge", "unord"))
PARTS = ("___pack_f", "___unpack_f", "___fpcmp_parts_f", "__fpadd_parts", "___ieee754_sqrtf")
"""[libgcc] What the routines for floats call in turn: parts of them."""
SQUARE_ROOT_COMPARES = 2
"""[libgcc] The square root calls a comparison so often."""


@cache
def timing_of(profile: CompilerProfile) -> Timing:
    """Return the timing of object code in a profile."""
    if not profile.interlocks:
        return GNU
    return replace(
        ADI, routines=_integers(profile.library) | (_floats(profile.floats) if profile.floats else {})
    )


def _integers(library: Library) -> dict[str, int]:
    """Cycles of the routines that GCC calls, by their symbols, without those of the routine that each of them calls in turn."""
    unsigned, signed = library.divide_unsigned.cclk, library.divide_signed.cclk
    return {
        "___udivsi3": unsigned,
        "___divsi3": signed - unsigned,
        "___umodsi3": library.remainder_unsigned.cclk - unsigned,
        "___modsi3": library.remainder_signed.cclk - signed,
    }


def _floats(library: FloatLibrary) -> dict[str, int]:
    return {
        "___addsf3": library.add.cclk,
        "___subsf3": library.subtract.cclk,
        "___mulsf3": library.multiply.cclk,
        "___divsf3": library.divide.cclk,
        **dict.fromkeys(COMPARISONS, library.compare.cclk),
        **dict.fromkeys(("___floatsisf", "___floatunsisf"), library.from_integer.cclk),
        "___fixsfsi": library.to_integer.cclk,
        "_sqrtf": library.square_root.cclk - SQUARE_ROOT_COMPARES * library.compare.cclk,
        **dict.fromkeys(PARTS, 0),
    }
