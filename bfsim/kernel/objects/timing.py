"""The timing of object code in a profile: it depends on the profile's interlocks and library.

A profile that counts interlocks stands for Analog Devices' documents. A routine of the library then takes the average
cycles in ADI's manual, whatever instructions the compiler's own library has for it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from bfsim.blackfin.timing.tables import ADI, GNU, Timing
from bfsim.kernel.profile import CompilerProfile, FloatLibrary, Library

COMPARISONS = tuple(f"___{each}sf2" for each in ("eq", "ne", "lt", "le", "gt", "ge", "unord"))
PARTS = ("___pack_f", "___unpack_f", "___fpcmp_parts_f", "__fpadd_parts", "___ieee754_sqrtf")
"""[libgcc] Parts of the routines for floats, which these call in turn."""
SQUARE_ROOT_COMPARES = 2
"""[libgcc] How often the square root calls a comparison."""


@cache
def timing_of(profile: CompilerProfile) -> Timing:
    """Return the timing of object code in a profile."""
    if not profile.interlocks:
        return GNU
    return replace(
        ADI, routines=_integers(profile.library) | (_floats(profile.floats) if profile.floats else {})
    )


def _integers(library: Library) -> dict[str, int]:
    """Return the cycles of the routines that GCC calls, by symbol, without those of the routine that each calls in turn."""
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
