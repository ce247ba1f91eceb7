"""The costed code and its cycles are the same in every process."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

from bfsim.kernel import VDSP_O2
from bfsim.kernel.estimate.costing import optimised
from tests.kernel import cost_kernels

NAMES = ("suppress", "positions_above", "store_each", "translate", "flip_cube")
PRINT = f"""
import hashlib, sys
sys.path.insert(0, sys.argv[1])
from bfsim.kernel import VDSP_O2
from bfsim.kernel.estimate.costing import optimised
from tests.kernel import cost_kernels
for name in {NAMES}:
    kernel = getattr(cost_kernels, name)
    print(hashlib.sha256(optimised(kernel.function, VDSP_O2).encode()).hexdigest(), kernel.compile(VDSP_O2).counters)
"""


def test_ir_and_counters_do_not_depend_on_hash_seed_folder_or_cache(tmp_path: Path) -> None:
    """Another process with another PYTHONHASHSEED, folder and an empty cache costs the very same code the same."""
    here = []
    for name in NAMES:
        kernel = getattr(cost_kernels, name)
        digest = hashlib.sha256(optimised(kernel.function, VDSP_O2).encode()).hexdigest()
        here.append(f"{digest} {kernel.compile(VDSP_O2).counters}")
    root = Path(__file__).parents[3]
    there = subprocess.run(
        [sys.executable, "-c", PRINT, str(root)],
        cwd=tmp_path,
        env=os.environ | {"PYTHONHASHSEED": "77", "BFSIM_CACHE_DIR": str(tmp_path)},
        check=True,
        capture_output=True,
        text=True,
    )
    assert there.stdout.splitlines() == here
