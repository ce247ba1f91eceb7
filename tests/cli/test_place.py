"""`bfsim place` from the terminal's side: what is found, what is written and run again, and mistakes."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from bfsim.cli.main import main
from bfsim.cli.place import has_others, place
from bfsim.recording.writer import RecordingWriter

FIRMWARE = """
from bfsim.api import Buffer, BudgetRow, Firmware, i32, kernel, u8, u32

@kernel
def count(row: u8[:], table: u32[:], sums: u32[:]) -> None:
    for x in range(len(row)):
        sums[row[x] & 15] += table[row[x] & 63]

@kernel
def ponder(turns: i32) -> i32:
    thought = 1
    for turn in range(turns):
        thought = thought * 5 + turn
        thought = thought ^ (thought >> 3)
    return thought

def main(core):
    while (frame := (yield from core.next_frame())) is not None:
        with core.stage("Count"):
            yield core.run(ponder, PONDER)
            lines = core.input_ring(frame.rows, "ring")
            for _ in range(frame.height):
                line = yield from lines.line()
                for _ in range(TURNS):
                    yield core.run(count, line, core.array("table"), core.array("sums"))

def buffers(size):
    return {core: [Buffer("camera", u8, 2 * size.width_px, f"sdram_bank{n}", rows=2 * size.height_px),
                   Buffer("ring", u8, 2 * size.width_px, SECTION, rows=2),
                   Buffer("table", u32, 64, SECTION),
                   Buffer("sums", u32, 16, SECTION),
                   Buffer("idle", u8, IDLE, SECTION)]
            for n, core in enumerate("AB")}

firmware = Firmware(mains={"A": main, "B": main}, buffers=buffers, camera="camera", rows=(BudgetRow(stage="Count"),))
"""


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a recording of two pictures of noise, where the user is."""
    picture = np.random.default_rng(1).integers(0, 255, (16, 64), np.uint8)
    with RecordingWriter(tmp_path / "drive.mcap", width=32, height=16) as writer:
        for number in range(2):
            writer.add(picture, picture, number * 33_000_000, number * 33_000_000)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def firmware(name: str, *, idle: int = 64, ponder: int = 4_000_000, turns: int = 50) -> str:
    """Write firmware that ponders longer than the cameras take for a picture, and whose buffers but theirs ask for L1."""
    values = {"SECTION": "'L1_data_a'", "IDLE": str(idle), "TURNS": str(turns), "PONDER": str(ponder)}
    text = FIRMWARE
    for word, value in values.items():
        text = text.replace(word, value)
    Path(f"{name}.py").write_text(text)
    return f"{name}.py:firmware"


def bfsim(*arguments: object) -> Result:
    """Call the command line in this process."""
    return CliRunner(env={"COLUMNS": "80"}).invoke(main, [str(each) for each in arguments])


def found(*arguments: object) -> dict:
    """What `bfsim place --json` says."""
    done = bfsim("place", "drive.mcap", *arguments, "--json")
    assert done.exit_code == 0, done.output
    return json.loads(done.stdout)


def frame_ms(*arguments: object) -> float:
    """Milliseconds of a frame of `bfsim run`."""
    done = bfsim("run", "drive.mcap", *arguments)
    assert done.exit_code == 0, done.output
    return float(done.stdout.split(" ms a frame")[0].split()[-1])


def test_from_sdram_to_l1(home: Path) -> None:
    """What is used goes to L1, what is not stays; the file runs as fast as was said, as fast as the default placement."""
    name = firmware("mine")
    done = bfsim("place", "drive.mcap", "--firmware", name, "--ldf", "sdram", "-o", "placed.ldf")
    assert done.exit_code == 0, done.output
    said = " ".join(done.stdout.split())
    for words in (
        "% simulated",
        "% predicted",
        "What moved, 6 of 10",
        "Written: `bfsim run --ldf placed.ldf` runs it, `bfsim ldf placed.ldf` draws it, with the other options that were given here.",
    ):
        assert words in said
    assert max(map(len, done.stdout.splitlines())) <= 80
    after = frame_ms("--firmware", name, "--ldf", "placed.ldf")
    assert f"→ {after:.2f} ms a frame" in done.stdout
    assert after <= 1.001 * frame_ms("--firmware", name)
    text = Path("placed.ldf").read_text()
    assert "INPUT_SECTIONS_PIN(table.doj(L1_data_a))" in text
    assert "64 B; not used in the frames measured" in text
    shown = bfsim("ldf", "placed.ldf", "--firmware", name, "--size", "32x16")
    assert shown.exit_code == 0, shown.output


