"""The names of the Blackfin's operations (`bfsim.kernel.operations.Op`) and library routines in sentences."""

from __future__ import annotations

PREDICTED, MISPREDICTED = "branch taken as predicted", "branch mispredicted"

WORDS = {
    "load8": "load of 8 bits",
    "load16": "load of 16 bits",
    "load32": "load of 32 bits",
    "store8": "store of 8 bits",
    "store16": "store of 16 bits",
    "store32": "store of 32 bits",
    "alu": "addition or logic",
    "dsp_alu": "minimum, maximum or magnitude",
    "shift": "shift",
    "add_shift": "addition with shift",
    "mul16": "multiplication of 16 bits",
    "mac": "multiplication and addition",
    "mul32": "multiplication of 32 bits",
    "move": "move",
    "imm": "constant",
    "imm32": "constant of 32 bits",
    "extend": "extension to 32 bits",
    "compare": "comparison",
    "bit_test": "test of a bit",
    "cond_move": "conditional move",
    "cc_move": "move of a condition",
    "loop_setup": "set-up of a hardware loop",
    "branch_taken": MISPREDICTED,
    "branch_not_taken": "branch not taken, as predicted",
    "branch_taken_bp": PREDICTED,
    "branch_not_taken_bp": MISPREDICTED,
    "jump": "jump",
    "call": "call",
    "tail_call": "call at the end",
    "nop": "NOP",
    "library": "fill by the library",
    "ret": "return",
    "link": "set-up of a stack frame",
    "unlink": "end of a stack frame",
    "push": "push",
    "pop": "pop",
    "push_multiple": "push of several registers",
    "pop_multiple": "pop of several registers",
}
"""By `Op`; both kinds of mispredicted branches cost the same."""

ROUTINES = {
    **dict.fromkeys(("__divsi3", "__udivsi3"), "division"),
    **dict.fromkeys(("__modsi3", "__umodsi3"), "remainder"),
    "__addsf3": "float addition",
    "__subsf3": "float subtraction",
    "__mulsf3": "float multiplication",
    "__divsf3": "float division",
    **dict.fromkeys((f"__{each}sf2" for each in ("eq", "ne", "lt", "le", "gt", "ge", "unord")), "float comparison"),
    **dict.fromkeys(("__floatsisf", "__floatunsisf"), "conversion to float"),
    "__fixsfsi": "conversion from float",
    "sqrtf": "float square root",
}  # fmt: skip
"""The names of the routines in GCC's library, by those in estimates."""


def is_routine(name: str) -> bool:
    """Whether an operation is a library routine: those have a name that no other operation has."""
    return bool(name) and name not in WORDS


def words(name: str) -> str:
    """Return the name of an operation."""
    return f"library {ROUTINES.get(name, name)}" if is_routine(name) else WORDS.get(name, "operations")
