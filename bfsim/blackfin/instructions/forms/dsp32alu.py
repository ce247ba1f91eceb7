"""What all rows of dsp32alu have in common."""

from __future__ import annotations

from bfsim.blackfin.instructions.form import Beside, Form


def dsp32alu(does: str, bits: str, text: str, **given: int | str) -> Form:
    """Return a row; `bits`: from bit 21 on, the half of the result. Results in d and e must be in two different registers."""
    return Form(does, f"1100 -100 00 {bits}", text, given, Beside.DSP, _different if "e" in bits else None)


def _different(d: str, e: str, **_: object) -> bool:
    return d != e
