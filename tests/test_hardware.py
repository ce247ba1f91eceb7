"""Boards and compilers from a user's own files: found like firmware, checked like what ships, in the identity."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from bfsim.chip.boards import BOARDS, CM_BF561
from bfsim.cli.main import main
from bfsim.errors import ConfigError
from bfsim.kernel.profile import DEFAULT
from bfsim.loading.hardware import find_board, find_profile
from bfsim.run import simulate
from tests.conftest import Write
from tests.eyes import FIRMWARE, record

MINE = """\
from dataclasses import replace
from fractions import Fraction

from bfsim.chip.boards import CM_BF561
from bfsim.kernel import VDSP_O2

FAST = replace(CM_BF561, title="CL 2", sdram=replace(CM_BF561.sdram, nCL=2))
PLAIN = replace(VDSP_O2, parallel_issue=False)
"""


def test_a_board_in_a_file_or_package_is_found(write: Write) -> None:
    """By its name, or alone where the module has one of its own; what it imports of the shipped ones is not counted."""
    write("mine.py", MINE)
    write("there/robot/__init__.py", "")
    write("there/robot/boards.py", MINE)
    for name, called in (
        ("mine.py:FAST", "mine:FAST"),
        ("mine.py", "mine:FAST"),
        ("mine", "mine:FAST"),
        ("mine:FAST", "mine:FAST"),
        ("there/robot/boards.py:FAST", "robot.boards:FAST"),
    ):
        found = find_board(name)
        assert (found.value.name, found.value.sdram.nCL) == (called, 2)
        assert found.files[-1].endswith(("mine.py", "boards.py"))
    found = find_profile("mine.py:PLAIN")
    assert (found.value.name, found.value.parallel_issue, found.files) == ("mine:PLAIN", False, ("mine.py",))
    assert find_profile("mine").value == found.value


def test_what_ships_is_not_met_by_a_file_of_its_name(write: Write) -> None:
    """Neither a file beside nor a module called like bfsim's."""
    write("cm-bf561.py", MINE)
    write("bfsim.py", MINE)
    assert find_board("cm-bf561").value == CM_BF561
    assert find_board("cm-bf561.py").value.name == "cm-bf561:FAST"
    with pytest.raises(ConfigError, match="bfsim is a module of Python, of bfsim or of"):
        find_board("bfsim.py:FAST")


def test_a_board_given_must_not_pass_for_a_shipped_one() -> None:
    """Its name is all that a reader of a report sees."""
    changed = replace(CM_BF561, sdram=replace(CM_BF561.sdram, nCL=2))
    with pytest.raises(ConfigError, match="a board must have a name of its own, not cm-bf561"):
        find_board(changed)
    assert find_board(replace(changed, name="mine")).value.name == "mine"
    assert find_board(CM_BF561) == find_board("cm-bf561")


def test_an_edit_is_seen_and_changes_the_digest(write: Write) -> None:
    """Of the file itself and of one that it imports, also where the numbers stay."""
    write("mine.py", "from parts import CL\n" + MINE.replace("nCL=2", "nCL=CL"))
    digests = set()
    for text, cl in (("CL = 2\n", 2), ("CL = 3\n", 3), ("CL = 3  # as measured\n", 3)):
        write("parts.py", text)
        found = find_board("mine.py:FAST")
        assert (found.value.sdram.nCL, found.files) == (cl, ("mine.py", "parts.py"))
        digests |= {found.digest, find_profile("mine.py:PLAIN").digest}
    assert len(digests) == 6


def test_settings_stand_in_the_name_and_the_digest() -> None:
    """In one way, however and in whatever order they were written."""
    one = find_board("cm-bf561", {"sdram.trp": "3", "clocks.cclk_hz": "500e6"})
    two = find_board("cm-bf561", {"clocks.CCLK_HZ": 500_000_000, "sdram.nRP": 3})
    assert one == two
    assert one.value.name == "cm-bf561 --set clocks.cclk_hz=500000000 --set sdram.nRP=3"
    assert one.digest != find_board("cm-bf561").digest
    digests = {find_board(name).digest for name in BOARDS}
    assert len(digests) == len(BOARDS)


