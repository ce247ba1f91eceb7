"""Control flow, loads, stores and the stack end as under the GNU simulator: registers, flags, memory and cycles."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from benchmarks.instructions.memory_sequences import MEMORY_BYTES, translated

RECORDED = json.loads((Path(__file__).parent / "data/runs.json").read_text(encoding="utf-8"))
"""By `benchmarks/instructions/memory_sequences.py`: the programs of `control.py`, then random sequences."""


@pytest.mark.parametrize("number", range(len(RECORDED)))
def test_a_program_ends_as_under_the_gnu_simulator(number: int) -> None:
    there: dict[str, Any] = RECORDED[number]
    here = translated(bytes.fromhex(there["code"]))
    assert {name: value for name, value in here.registers.items() if value} == there["registers"]
    assert here.memory == bytes.fromhex(there["memory"]).ljust(MEMORY_BYTES, b"\0")
