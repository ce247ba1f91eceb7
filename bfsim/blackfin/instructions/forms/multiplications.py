"""dsp32mult and dsp32mac: a row for each pair of things that the two multipliers may do at once.

Letters: d s t registers, m the mode, x (M), which is for MAC1 alone; of MAC1 o its operation and a, b the halves of its factors, of
MAC0 n and c, e.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from bfsim.blackfin.instructions.form import Beside, Form
from bfsim.blackfin.instructions.multipliers import ADDS, EXTRACTS, MOVES, MULTIPLIES, RESTS

WRITING = {EXTRACTS, MOVES, MULTIPLIES}
WITHOUT_FACTORS = {RESTS, MOVES}

LETTERS = {1: ("o", "a", "b"), 0: ("n", "c", "e")}
DESTINATIONS = {(1, 0): "{d:R}.H", (0, 0): "{d:R}.L", (1, 1): "{d:odd}", (0, 1): "{d:even}"}
"""By multiplier, and whether it writes whole registers, which are then a pair."""


def _text(mac: int, does: str, wide: int) -> str:
    operation, first, second = LETTERS[mac]
    factors = f"{{s:R}}.{{{first}:half}} * {{t:R}}.{{{second}:half}}"
    change = f"A{mac} {{{operation}:assign}} {factors}"
    if does == ADDS:
        return change
    return (
        f"{DESTINATIONS[mac, wide]} = "
        + {EXTRACTS: f"({change})", MOVES: f"A{mac}", MULTIPLIES: factors}[does]
    )


def _bits(mac: int, does: str, product: bool) -> tuple[str, str, str]:
    """Return the bits of its operation, of whether it writes, and of the halves of its factors."""
    operation, first, second = LETTERS[mac]
    return (
        "00" if product else 2 * operation if does in {ADDS, EXTRACTS} else "11",
        str(int(does in WRITING)),
        "--" if does in WITHOUT_FACTORS else first + second,
    )


def _form(mac1: str, mac0: str, wide: int, mixed: str) -> Form:
    """Return the row of two multipliers; `mixed`: the bit of (M), or the letter x."""
    product = MULTIPLIES in {mac1, mac0}
    (operation1, writes1, halves1), (operation0, writes0, halves0) = (
        _bits(mac, does, product) for mac, does in ((1, mac1), (0, mac0))
    )
    writes = not WRITING.isdisjoint({mac1, mac0})
    family = "01" if product else "00"
    destination = "---" if not writes else "dd0" if wide else "ddd"
    factors = "--- ---" if {mac1, mac0} <= WITHOUT_FACTORS else "sss ttt"
    mode = ("wide_product_mode" if product else "wide_mode") if wide else "mode" if writes else "sum_mode"
    texts = [_text(mac, does, wide) for mac, does in ((1, mac1), (0, mac0)) if does != RESTS]
    return Form(
        "multiply_accumulate",
        f"1100 -{family}m mmm{mixed} {wide}{writes1}{operation1} {halves1}{writes0}{operation0}{halves0}{destination}{factors}",
        ("{x:mixed}, " if mixed == "x" else ", ").join(texts)
        + f"{{m:{'mixed_' if mixed == '1' else ''}{mode}}}",
        {"mac1": mac1, "mac0": mac0, "wide": wide, **({} if mixed == "x" else {"x": int(mixed)})},
        Beside.DSP,
    )


def _forms(kinds: tuple[str, ...]) -> Iterator[Form]:
    for mac1, mac0, wide in product(kinds, kinds, (0, 1)):
        writes = not WRITING.isdisjoint({mac1, mac0})
        if mac1 == mac0 == RESTS or (wide and not writes):
            continue
        # (M) is part of the mode if MAC1 is alone, and follows MAC1 if it is not.
        for each in "0" if mac1 in WITHOUT_FACTORS else "01" if mac0 == RESTS else "x":
            yield _form(mac1, mac0, wide, each)


FORMS = (
    *_forms((RESTS, ADDS, EXTRACTS, MOVES)),
    *_forms((RESTS, MULTIPLIES)),
)