@pytest.mark.parametrize(
    ("line", "name", "problem"),
    [
        ("", "mine.py:NONE", "--board: NONE must be a bfsim.chip.spec.BoardSpec, but is missing .*; built in are cm-bf561, "),
        ("", "mine.py:PLAIN", "PLAIN must be a bfsim.chip.spec.BoardSpec, but is a CompilerProfile"),
        ("", "nowhere.py:FAST", "nowhere.py must be a file, but there is none"),
        ("", "nowhere", "the package 'nowhere' must be installed or in the folder .*; built in are cm-bf561, "),
        ("", "a b", "--board must be one of cm-bf561, .*, cm-bf533, FILE.py:NAME or PACKAGE:NAME, not 'a b'"),
        ("", "x" * 9000, "the package"),
        ("SLOW = FAST", "mine.py", "must be followed by :NAME unless the module has one BoardSpec, but it has FAST and SLOW"),
        ("1 / 0", "mine.py:FAST", r"importing mine failed with ZeroDivisionError: .* \(.*mine.py:9\)"),
        ("raise SystemExit(0)", "mine.py:FAST", "importing mine failed with SystemExit"),
        ("BAD = replace(FAST, spi_clk_hz=1e7)", "mine.py:BAD", "--board mine:BAD: board.spi_clk_hz must be of the type Fraction"),
        ("BAD = replace(FAST, sdram=replace(FAST.sdram, nCL=9))", "mine.py:BAD", "--board mine:BAD: sdram.nCL must be 2 to 3, not 9"),
        ("BAD = replace(FAST, pll=replace(FAST.pll, ssel=6))", "mine.py:BAD", "--board mine:BAD: clocks must be those that the pll"),
    ],
)  # fmt: skip
def test_what_is_no_board_is_told(write: Write, line: str, name: str, problem: str) -> None:
    """What must be there, what is, and in which file."""
    write("mine.py", MINE + line + "\n")
    with pytest.raises(ConfigError, match=problem) as caught:
        find_board(name)
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ("push_multiple_cclk=2.5", r"--profile mine:BAD: profile.push_multiple_cclk must be of the type int \| None, not 2.5"),
        ("push_multiple_cclk=-1", "--profile mine:BAD: profile.push_multiple_cclk must be 0 to 1,000,000 cycles, not -1"),
        ("inlines='file'", "profile.inlines must be of the type Inlines"),
        ("library=None", "profile.library must be of the type Library, not None"),
        ("library=replace(PLAIN.library, divide_signed=replace(PLAIN.library.divide_signed, cclk=10**7))",
         "profile.library.divide_signed.cclk must be 0 to 1,000,000 cycles, not 10,000,000"),
    ],
)  # fmt: skip
def test_what_is_no_compiler_is_told(write: Write, change: str, problem: str) -> None:
    """With the field."""
    write("mine.py", f"{MINE}BAD = replace(PLAIN, {change})\n")
    with pytest.raises(ConfigError, match=problem):
        find_profile("mine.py:BAD")


def test_a_run_has_them_in_its_identity(write: Write, tmp_path: Path) -> None:
    """Names, settings, files and digests; a slower SDRAM and a plainer compiler cost cycles."""
    write("mine.py", MINE)
    write("fw_eyes.py", FIRMWARE)
    how = {"recording": record(tmp_path / "drive.mcap", 1), "firmware": "fw_eyes:eyes"}
    usual = simulate(**how)
    assert (usual.identity.board, usual.identity.compiler) == ("cm-bf561", DEFAULT.name)
    assert (usual.identity.board_files, usual.identity.compiler_files) == ((), ())
    own = simulate(**how, board="mine.py:FAST", profile="mine.py:PLAIN", settings={"pll.ssel": 10})
    identity = own.identity
    assert (identity.board, identity.compiler) == ("mine:FAST --set pll.ssel=10", "mine:PLAIN")
    assert (identity.board_files, identity.compiler_files) == (("mine.py",), ("mine.py",))
    assert identity.sclk_hz == 60e6
    assert identity.board_digest != usual.identity.board_digest
    assert identity.compiler_digest != usual.identity.compiler_digest
    assert own.frames[0].result_cclk > usual.frames[0].result_cclk
    given = simulate(**how, board=replace(find_board("mine.py:FAST").value, name="given"), profile="mine.py:PLAIN",
                     settings={"pll.ssel": 10})  # fmt: skip
    assert given.frames == own.frames


