"""A kernel explained line by line: its cycles are those of a run, and its totals those of the records."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from bfsim.cli.main import main
from bfsim.errors import ConfigError, FirmwareError
from bfsim.explain import explain, explain_named
from bfsim.kernel import GCC_O0, GCC_O2, VDSP_O2
from bfsim.loading.kernel_named import load_kernel
from bfsim.run import simulate
from bfsim.trace import RunRecord, StallReason
from bfsim.trace.explanation import ExplainedLine, Explanation
from tests.kernel import cost_kernels


@pytest.fixture(scope="module")
def run() -> RunRecord:
    """One frame of the built-in recording."""
    return simulate(frames=1)


def line_of(explanation: Explanation, text: str, depth: int = 0) -> ExplainedLine:
    """The row of the line that holds `text`, at a depth of loops."""
    number = next(each.line for each in explanation.lines if text in each.text)
    return next(each for each in explanation.lines if each.line == number and each.depth == depth)


def test_a_branch_shows_both_its_ways() -> None:
    """The cycles of a test span the way that skips its body and the way into it."""
    line = line_of(explain(cost_kernels.positions_above, GCC_O2), "if row[x] > limit", depth=1)
    assert (line.least_cclk, line.most_cclk) == (1 + 1 + 5, 1 + 1 + 9)  # load, compare, branch
    ways = {each.operation: each.cclk for each in line.operations if each.conditional}
    assert ways == {"branch_taken_bp": 5, "branch_not_taken_bp": 9}


def test_a_hardware_loop_costs_nothing_per_turn() -> None:
    """What sets a loop up stands outside of it; a turn of a hardware loop has no row of its own."""
    rows = [
        each
        for each in explain(cost_kernels.copy_words, GCC_O2).lines
        if each.line == cost_line("for i in range")
    ]
    assert [each.depth for each in rows] == [0]
    assert "loop_setup" in {each.operation for each in rows[0].operations}


def cost_line(text: str) -> int:
    """Number of the line of `copy_words` that holds `text`."""
    function = cost_kernels.copy_words.function
    lines = function.source.splitlines()
    return function.first_line + next(number for number, each in enumerate(lines) if text in each)


def test_interlocks_stand_beside_the_cycles() -> None:
    """The wait of a table look-up is in the cycles of its line, and by itself."""
    chip = line_of(explain(cost_kernels.relabel, VDSP_O2), "labels[i] = lut", depth=1)
    gnu = line_of(explain(cost_kernels.relabel, GCC_O2), "labels[i] = lut", depth=1)
    assert (chip.stall_cclk, gnu.stall_cclk) == (4, 0)
    assert chip.most_cclk == gnu.most_cclk + 4


def test_without_optimisation_every_variable_is_on_the_stack() -> None:
    """In gcc-O0 an addition loads both sides and stores the sum."""
    line = line_of(explain(cost_kernels.find, GCC_O0), "i += 1", depth=1)
    assert {each.operation for each in line.operations} >= {"load32", "alu", "store32"}


def test_totals_are_those_of_the_records(run: RunRecord) -> None:
    """After a run, the lines' cycles add up to the kernel's issue and stall cycles, and the calls are the records'."""
    explanation = explain_named("sobel_row", "tinyphoon", "gcc-adi", run)
    records = [each for each in run.kernels if each.kernel == "sobel_row"]
    expected = sum(
        line.issue_cclk + line.stall_cclk.get(StallReason.INTERLOCK, 0)
        for each in records
        for line in each.lines
    )
    assert sum(each.total_cclk or 0 for each in explanation.lines) == expected > 0
    assert explanation.calls == sum(each.calls for each in records) == 2 * 240


def test_a_kernel_that_did_not_run_is_told(run: RunRecord) -> None:
    """Counts of a kernel that no core ran would be empty: it says where to see which ones ran."""
    with pytest.raises(
        ConfigError, match=r"find must have run to be counted, but did not; `bfsim profile` lists"
    ):
        explain(cost_kernels.find, VDSP_O2, run.kernels)


