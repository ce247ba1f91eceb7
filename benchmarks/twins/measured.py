"""What the Blackfin code of the twins was measured to cost, and how classes of operations are compared."""

from __future__ import annotations

import json
from collections import Counter as Tally
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any

MEASURED = Path(__file__).parent / "measured.json"

# Names of operations, the simulator's and ours, by the class in which they are compared.
CLASSES: dict[str, tuple[str, ...]] = {
    "loads": ("load8", "load16", "load32"),
    "stores": ("store8", "store16", "store32"),
    "ALU": ("alu", "dsp_alu", "add_shift", "bit_op", "acc_add", "zero"),
    "shifts": ("shift", "acc_shift"),
    "multiplies": ("mul16", "mul32", "mac"),
    "moves": ("move", "imm", "imm32", "imm_half", "extend", "cond_move", "cc_move", "acc_move"),
    "compares": ("compare", "bit_test"),
    "taken": ("branch_taken", "branch_taken_bp"),
    "not taken": ("branch_not_taken", "branch_not_taken_bp"),
    "calls": ("call", "ret", "jump"),
}
CLASS_OF = {name: group for group, names in CLASSES.items() for name in names}


class Role(StrEnum):
    """What a kernel was for when it was first measured.

    Rules were made for the reference kernels and from those to fit. A held-out one was new: nobody had looked at what GCC makes
    of it, and the error of that moment is kept (`FirstSight`). Rules may have been learnt from it since; it stays held out.
    """

    REFERENCE = "reference"
    FIT = "fit"
    HELD_OUT = "held-out"


@dataclass(frozen=True, slots=True)
class FirstSight:
    """By how much a held-out kernel was off when it was first measured, in percent by level.

    `commit`: of the model, made `at` this time (ISO 8601). The kernels of one commit are a batch.
    """

    commit: str
    at: str
    percent: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Measured:
    """One kernel: its checksum, and by level (O0, O2) its cycles and how often each kind of operation ran.

    `first_sight` is None unless it was held out.
    """

    name: str
    role: Role
    first_sight: FirstSight | None
    checksum: str
    cycles: dict[str, int]
    operations: dict[str, dict[str, int]]


@cache
def measured() -> dict[str, Measured]:
    """Read all measurements, by kernel."""
    rows = json.loads(MEASURED.read_text())
    return {name: _measured(name, row) for name, row in rows.items()}


def _measured(name: str, row: Mapping[str, Any]) -> Measured:
    levels, first = row["levels"], row.get("first_sight")
    return Measured(
        name=name,
        role=Role(row["role"]),
        first_sight=FirstSight(first["commit"], first["at"], {level: first[level] for level in levels})
        if first
        else None,
        checksum=row["checksum"],
        cycles={level: found["cycles"] for level, found in levels.items()},
        operations={level: found["mix_detail"] for level, found in levels.items()},
    )


def by_class(operations: Mapping[str, int]) -> Tally[str]:
    """Add up kinds of operations to classes; set-up of loops and stack frames is in none."""
    sums: Tally[str] = Tally()
    for name, count in operations.items():
        if name in CLASS_OF:
            sums[CLASS_OF[name]] += count
    return sums