@pytest.mark.parametrize(
    ("arguments", "has"),
    [
        (["--ldf", "sdram", "-o", "placed.ldf"], False),
        (["drive.mcap"], True),
        (["--set", "sdram.nRP=3"], True),
    ],
)
def test_other_options_are_told_of_where_there_are_some(arguments: list[str], has: bool) -> None:
    """The LDF is the one that is written, and its file is no option of a run."""
    with place.make_context("place", arguments) as ctx:
        assert has_others(set(ctx.params) - {"output"}) is has


def test_what_is_predicted_comes_true(home: Path) -> None:
    """Two buffers leave SDRAM for L1: the predicted gain is within a tenth of the simulated one; JSON has both, and every buffer."""
    plain = found("--firmware", firmware("mine"), "--ldf", "sdram")
    gain, predicted = (plain["before_ms"] - plain[key] for key in ("after_ms", "predicted_ms"))
    assert gain > 2
    assert predicted == pytest.approx(gain, rel=0.1)
    parts = {(each["name"], each["core"]): each for each in plain["parts"]}
    assert len(parts) == 10
    assert parts["table", "A"]["after"].startswith("MEM_A_L1_DATA")
    assert parts["ring", "B"]["streamed"]
    assert parts["idle", "A"]["before"] == parts["idle", "A"]["after"] == "MEM_SDRAM_BANK2"
    assert sum(each["saved_ms"] for each in parts.values() if each["core"] == "A") == pytest.approx(
        gain, rel=0.2
    )
    assert found("--firmware", "mine.py:firmware", "--ldf", "sdram") == plain


def test_a_rate_of_one_frame_is_told_as_that(home: Path) -> None:
    """It has the wait for the picture in it: `bfsim run` says more frames a second of more of them."""
    told = [
        bfsim("place", "drive.mcap", "--firmware", firmware("mine"), "--frames", each).output for each in "12"
    ]
    assert ["Of one frame, with the wait for its picture" in each for each in told] == [True, False]


def test_where_the_cameras_bound_the_frame_less_work_is_better(home: Path) -> None:
    """Of frames that wait for their pictures the least work is taken, though its frames may end a cycle later; it was left where it was."""
    plain = found("--firmware", firmware("mine", ponder=1, turns=10), "--ldf", "sdram")
    assert plain["before_ms"] == pytest.approx(plain["camera_ms"], rel=0.01)
    assert plain["best"] is not None
    assert plain["trials"][plain["best"]]["busy_ms"] < 0.5 * plain["before_busy_ms"]


def test_what_is_good_already_is_left_alone(home: Path) -> None:
    """No file is written, and that is said."""
    done = bfsim("place", "drive.mcap", "--firmware", firmware("mine"), "-o", "placed.ldf")
    assert done.exit_code == 0, done.output
    assert "no placement that was found is faster than thesis.ldf" in " ".join(done.stdout.split())
    assert "placed.ldf was not written: thesis.ldf is as good" in done.stdout
    assert not Path("placed.ldf").exists()


def test_firmware_that_has_no_room_is_moved_in(home: Path) -> None:
    """40,000 bytes that nobody uses ask for a bank of 32 KB: they go elsewhere, all else stays, and the file says where."""
    name = firmware("mine", idle=40_000)
    assert bfsim("run", "drive.mcap", "--firmware", name).exit_code == 2
    done = bfsim("place", "drive.mcap", "--firmware", name, "-o", "placed.ldf")
    assert done.exit_code == 0, done.output
    assert "does not fit with thesis.ldf" in done.stdout
    moved = found("--firmware", name)
    after = {(each["name"], each["core"]): each["after"] for each in moved["parts"]}
    assert not moved["linked"]
    assert after["idle", "A"].startswith("MEM_SDRAM")
    assert after["ring", "A"] == "MEM_A_L1_DATA_A"
    assert after["camera", "B"] == "MEM_SDRAM_BANK1"
    assert frame_ms("--firmware", name, "--ldf", "placed.ldf") == pytest.approx(moved["after_ms"], abs=0.01)


