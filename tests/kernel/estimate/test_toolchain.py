"""What `measured.json` says is what a bfin-elf toolchain gives; without one on PATH there is nothing to compare."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks.twins.measure import KEPT, MEASURED, measure, missing_tools

pytestmark = [
    pytest.mark.toolchain,
    pytest.mark.skipif(
        bool(missing_tools()), reason="no bfin-elf toolchain (GCC 12.2, GNU simulator 13.1) on PATH"
    ),
]


@pytest.mark.parametrize("name", ["sobel_row", "crc16_bits", "label_row", "cobs_encode"])
def test_a_measurement_repeats_to_the_cycle(name: str, tmp_path: Path) -> None:
    """Compiled, run and traced again, a kernel gives the recorded checksum, cycles and instruction classes; exported C too."""
    recorded = {
        key: value for key, value in json.loads(MEASURED.read_text())[name].items() if key not in KEPT
    }
    assert measure(name, tmp_path) == recorded