def test_the_clocks_that_no_pll_makes_are_warned_of(write: Write, tmp_path: Path) -> None:
    """500 and 120 MHz are simulated, and nobody's board."""
    write("fw_eyes.py", FIRMWARE)
    how = {"recording": record(tmp_path / "drive.mcap", 1), "firmware": "fw_eyes:eyes"}
    run = simulate(**how, settings={"clocks.cclk_hz": "500e6"})
    assert run.identity.cclk_hz == 500e6
    assert any("no PLL setting makes the clocks" in each.text for each in run.assumptions)


def bfsim(*arguments: str) -> Result:
    """Call the command line in the current folder."""
    return CliRunner().invoke(main, arguments, env={"COLUMNS": "80"}, prog_name="bfsim")


def test_from_another_folder_on_the_command_line(
    write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run, a map and a table of a board in a file elsewhere, with numbers changed."""
    write("hardware/mine.py", MINE)
    write("fw/fw_eyes.py", FIRMWARE)
    drive = record(tmp_path / "drive.mcap", 2)
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    how = ("--firmware", "../fw/fw_eyes.py", "--board", "../hardware/mine.py:FAST", "--set", "sdram.trp=3")
    clocks = ("--set", "clocks.cclk_hz=500e6", "--set", "clocks.sclk_hz=125e6")
    done = bfsim(
        "run", str(drive), *how, *clocks, "--profile", "../hardware/mine.py:PLAIN", "--json", "out.json"
    )
    assert (done.exit_code, done.stderr) == (0, "")
    identity = json.loads(Path("out.json").read_text())["identity"]
    assert identity["board"] == (
        "mine:FAST --set clocks.cclk_hz=500000000 --set clocks.sclk_hz=125000000 --set sdram.nRP=3"
    )
    assert (identity["compiler"], identity["cclk_hz"]) == ("mine:PLAIN", 500e6)
    assert identity["board"] in " ".join(done.stdout.split())
    placed = bfsim(
        "ldf", "--board", "../hardware/mine.py:FAST", "--no-symbols", "--firmware", "../fw/fw_eyes.py"
    )
    assert placed.exit_code == 0
    told = bfsim("boards", "../hardware/mine.py:FAST", *how[4:], *clocks)
    rows = [line.split() for line in told.stdout.splitlines()]
    assert ["sdram.nRP", "2", "3"] in rows
    assert ["pll.vco_multiplier", "24", "20"] in rows
    assert ["sdram.nRP", "3"] in rows


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["run", "missing.mcap", "--set", "sdram.nRX=3"], r"error: --set sdram.nRX=3: there is no 'nRX' \(nearest: "),
        (["run", "missing.mcap", "--set", "sdram.nRP=0"], "error: --set sdram.nRP=0: sdram.nRP must be 1 to 7, not 0"),
        (["run", "missing.mcap", "--set", "sdram.nRP"], "must be PATH=VALUE, such as sdram.nRP=3, not 'sdram.nRP'"),
        (["run", "--set", "sdram.nRP=3", "--set", "sdram.nRP=3"], "'sdram.nRP' must be set once, not twice"),
        (["run", "missing.mcap", "--set", "sdram.nRP=3", "--set", "sdram.tRP=3"], "sdram.nRP must be set once, not twice"),
        (["profile", "missing.mcap", "--set", "a=b=c"], "--set a=b=c: there is no 'a'"),
        (["ldf", "--set", "sdram.banks=16"], "sdram.banks must be 1 to 8, not 16"),
        (["boards", "--set", "sdram.nRP=3"], "--set must come with the NAME of a board"),
        (["boards", "cm-bf561", "--set", "sdram.nRP=nan"], "must be a number"),
        (["check", "missing.mcap", "--baseline", "b.toml", "--update", "--board", "no.py:X"], "no.py must be a file"),
    ],
)  # fmt: skip
def test_mistakes_end_with_2_before_anything_runs(write: Write, arguments: list[str], problem: str) -> None:
    """In one paragraph that names the option."""
    done = bfsim(*arguments)
    assert done.exit_code == 2
    assert re.search(problem, " ".join(done.stderr.split()))
    assert "Traceback" not in done.stderr
