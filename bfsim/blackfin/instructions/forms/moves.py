"""Register moves, conditional moves, and the stack."""

from bfsim.blackfin.instructions.form import Form
from bfsim.blackfin.instructions.registers import ACCUMULATOR_PARTS, DAG, DATA, POINTERS

GENERAL = {*DATA, *POINTERS}


def _can_move(d: str, s: str) -> bool:
    """Whether a register can move to another: one is general, or both belong to the address generators or to emulation."""
    if s in GENERAL or d in GENERAL or d == "EMUDAT" or s in ACCUMULATOR_PARTS:
        return True
    if s in DAG and d in {*DAG, *ACCUMULATOR_PARTS}:
        return True
    return (s == "EMUDAT" and d not in ACCUMULATOR_PARTS) or (s == "USP" and d not in DAG)


FORMS = (
    Form("move", "0011 ddds ssdd dsss", "{d:any} = {s:any}", only=_can_move),
    Form("move_if", "0000 0110 dsdd dsss", "IF !CC {d:RP} = {s:RP}", {"when": 0}),
    Form("move_if", "0000 0111 dsdd dsss", "IF CC {d:RP} = {s:RP}", {"when": 1}),
    Form("pop", "0000 0001 00gg gggg", "{g:any} = [SP++]", only=lambda g: g not in GENERAL),
    Form("push", "0000 0001 01gg gggg", "[--SP] = {g:any}", only=lambda g: g != "SP"),
    Form(
        "pop_multiple",
        "0000 0101 10dd dppp",
        "(R7:{d:decimal}, P5:{p:decimal}) = [SP++]",
        only=lambda d, p: p < 6,
    ),
    Form("pop_multiple", "0000 0101 00dd d000", "(R7:{d:decimal}) = [SP++]"),
    Form("pop_multiple", "0000 0100 1000 0ppp", "(P5:{p:decimal}) = [SP++]", only=lambda p: p < 6),
    Form(
        "push_multiple",
        "0000 0101 11dd dppp",
        "[--SP] = (R7:{d:decimal}, P5:{p:decimal})",
        only=lambda d, p: p < 6,
    ),
    Form("push_multiple", "0000 0101 01dd d000", "[--SP] = (R7:{d:decimal})"),
    Form("push_multiple", "0000 0100 1100 0ppp", "[--SP] = (P5:{p:decimal})", only=lambda p: p < 6),
)
