"""Loads and stores through pointer registers."""

from collections.abc import Iterator

from bfsim.blackfin.instructions.form import Beside, Form, Given

WORD, POINTER, HALF, HALF_SIGNED, BYTE, BYTE_SIGNED = (
    ("{d:R} = [%s]", "00", 0, {"nbytes": 4}),
    ("{d:P} = [%s]", "00", 1, {"nbytes": 4}),
    ("{d:R} = W[%s] (Z)", "01", 0, {"nbytes": 2}),
    ("{d:R} = W[%s] (X)", "01", 1, {"nbytes": 2, "signed": 1}),
    ("{d:R} = B[%s] (Z)", "10", 0, {"nbytes": 1}),
    ("{d:R} = B[%s] (X)", "10", 1, {"nbytes": 1, "signed": 1}),
)
LOADS = (WORD, POINTER, HALF, HALF_SIGNED, BYTE, BYTE_SIGNED)
STORES = (
    ("[%s] = {d:R}", "00", 0, {"nbytes": 4}),
    ("[%s] = {d:P}", "00", 1, {"nbytes": 4}),
    ("W[%s] = {d:R}", "01", 0, {"nbytes": 2}),
    ("B[%s] = {d:R}", "10", 0, {"nbytes": 1}),
)
"""Text with the place of the address, bits of the size, bit of the kind, what the semantics must know."""


def _stepping() -> Iterator[Form]:
    """Yield accesses through a pointer, which may step on or back afterwards."""
    for number, (sign, direction) in enumerate((("++", 1), ("--", -1), ("", 0))):
        for is_store, rows in enumerate((LOADS, STORES)):
            for text, size, kind, given in rows:
                bits = f"1001 {size}{is_store}{number:02b}{kind} ppp ddd"
                step = {"step": direction * given["nbytes"]}
                is_twice = direction and text is POINTER[0]
                yield Form(
                    "store" if is_store else "load",
                    bits,
                    text % f"{{p:P}}{sign}",
                    given | step,
                    Beside.FIRST,
                    only=(lambda p, d: p != d) if is_twice else None,
                )


def _with_offset() -> Iterator[Form]:
    """Yield accesses at an offset from a pointer: of 16 bits, or of 4."""
    for is_store, rows in enumerate((LOADS, STORES)):
        for text, size, kind, given in rows:
            scale = f"x{given['nbytes']}".replace("x1", "")
            bits = f"1110 01{is_store}{kind} {size} ppp ddd nnnn nnnn nnnn nnnn"
            yield Form("store" if is_store else "load", bits, text % f"{{p:P}} + {{n:imm16{scale}}}", given)
    for number, row in enumerate((WORD, HALF, HALF_SIGNED, POINTER)):
        yield _near(0, number, row)
    for number, row in ((0, STORES[0]), (1, STORES[2]), (3, STORES[1])):
        yield _near(1, number, row)


def _near(is_store: int, number: int, row: tuple[str, str, int, Given]) -> Form:
    text, _, _, given = row
    bits = f"101{is_store} {number:02b}nn nn ppp ddd"
    place = f"{{p:P}} + {{n:count{given['nbytes']}}}"
    return Form("store" if is_store else "load", bits, text % place, given, Beside.FIRST)


def _indexed() -> Iterator[Form]:
    """Yield accesses through a pointer that then steps by another; with one for both, halves of registers do not step."""
    halves: tuple[tuple[str, str, Given], ...] = (("01", "L", {"half": "low"}), ("10", "H", {"half": "high"}))
    for place, only in (("{p:P}", _is_one), ("{p:P} ++ {i:P}", None)):
        for bits, letter, given in halves:
            code, half, at = f"{bits}d ddii ippp", f"{{d:R}}.{letter}", f"W[{place}]"
            yield Form("load_half", f"1000 0{code}", f"{half} = {at}", given, Beside.FIRST, only, "{i:P}")
            yield Form("store_half", f"1000 1{code}", f"{at} = {half}", given, Beside.FIRST, only, "{i:P}")
    for bits, does, (text, _, _, known) in (
        ("000", "load", WORD),
        ("100", "store", STORES[0]),
        ("011", "load", HALF),
        ("111", "load", HALF_SIGNED),
    ):
        yield Form(does, f"1000 {bits}d ddii ippp", text % "{p:P} ++ {i:P}", known, Beside.FIRST)


def _is_one(d: str, p: str, i: str) -> bool:
    return i == p


FORMS = (
    *_stepping(),
    Form("load", "1011 100n nnnn dddd", "{d:RP} = [FP {n:frame}]", {"nbytes": 4, "p": "FP"}, Beside.FIRST),
    Form("store", "1011 101n nnnn dddd", "[FP {n:frame}] = {d:RP}", {"nbytes": 4, "p": "FP"}, Beside.FIRST),
    *_with_offset(),
    *_indexed(),
)
