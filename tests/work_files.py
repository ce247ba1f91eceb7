"""Recorded runs as files, with something in them that is not as it was."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import zstandard

from bfsim.machine.bus import state as w
from bfsim.machine.retiming.packed_work import ACCESSES, EVENTS, OPERATIONS, PackedWork
from bfsim.machine.retiming.work import BYTE, STAMP, FrameWork
from bfsim.running.frame_file import TABLES, read, written


def unpacked(work: PackedWork) -> FrameWork:
    """Return the tables of a packed work."""
    operations, accesses, events = (
        np.column_stack([work.column(first + number, work.rows[name]) for number in range(TABLES[name])])
        .astype(np.int64)
        .reshape(-1, TABLES[name])
        for name, first in (("operations", OPERATIONS), ("accesses", ACCESSES), ("events", EVENTS))
    )
    begin = 0
    for count in operations[operations[:, 0] == w.ACCESS, 3]:
        accesses[begin : begin + count, STAMP] = np.cumsum(accesses[begin : begin + count, STAMP])
        begin += count
    accesses[:, BYTE] = np.cumsum(accesses[:, BYTE])
    events[:, 1] = np.cumsum(events[:, 1])
    return FrameWork(
        core=work.core,
        operations=operations,
        accesses=accesses.astype(np.uint32),
        events=events,
        copies=work.copies,
        calls=work.calls,
        accounts=work.accounts,
    )


def changed(work: Path, path: Path, change: Callable[[FrameWork], None]) -> Path:
    """Write a recorded run with other numbers in the second frame of core A."""
    with zipfile.ZipFile(work) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "A/000001":
                done = unpacked(read("A", zstandard.decompress(content)))
                change(done)
                content = zstandard.compress(written(done))
            new.writestr(name, content)
    return path


def rewritten(
    work: Path, path: Path, change: Callable[[dict[str, Any]], None], part: str = "run.json"
) -> Path:
    """Write a recorded run with other words on what was run."""
    with zipfile.ZipFile(work) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == part:
                run = json.loads(content)
                change(run)
                content = json.dumps(run).encode()
            new.writestr(name, content)
    return path
