"""What the C twins of the firmware's kernels were measured to cost, call by call."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

MEASURED = Path(__file__).parent / "measured.json"


@dataclass(frozen=True, slots=True)
class Measured:
    """One kernel: checksum of what its recorded calls leave, and the cycles of each call by variant (`c/twin.h`)."""

    checksum: str
    cycles: Mapping[str, tuple[int, ...]]


def measured() -> Mapping[str, Measured]:
    """Read all measurements, by kernel."""
    rows = json.loads(MEASURED.read_text(encoding="utf-8"))
    return {name: _measured(row["checksum"], row["cycles"]) for name, row in rows.items()}


def _measured(checksum: str, cycles: Mapping[str, list[int]]) -> Measured:
    return Measured(checksum, {variant: tuple(each) for variant, each in cycles.items()})
