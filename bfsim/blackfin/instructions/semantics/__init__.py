"""What forms do, as functions of `Effects` and the operands of a form, whose names are the letters of its bits."""

from collections.abc import Callable
from inspect import isfunction

from bfsim.blackfin.instructions.semantics import (
    accumulators,
    arithmetic,
    bitfields,
    conditions,
    control,
    immediates,
    loads,
    loads_dag,
    moves,
    multiplications,
    selections,
    shifts,
    sums,
    system,
    video,
)

MODULES = (
    *(control, moves, immediates, conditions, arithmetic, loads, loads_dag, system),
    *(multiplications, accumulators, video, bitfields),
)
SEMANTICS: dict[str, Callable[..., None]] = {
    name: each
    for module in MODULES
    for name, each in vars(module).items()
    if isfunction(each) and each.__module__ == module.__name__ and not name.startswith("_")
} | {**sums.SEMANTICS, **selections.SEMANTICS, **shifts.SEMANTICS}