def test_a_board_with_one_core_and_other_numbers(home: Path) -> None:
    """`--board` and `--set` are those of a run: a slower SDRAM makes the same placement gain more."""
    text = Path(firmware("mine").partition(":")[0]).read_text()
    Path("one.py").write_text(
        text.replace('"A": main, "B": main', '"A": main').replace('enumerate("AB")', 'enumerate("A")')
    )
    Path("slow.ldf").write_text(
        "ARCHITECTURE(ADSP-BF533) MEMORY { D { START(0xFF800000) LENGTH(1K) } C { START(0xFFA00000) LENGTH(4K) } "
        "S { START(32) LENGTH(8M) } } PROCESSOR p0 { SECTIONS { c { INPUT_SECTIONS($COMMAND_LINE_OBJECTS(program)) } > C "
        "s { INPUT_SECTIONS($COMMAND_LINE_OBJECTS(*)) } > S d { } > D } }"
    )
    given = ("--board", "cm-bf533", "--firmware", "one.py:firmware", "--ldf", "slow.ldf")
    plain, slow = found(*given), found(*given, "--set", "sdram.nRP=7", "--set", "sdram.nRCD=7")
    assert plain["before_ms"] > plain["after_ms"]
    assert slow["before_ms"] - slow["after_ms"] > plain["before_ms"] - plain["after_ms"]


def test_nothing_is_overwritten(home: Path) -> None:
    """Not a placement without --force, and never what is read; all is told before anything runs."""
    Path("placed.ldf").write_text("mine")
    name = firmware("mine")
    refused = bfsim("place", "drive.mcap", "--firmware", name, "-o", "placed.ldf")
    assert (refused.exit_code, Path("placed.ldf").read_text()) == (2, "mine")
    assert "placed.ldf must not exist yet; --force overwrites it" in refused.stderr
    refused = bfsim("place", "drive.mcap", "--firmware", name, "-o", "drive.mcap", "--force")
    assert refused.exit_code == 2
    done = bfsim("place", "drive.mcap", "--firmware", name, "--ldf", "sdram", "-o", "placed.ldf", "--force")
    assert done.exit_code == 0, done.output
    assert Path("placed.ldf").read_text().startswith("/*\n** Written by `bfsim place` for mine:firmware")


def test_a_segment_without_memory_is_named(home: Path) -> None:
    """With its place, and what to do, as by `bfsim ldf`: it was told by its address alone."""
    Path("large.ldf").write_text(
        '#undef SDRAM_BANK_BYTES\n#define SDRAM_BANK_BYTES 16M\n#define CACHES 0\n#include "cm-bf561.ldfi"\n'
    )
    done = bfsim("place", "drive.mcap", "--firmware", firmware("mine"), "--ldf", "large.ldf")
    assert done.exit_code == 2
    told = " ".join(done.stderr.split())
    assert re.search(r"cm-bf561\.ldfi:\d+: segment 'MEM_SDRAM_BANK\d': \d+ bytes at 0x", told), told
    assert "--set sdram.bank_bytes=BYTES another size of each of the banks that SDRAM has" in told


def test_what_does_not_fit_is_named(home: Path) -> None:
    """One that is larger than every memory, and several that are too much together: with the bytes that are lacking."""
    refused = bfsim("place", "drive.mcap", "--firmware", firmware("huge", idle=9_000_000))
    assert refused.exit_code == 2
    assert "idle (core A) must fit in one memory, not take 9,000,000 bytes" in refused.stderr
    assert "so 611,392 bytes are lacking" in refused.stderr
    assert refused.stderr.count("\n") == 1
    small = "ARCHITECTURE(ADSP-BF561) MEMORY { S { START(32) LENGTH(20K) } } "
    for core in ("p0", "p1"):
        small += (
            f"PROCESSOR {core} {{ SECTIONS {{ s {{ INPUT_SECTIONS($COMMAND_LINE_OBJECTS(*)) }} > S }} }} "
        )
    Path("small.ldf").write_text(small)
    refused = bfsim("place", "drive.mcap", "--firmware", firmware("many", idle=9000), "--ldf", "small.ldf")
    assert refused.exit_code == 2
    assert "have no place, wherever the rest lies" in refused.stderr or "has no place" in refused.stderr
