"""Sequences and what the GNU simulator makes of them, as compact JSON: tests compare with it where no simulator is installed."""

from __future__ import annotations

import json
from collections.abc import Sequence as Several
from pathlib import Path

from benchmarks.instructions.sequences import Registers, Sequence


def record(path: Path, sequences: Several[Sequence], behind: Several[Registers]) -> None:
    """Write sequences with the registers that they change. Those that start alike share their registers."""
    starts: list[Registers] = []
    rows = []
    for each, after in zip(sequences, behind, strict=True):
        if each.before not in starts:
            starts.append(each.before)
        changed = {name: value for name, value in after.items() if value != each.before[name]}
        rows.append([starts.index(each.before), each.code.hex(), changed])
    lines = [json.dumps(each, separators=(",", ":")) for each in (starts, *rows)]
    path.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")


def replayed(path: Path) -> list[tuple[Sequence, Registers]]:
    """Return recorded sequences with the registers behind them."""
    starts, *rows = json.loads(path.read_text(encoding="utf-8"))
    return [
        (Sequence(bytes.fromhex(code), starts[start]), starts[start] | changed)
        for start, code, changed in rows
    ]
