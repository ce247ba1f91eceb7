"""Variables and tables of C and assembler, which are taken to be in L1: a run says where it has no room for them."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from bfsim.run import simulate
from bfsim.trace import WarningKind
from tests.eyes import record
from tests.sums import DATA

FIRMWARE = """
from bfsim.api import Buffer, Firmware, i32, kernel_from, u8

store = kernel_from("{file}", "{name}", {parameters}, result=i32)

def with_it(core):
    while (frame := (yield from core.next_frame())) is not None:
        yield core.run(store, {arguments})

def without(core):
    while (frame := (yield from core.next_frame())) is not None:
        pass

def buffers(size):
    return {{core: [Buffer("camera", u8, 2 * size.width_px, f"sdram_bank{{bank}}", rows=2 * size.height_px)] for bank, core in enumerate("AB")}}

firmware = Firmware(mains={{"A": {a}, "B": {b}}}, buffers=buffers, camera="camera", rows=())
"""
LARGE = {
    "file": "large.o",
    "name": "store",
    "parameters": "place=i32, value=i32",
    "arguments": "1, 2",
}
SMALL = {"file": "keeping.o", "name": "add", "parameters": "value=i32", "arguments": "1"}


@pytest.mark.parametrize(
    ("what", "mains", "cores"),
    [
        (LARGE, {"a": "with_it", "b": "with_it"}, "A and B"),
        (LARGE, {"a": "without", "b": "with_it"}, "B"),
        (LARGE, {"a": "without", "b": "without"}, None),
        (SMALL, {"a": "with_it", "b": "with_it"}, None),
    ],
)
def test_tables_that_l1_has_no_room_for_are_warned_of(
    what: dict[str, str], mains: dict[str, str], cores: str | None, tmp_path: Path
) -> None:
    """3 MB took no time, and nobody was told. Only what a core runs counts, and 4 bytes have room."""
    shutil.copy(DATA / what["file"], tmp_path)
    (tmp_path / "fw_tables.py").write_text(FIRMWARE.format(**what, **mains))
    left = simulate(record(tmp_path / "drive.mcap", 1), firmware=f"{tmp_path}/fw_tables.py:firmware")
    told = [each.text for each in left.assumptions if each.kind == WarningKind.TABLES]
    assert len(told) == (cores is not None)
    for each in told:
        assert each.startswith(
            "the variables and tables of large.o (3,145,728 bytes) are assumed to be in L1"
        )
        assert f"of core {cores}: " in each
