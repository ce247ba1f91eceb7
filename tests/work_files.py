"""Recorded runs as files, with something in them that is not as it was."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np

from bfsim.machine.bus import state as w
from bfsim.machine.retiming.packed_work import (
    BYTE_STEP,
    ENTRY,
    PACKED,
    STEP,
    PackedWork,
)
from bfsim.machine.retiming.work import (
    ACCESS_COLUMNS,
    BYTE,
    KIND,
    OWNER,
    SITE,
    STAMP,
    FrameWork,
)
from bfsim.running.frame_file import read, written
from bfsim.running.work_file import compressed, decompressed


def unpacked(work: PackedWork) -> FrameWork:
    """Return the tables of a packed work."""
    of_operations, operation_dictionary, packed, access_dictionary, events = (
        np.column_stack([work.column(first + number, work.rows[name]) for number in range(PACKED[name])])
        .astype(np.int64)
        .reshape(-1, PACKED[name])
        for name, first in zip(PACKED, accumulate(PACKED.values(), initial=0), strict=False)
    )
    operations = operation_dictionary[of_operations[:, 0]]
    copies = operations[:, 0] == w.COPY
    operations[copies, 1] = np.cumsum(operations[copies, 1])
    accesses = np.empty((len(packed), ACCESS_COLUMNS), np.int64)
    accesses[:, [KIND, OWNER, SITE]] = access_dictionary[packed[:, ENTRY]]
    begin = 0
    for count in operations[operations[:, 0] == w.ACCESS, 3]:
        accesses[begin : begin + count, STAMP] = np.cumsum(packed[begin : begin + count, STEP])
        begin += count
    accesses[:, BYTE] = np.cumsum(packed[:, BYTE_STEP])
    events[:, 1] = np.cumsum(events[:, 1])
    return FrameWork(
        core=work.core,
        operations=operations,
        accesses=accesses.astype(np.uint32),
        events=events,
        copies=work.copies,
        calls=work.calls,
        accounts=work.accounts,
        stages=work.stages,
        results=work.results,
    )


def changed(work: Path, path: Path, change: Callable[[FrameWork], None]) -> Path:
    """Write a recorded run with other numbers in the second frame of core A."""
    with zipfile.ZipFile(work) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "A/000001":
                done = unpacked(read("A", decompressed(content)))
                change(done)
                content = compressed(written(done))
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
