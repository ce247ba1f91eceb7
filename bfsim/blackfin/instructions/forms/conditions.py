"""The condition bit CC: comparisons, moves to and from it, bit tests."""

from collections.abc import Iterator

from bfsim.blackfin.instructions.form import Form, Given
from bfsim.blackfin.instructions.registers import FLAGS

RELATIONS = (
    ("equal", "=="),
    ("less", "<"),
    ("less_or_equal", "<="),
    ("below", "<"),
    ("below_or_equal", "<="),
)
"""Relations in the order of their encoding; unsigned ones are followed by (IU)."""
STATUS = {place: flag for flag, place in FLAGS.items()}


def _comparisons() -> Iterator[Form]:
    for number, (relation, sign) in enumerate(RELATIONS):
        end, constant = ("", "imm3") if number < 3 else (" (IU)", "count")
        for bank, letter in enumerate("RP"):
            given: Given = {"relation": relation, "flags": 1 - bank}
            tail, text = f"{number:03b}{bank} yyy xxx", f"CC = {{x:{letter}}} {sign} "
            yield Form("compare", "0000 10" + tail, f"{text}{{y:{letter}}}{end}", given)
            yield Form("compare", "0000 11" + tail, f"{text}{{y:{constant}}}{end}", given)


def _status() -> Iterator[Form]:
    for number, sign in enumerate(("", "|", "&", "^")):
        for place in range(32):
            if place != FLAGS["CC"]:
                name = STATUS.get(place, f"ASTAT[{place} /* unused bit */]")
                given: Given = {"operator": sign, "place": place}
                yield Form(
                    "cc_from_status", f"0000 0011 0 {number:02b} {place:05b}", f"CC {sign}= {name}", given
                )
                yield Form(
                    "cc_to_status", f"0000 0011 1 {number:02b} {place:05b}", f"{name} {sign}= CC", given
                )


FORMS = (
    *_comparisons(),
    Form("compare_accumulators", "0000 1010 1000 0000", "CC = A0 == A1", {"relation": "equal"}),
    Form("compare_accumulators", "0000 1011 0000 0000", "CC = A0 < A1", {"relation": "less"}),
    Form("compare_accumulators", "0000 1011 1000 0000", "CC = A0 <= A1", {"relation": "less_or_equal"}),
    Form("register_from_cc", "0000 0010 0000 0ddd", "{d:R} = CC"),
    Form("cc_from_register", "0000 0010 0000 1sss", "CC = {s:R}"),
    Form("invert_cc", "0000 0010 0001 1000", "CC = !CC"),
    *_status(),
    Form("test_bit", "0100 1000 bbbb bddd", "CC = !BITTST ({d:R}, {b:count})", {"when": 0}),
    Form("test_bit", "0100 1001 bbbb bddd", "CC = BITTST ({d:R}, {b:count})", {"when": 1}),
)
