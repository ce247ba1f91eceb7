"""The data address generators: index registers that step through circular buffers, and accesses through them."""

from collections.abc import Iterator

from bfsim.blackfin.instructions.form import Beside, Form, Given

STEPS = (("++", "00", 1), ("--", "01", -1), ("", "10", 0))
HALVES = (("", "[%s]", 4, "whole"), (".L", "W[%s]", 2, "low"), (".H", "W[%s]", 2, "high"))


def _accesses() -> Iterator[Form]:
    for number, (part, place, nbytes, half) in enumerate(HALVES):
        for sign, bits, direction in STEPS:
            given: Given = {"half": half, "step": direction * nbytes}
            at, register = place % f"{{i:I}}{sign}", f"{{d:R}}{part}"
            tail = f"{bits} {number:02b} ii ddd"
            yield Form("load_indexed", f"1001 110{tail}", f"{register} = {at}", given, Beside.EITHER)
            yield Form("store_indexed", f"1001 111{tail}", f"{at} = {register}", given, Beside.EITHER)


FORMS = (
    *(
        Form(
            "modify_index",
            f"1001 1111 0110 {code:02b}ii",
            f"{{i:I}} {sign}= 0x{nbytes}",
            {"step": step},
            Beside.FIRST,
        )
        for code, sign, nbytes, step in ((0, "+", 2, 2), (1, "-", 2, -2), (2, "+", 4, 4), (3, "-", 4, -4))
    ),
    Form("modify_index_by_register", "1001 1110 0110 mmii", "{i:I} += {m:M}", {"sign": 1}, Beside.FIRST),
    Form("modify_index_by_register", "1001 1110 0111 mmii", "{i:I} -= {m:M}", {"sign": -1}, Beside.FIRST),
    Form("modify_index_reversed", "1001 1110 1110 mmii", "{i:I} += {m:M} (BREV)", {}, Beside.FIRST),
    *_accesses(),
    Form("load_indexed", "1001 1101 1mmi iddd", "{d:R} = [{i:I} ++ {m:M}]", {"half": "whole"}, Beside.EITHER),
    Form(
        "store_indexed", "1001 1111 1mmi iddd", "[{i:I} ++ {m:M}] = {d:R}", {"half": "whole"}, Beside.EITHER
    ),
)