def test_the_one_kernel_of_a_file_needs_no_name(tmp_path: Path) -> None:
    """Of several the message has the names."""
    one = "from bfsim.api import i32, kernel\n\n\n@kernel\ndef half(x: i32) -> i32:\n    return x >> 1\n"
    (tmp_path / "single.py").write_text(one)
    assert load_kernel(str(tmp_path / "single.py"), "tinyphoon").name == "half"
    (tmp_path / "double.py").write_text(one + "\n\n@kernel\ndef twice(x: i32) -> i32:\n    return x + x\n")
    with pytest.raises(
        FirmwareError,
        match=r"double.py must name one kernel, but names 2; write \S+/double.py:half or \S+/double.py:twice",
    ):
        load_kernel(str(tmp_path / "double.py"), "tinyphoon")


@pytest.mark.parametrize(
    ("name", "what"),
    [
        (
            "Sobel_rwo",
            r"Sobel_rwo must name one kernel, but names none; the nearest of \d+ are sobel_row, \w+, ",
        ),
        ("", r"^'' must name one kernel, but names none"),
        ("tinyphoon:tinyphoon", r"must name one kernel, but names none; the nearest of \d+ are"),
        (
            "clear_labels",
            r"names 2; write tinyphoon\.\w+\.blob_detection:clear_labels or tinyphoon\..*:clear_labels",
        ),
        (
            "bfsim.errors:kernel",
            "bfsim.errors must have another name: bfsim is a module of Python, of bfsim or of",
        ),
        ("no_such_package:f", "the package 'no_such_package' must be installed"),
    ],
)
def test_an_unknown_kernel_is_told(name: str, what: str) -> None:
    """The message has what is spelt nearly so, and no more of the two hundred."""
    with pytest.raises(FirmwareError, match=what):
        explain_named(name, "tinyphoon", "vdsp-O2")


def test_a_kernel_is_told_apart_by_its_module() -> None:
    """As the message says, wherever the built-in firmware lies."""
    explanation = explain_named("tinyphoon.stages.hysteresis:clear_labels", "one_eye", "vdsp-O2")
    assert explanation.file.endswith("hysteresis.py")


def test_an_unknown_profile_is_told() -> None:
    """The message lists the profiles."""
    with pytest.raises(
        ConfigError,
        match="--profile must be one of gcc-O0, gcc-O2, gcc, gcc-adi, vdsp-O2, FILE.py:NAME or PACKAGE:NAME, not 'gcc-O3'",
    ):
        explain_named("sobel_row", "tinyphoon", "gcc-O3")


def bfsim(*arguments: str) -> Result:
    """Call the command line."""
    return CliRunner().invoke(main, arguments, prog_name="bfsim")


def test_the_command_prints_a_table_and_json() -> None:
    """The table has a row per source line; the JSON has the same, with a schema."""
    table = bfsim("explain", "sobel_row", "--run", "--frames", "1").stdout
    assert "def sobel_row(" in table
    assert "Executed" in table
    assert max(map(len, table.splitlines())) <= 100
    plain = json.loads(bfsim("explain", "sobel_row", "--profile", "gcc-O2", "--json").stdout)
    assert plain["schema"] == "bfsim.explain/1"
    assert plain["profile"] == "gcc-O2"
    assert plain["calls"] is None
    assert {"line", "text", "depth", "operations", "least_cclk", "most_cclk"} <= plain["lines"][0].keys()


def test_a_division_is_in_the_total_of_its_line() -> None:
    """GCC's library divides, in 47 cycles behind the call: a line has them each time it ran, as the profile says."""
    plain = json.loads(bfsim("explain", "angle8", "--run", "--frames", "1", "--json").stdout)
    divided = [each for each in plain["lines"] if "//" in each["text"] and each["executions"]]
    assert len(divided) == 2
    for each in divided:
        assert each["most_cclk"] < 47
        own = each["total_cclk"] - 47 * each["executions"]
        assert 0.6 * each["most_cclk"] < own / each["executions"] <= each["most_cclk"]


def test_a_mistake_ends_with_one_paragraph_and_code_2() -> None:
    """No traceback, and nobody waits for a run."""
    done = bfsim("explain", "no_such_kernel", "--run")
    assert done.exit_code == 2
    assert done.stderr.startswith("bfsim: error: no_such_kernel must name one kernel")
    assert len(done.stderr) < 200
    assert done.stderr.count("\n") == 1
