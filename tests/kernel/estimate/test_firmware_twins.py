"""C twins of the firmware's hot kernels: the same bits on the calls of a real run, and cycles as near as is said."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks.firmware_accuracy import compare, covered, frame_error
from benchmarks.firmware_twins.measure import MEASURED, build, measure
from benchmarks.firmware_twins.measured import measured
from benchmarks.firmware_twins.recorded import SAMPLES, recorded
from benchmarks.firmware_twins.twins import TWINS, predict
from benchmarks.twins.measure import missing_tools, traced
from bfsim.compiling.toolchain import blackfin_toolchain
from bfsim.kernel import GCC_O2
from tinyphoon.stages.hysteresis import group_edges_row
from tinyphoon.stages.line_scan import segments_row


@pytest.mark.exhaustive
def test_every_twin_leaves_what_its_kernel_leaves() -> None:
    """On all recorded calls, arrays and results: the Blackfin code in every variant, and the compiled Python."""
    found = {each.name: predict(each, recorded()[each], GCC_O2).checksum for each in TWINS}
    assert found == {name: each.checksum for name, each in measured().items()}


@pytest.mark.exhaustive
def test_the_twins_are_nearly_all_of_a_frame() -> None:
    """At least 97 % of the issue cycles of both cores."""
    assert covered(compare("O2"), "O2") >= 97


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    ("level", "variant", "signed", "by_share"),
    [("O2", "inlined", 3, 5), ("O2", "calls", 2, 5), ("O2", "one_file", 2, 7), ("O0", "O0", 1, 1)],
)
def test_the_frame_is_as_near_as_is_said(level: str, variant: str, signed: float, by_share: float) -> None:
    """Error of a frame's issue cycles in percent: with its sign, and each kernel's by its share."""
    found = frame_error(compare(level), variant)
    assert abs(found.signed) <= signed
    assert found.by_share <= by_share


@pytest.mark.exhaustive
def test_the_sample_is_spread_over_the_run() -> None:
    """A kernel that runs on every row of both cores has calls of both, up to the limit, and its true number of calls."""
    calls = recorded()[group_edges_row]
    assert calls.per_frame == 2 * 240
    assert SAMPLES < len(calls.arguments) <= 2 * SAMPLES
    rows = [each[3] for each in calls.arguments]
    assert len(set(rows)) >= 10


def test_a_length_is_a_parameter_of_the_twin_if_the_kernel_or_a_helper_asks_for_it() -> None:
    """`segments_row` passes `above` to a helper that asks for its length; it asks for none itself."""
    assert segments_row.function.measured == {"above"}


@pytest.mark.toolchain
@pytest.mark.skipif(
    bool(missing_tools()), reason="no bfin-elf toolchain (GCC 12.2, GNU simulator 13.1) on PATH"
)
@pytest.mark.parametrize("name", ["grey_row", "segment_row"])
def test_a_measurement_repeats_to_the_cycle(name: str, tmp_path: Path) -> None:
    """Compiled and run again, a twin gives the recorded checksum and the cycles of every call in every variant."""
    kernel = next(each for each in TWINS if each.name == name)
    assert measure(kernel, tmp_path) == json.loads(MEASURED.read_text(encoding="utf-8"))[name]


@pytest.mark.toolchain
@pytest.mark.skipif(
    bool(missing_tools()), reason="no bfin-elf toolchain (GCC 12.2, GNU simulator 13.1) on PATH"
)
def test_the_cycles_of_a_call_are_those_of_its_instructions(tmp_path: Path) -> None:
    """From the first one to RTS, as the trace of the simulator has them; what the harness itself takes is not in them."""
    kernel = next(each for each in TWINS if each.name == "take_right_row")
    program = build(kernel, "calls", tmp_path, blackfin_toolchain())
    assert traced(program, kernel.name)["cycles"] == sum(measured()[kernel.name].cycles["calls"])
