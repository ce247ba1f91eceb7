"""Every form is printed as GNU objdump prints it, and no bytes make the decoder fail."""

from __future__ import annotations

import json
import random
from pathlib import Path

from benchmarks.instructions.printed import plain
from bfsim.blackfin.instructions.decode import InstructionError, decode
from bfsim.blackfin.instructions.form import Beside
from bfsim.blackfin.instructions.forms import TABLE
from bfsim.blackfin.instructions.text import text

RECORDED = json.loads((Path(__file__).parent / "data/text.json").read_text(encoding="utf-8"))
"""Address, bytes and objdump's text of one instruction of each form, by `benchmarks/instructions/printed.py`."""


def test_one_instruction_of_each_form_is_printed_as_objdump_does() -> None:
    printed = {code: plain(text(decode(bytes.fromhex(code) + bytes(4), at))) for at, code, _ in RECORDED}
    assert len(RECORDED) == len(TABLE)
    assert printed == {code: line for _, code, line in RECORDED}


def test_bytes_are_an_instruction_or_refused() -> None:
    """All first halfwords, each with others behind it by chance."""
    chance = random.Random(1)
    refused = 0
    for first in range(1 << 16):
        code = first.to_bytes(2, "little") + chance.randbytes(6)
        try:
            text(decode(code, 0))
        except InstructionError:
            refused += 1
    assert 0 < refused < 1 << 15


def test_places_in_a_bundle_are_sets() -> None:
    """Python 3.11.2 makes an `object()` of an enumeration's empty tuple, in which nothing can be looked for."""
    firsts = [1 in each.value for each in (Beside.ALONE, Beside.DSP, Beside.FIRST, Beside.EITHER)]
    assert firsts == [False, False, True, True]
    assert all(isinstance(each.value, frozenset) for each in Beside)
