"""The command line from the terminal's side: output, exit codes, files and errors.

What belongs to a process, as signals, hash seeds and an empty cache, is tried in one of its own (`started`); all else is called
in this one, for each new one would import all anew.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import chdir
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from bfsim.cli.main import main
from bfsim.recording import RecordingWriter
from bfsim.shipped import RECORDING
from tests.eyes import FIRMWARE, record
from tests.tiers import exhaustive


def bfsim(*arguments: object, cwd: Path | None = None, **environment: str) -> Result:
    """Call the command line in this process and return what came out."""
    with chdir(cwd or Path.cwd()):
        return CliRunner().invoke(main, [*map(str, arguments)], env=environment, prog_name="bfsim")


def started(
    *arguments: object, cwd: Path | None = None, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run the command line in a process of its own and return what came out."""
    command = [sys.executable, "-m", "bfsim", *map(str, arguments)]
    return subprocess.run(
        command,
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def refused(*arguments: object, cwd: Path | None = None) -> str:
    """Run a command that must fail as a mistake: one paragraph on stderr, exit code 2, no traceback."""
    result = bfsim(*arguments, cwd=cwd)
    assert result.exit_code == 2, result.stdout + result.stderr
    assert result.stderr.startswith("bfsim: error: ")
    assert "Traceback" not in result.stderr
    assert "\n\n" not in result.stderr.strip()
    return result.stderr


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[subprocess.CompletedProcess[str], Path]:
    """`bfsim run` in a process of its own, and the JSON report that it wrote."""
    path = tmp_path_factory.mktemp("report") / "run.json"
    return started("run", "--json", path, COLUMNS="80"), path


@pytest.fixture(scope="module")
def report(whole: tuple[subprocess.CompletedProcess[str], Path]) -> dict[str, Any]:
    """The JSON report of the built-in recording."""
    assert whole[0].returncode == 0, whole[0].stderr
    loaded: dict[str, Any] = json.loads(whole[1].read_text())
    return loaded


def test_run_prints_the_budget(whole: tuple[subprocess.CompletedProcess[str], Path]) -> None:
    """`bfsim run` needs nothing and prints rate, budget, what ran and digests on a screen of 80 columns by 30 lines."""
    result = whole[0]
    assert result.returncode == 0, result.stderr
    assert not result.stderr
    for words in ("frames/s", "bound by core A's Edge detection", "A ms", "B ms", "Open & closing", "(the rest)", "thesis",
                  "cm-bf561", "thesis.ldf", "gcc-adi", "cycles"):  # fmt: skip
        assert words in result.stdout
    lines = result.stdout.splitlines()
    assert 24 <= len(lines) <= 30
    assert max(map(len, lines)) <= 80


def test_run_prints_every_table_if_asked() -> None:
    """`--full`: the budget of each core, configuration and digests."""
    result = bfsim("run", "--frames", 2, "--full")
    assert result.exit_code == 0, result.stderr
    assert not result.stderr
    for words in ("frames/s", "Core A", "Core B", "Edge detection", "Open & closing", "(the rest)", "thesis", "cm-bf561",
                  "thesis.ldf", "gcc-adi", "Cycles"):  # fmt: skip
        assert words in result.stdout


def test_the_rows_of_every_frame_sum_to_the_frame(report: dict[str, Any]) -> None:
    """issue + stall + idle over all rows is the time from the end of one frame to the end of the next."""
    frames = report["frames"]
    assert len(frames) == 8
    for core in range(2):
        ends = [0]
        for frame in frames:
            cycles = frame["cores"][core]
            assert cycles["begin_cclk"] == ends[-1]
            spent = sum(
                each["issue_cclk"] + each["idle_cclk"] + sum(each["stall_cclk"].values())
                for each in cycles["stages"]
            )
            assert spent == cycles["end_cclk"] - cycles["begin_cclk"]
            ends.append(cycles["end_cclk"])


def test_the_cycles_of_the_kernels_are_the_issue_cycles_of_the_stages(report: dict[str, Any]) -> None:
    """What `bfsim profile` breaks down is what `bfsim run` charged."""
    for core in range(2):
        for stage in ("Edge detection", "Open & closing"):
            charged = sum(
                each["issue_cclk"]
                for frame in report["frames"]
                for each in frame["cores"][core]["stages"]
                if each["stage"] == stage
            )
            counted = sum(
                each["issue_cclk"]
                for each in report["kernels"]
                if each["core"] == "AB"[core] and each["stage"] == stage
            )
            assert charged == counted


def test_at_most_50_000_events_per_stereo_frame(report: dict[str, Any]) -> None:
    """SimPy carries only what must be an event."""
    assert 0 < report["events"] <= 50_000 * len(report["frames"])


def test_both_boards_and_both_feeds_run(report: dict[str, Any]) -> None:
    """The other clock preset and the recorded time stamps give other cycles; at 30 frames/s frames are missed."""
    ratings = json.loads(bfsim("run", "--frames", 2, "--board", "cm-bf561-ratings", "--json", "-").stdout)
    assert ratings["digests"] != report["digests"]
    recorded = json.loads(bfsim("run", "--frames", 4, "--feed", "recorded", "--json", "-").stdout)
    done = [frame["index"] for frame in recorded["frames"]]
    assert recorded["missed"]
    assert sorted(done + recorded["missed"]) == list(range(4))


@pytest.mark.exhaustive
def test_sanitize_changes_no_cycle() -> None:
    """`--sanitize` checks and reports the same; one frame, since it takes ten times as long."""
    plain, sanitized = (
        json.loads(bfsim("run", "--frames", 1, *options, "--json", "-").stdout)
        for options in ((), ("--sanitize",))
    )
    assert len(sanitized["frames"]) == 1
    assert sanitized["frames"] == plain["frames"]


def test_profile_shows_stage_kernel_and_line() -> None:
    """`bfsim profile` names the hottest kernels with their source."""
    result = bfsim("profile", "--frames", 1)
    assert result.exit_code == 0, result.stderr
    for words in ("Edge detection", "isqrt32", "direction_row"):
        assert words in result.stdout


def test_profile_by_buffer_shows_the_memories() -> None:
    """`bfsim profile --by buffer` says where each buffer lies, in L1 and outside."""
    result = bfsim("profile", "--frames", 1, "--by", "buffer")
    assert result.exit_code == 0, result.stderr
    for words in ("edge_data", "SDRAM", "L1_DATA_A"):
        assert words in result.stdout


ENDLESS_LINE = '            while True: pathlib.Path("begun").touch(); time.sleep(0.01)'
STOPS_IN_A_FRAME = FIRMWARE.replace(
    "        bright = 0\n",
    f"""        bright = 0
        if core.name == "A" and frame.index == {{frame}}:
            import time, pathlib
{ENDLESS_LINE}
""",
)


def interrupted_in(frame: int, folder: Path) -> tuple[int, str, str]:
    """Interrupt a run in a frame that does not end; return its exit code and what it has printed."""
    (folder / "eyes.py").write_text(STOPS_IN_A_FRAME.replace("{frame}", str(frame)))
    recording = record(folder / "drive.mcap", 5)
    command = [sys.executable, "-m", "bfsim", "run", recording, "--firmware", "eyes.py"]
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        while process.poll() is None and not (folder / "begun").exists():
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
    return process.returncode, out, err


@pytest.mark.parametrize(
    ("frame", "told", "shown"),
    [(3, "interrupted after 3 frames", "frames/s"), (0, "interrupted before the first frame was done", "")],
)
def test_ctrl_c_ends_with_the_report_of_the_frames_done(
    tmp_path: Path, frame: int, told: str, shown: str
) -> None:
    """An interrupted run prints what it has, says which line of the firmware was at work, and exits with 130."""
    code, out, err = interrupted_in(frame, tmp_path)
    line = STOPS_IN_A_FRAME.splitlines().index(ENDLESS_LINE) + 1
    assert code == 130
    assert shown in out
    assert f"bfsim: {told} ({tmp_path}/eyes.py:{line})\n" in err
    assert "Traceback" not in err


ENDLESS = """
from pathlib import Path
from bfsim.api import Buffer, BudgetRow, Firmware, i32, kernel, kernel_from, u8

@kernel
def spin(x: i32) -> i32:
    while x > 0:
        x = 1
    return x

def main(core):
    while (yield from core.next_frame()) is not None:
        yield core.run(spin, 0)  # compiled from now on
        Path("begun").touch()
        yield core.run(spin, 1)

def buffers(size):
    rows = {"A": "sdram_bank0", "B": "sdram_bank1"}
    return {core: [Buffer("camera", u8, 2 * size.width_px, bank, rows=2 * size.height_px)] for core, bank in rows.items()}

fw = Firmware(mains={"A": main, "B": main}, buffers=buffers, camera="camera", rows=(BudgetRow(stage="S"),))
"""


OBJECT_CODE = (
    f"kernel_from({str(Path(__file__).parent / 'blackfin/data/endless.o')!r}, 'spin', x=i32, result=i32)"
)
SURELY_IN_THE_KERNEL_TICKS = 50
"""Of 10 ms each: what Python has to do between the file and the kernel takes less than one, however busy the machine is."""


def cpu_ticks(pid: int) -> int:
    """Return for how long a process was running on a processor, in user mode (proc(5), field 14)."""
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11])


def wait_for_the_kernel(process: subprocess.Popen[str], folder: Path) -> None:
    """Return when the kernel that does not end has surely begun."""
    while process.poll() is None and not (folder / "begun").exists():
        time.sleep(0.05)
    begun = cpu_ticks(process.pid)
    while process.poll() is None and cpu_ticks(process.pid) < begun + SURELY_IN_THE_KERNEL_TICKS:
        time.sleep(0.05)


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="a system without /proc")
@pytest.mark.parametrize("number", [signal.SIGINT, *exhaustive(signal.SIGTERM)])
@pytest.mark.parametrize("code", ["spin", OBJECT_CODE])
def test_a_signal_ends_a_kernel_that_does_not_end(tmp_path: Path, number: signal.Signals, code: str) -> None:
    """Python hears nothing while the machine code of a kernel runs, estimated or not; the user needs no `kill`."""
    (tmp_path / "endless.py").write_text(f"{ENDLESS}\nspin = {code}\n")
    command = [sys.executable, "-m", "bfsim", "run", "--firmware", "endless:fw"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        wait_for_the_kernel(process, tmp_path)
        process.send_signal(number)
        _, err = process.communicate()
    line = ENDLESS.splitlines().index("        yield core.run(spin, 1)") + 1
    told = f"bfsim: interrupted before the first frame was done, in a kernel that does not end ({tmp_path}/endless.py:{line})\n"
    assert (process.returncode, err) == (128 + number, told)


SCRIPT = """
import sys
from pathlib import Path
from endless import fw, spin
from bfsim.run import simulate

try:
    if sys.argv[1] == "call":
        spin(0)
        Path("begun").touch()
        spin(1)
    else:
        run = simulate(firmware=fw)
        print(run.interrupted, run.interrupted_at)
except KeyboardInterrupt as error:
    print(error)
print(spin(0))
"""
"""A call, or a run, that Ctrl-C ends; then the kernel is called once more."""


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="a system without /proc")
@pytest.mark.parametrize("code", ["spin", OBJECT_CODE])
@pytest.mark.parametrize("what", ["call", "run"])
def test_ctrl_c_ends_a_kernel_that_does_not_end_in_a_script(tmp_path: Path, code: str, what: str) -> None:
    """Python's own handler had its turn when the kernel was over: never."""
    (tmp_path / "endless.py").write_text(f"{ENDLESS}\nspin = {code}\n")
    (tmp_path / "script.py").write_text(SCRIPT)
    command = [sys.executable, "script.py", what]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as process:
        wait_for_the_kernel(process, tmp_path)
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=60)
    line = ENDLESS.splitlines().index("        yield core.run(spin, 1)") + 1
    told = {"call": "", "run": "True , "}[what]
    place = {"call": "", "run": f" ({tmp_path}/endless.py:{line})"}[what]
    assert out == f"{told}in a kernel that does not end{place}\n0\n"


def write_recording(path: Path, width: int = 16, height: int = 8) -> Path:
    """Write a recording of two grey stereo frames."""
    picture = np.full((height, 2 * width), 128, np.uint8)
    with RecordingWriter(path, width=width, height=height) as writer:
        for number in range(2):
            writer.add(picture, picture, number * 33_000_000, number * 33_000_000)
    return path


def test_broken_recordings_are_refused(tmp_path: Path) -> None:
    """A missing, foreign, cut or damaged recording is named."""
    assert "nothing.mcap" in refused("run", tmp_path / "nothing.mcap")
    data = RECORDING.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(data[: len(data) // 2])
    assert "cut.mcap" in refused("run", cut)
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(data[:300_000] + bytes([data[300_000] ^ 64]) + data[300_001:])
    assert "damaged.mcap" in refused("run", damaged)
    text = tmp_path / "text.mcap"
    text.write_text("not a recording")
    assert "text.mcap" in refused("run", text)


def test_unknown_names_are_refused(tmp_path: Path) -> None:
    """A board or firmware that does not exist is refused with what there is."""
    assert "cm-bf561" in refused("run", "--board", "cm-bf562")
    assert "no_such_package" in refused("run", "--firmware", "no_such_package:tinyphoon")
    assert "no_such_name" in refused("run", "--firmware", "tinyphoon:no_such_name")
    (tmp_path / "broken_firmware.py").write_text("import bfsim.api\n\nraise ValueError('not today')\n")
    message = refused("run", "--firmware", "broken_firmware:main", cwd=tmp_path)
    assert "broken_firmware.py:3" in message
    assert "not today" in message


def test_an_ldf_that_cannot_be_is_refused(tmp_path: Path) -> None:
    """A syntax error has line and caret; a picture too wide for L1 names section, memory, sizes and line."""
    broken = tmp_path / "broken.ldf"
    broken.write_text("ARCHITECTURE(ADSP-BF561)\nMEMORY { L1 { TYPE(RAM) START } }\n")
    message = refused("run", "--ldf", broken)
    assert "broken.ldf:" in message
    assert "^" in message
    wide = write_recording(tmp_path / "wide.mcap", width=1600, height=8)
    message = refused("run", wide)
    for words in ("core.ldfi:", "L1_data_a", "MEM_A_L1_DATA_A", "bytes"):
        assert words in message


BAD_FIRMWARE = """
from bfsim.api import BudgetRow, Buffer, Firmware, i32, kernel, u8

@kernel
def outside(row: u8[:], n: i32):
    for x in range(n):
        row[x] = row[x + 1]

def main(core):
    while (yield from core.next_frame()) is not None:
        yield core.run(outside, core.array("row"), 16)

@kernel
def mark(row: u8[:], x: i32):
    row[x] = 1

def later(core):
    while (frame := (yield from core.next_frame())) is not None:
        with core.stage("Marks"):
            yield core.run(mark, core.array("far" if core.name == "B" else "row"), 14 + 2 * frame.index)

def takes(core):
    while (yield from core.next_frame()) is not None:
        pass

def waits(core):
    while (yield from core.next_frame()) is not None:
        yield from core.wait(f"never posted for {core.name}")

def buffers(size):
    return {core: [Buffer("camera", u8, 2 * size.width_px, f"sdram_bank{n}", rows=size.height_px),
                   Buffer("row", u8, 16, "L1_data_a"), Buffer("far", u8, 16, f"sdram_bank{n}")] for n, core in enumerate("AB")}

rows = (BudgetRow(stage="Marks"),)
bad_index = Firmware(mains={"A": main, "B": main}, buffers=buffers, camera="camera", rows=())
late_in_l1 = Firmware(mains={"A": later, "B": takes}, buffers=buffers, camera="camera", rows=rows)
late_in_sdram = Firmware(mains={"A": takes, "B": later}, buffers=buffers, camera="camera", rows=rows)
deadlock = Firmware(mains={"A": waits, "B": waits}, buffers=buffers, camera="camera", rows=())
"""


def test_mistakes_of_the_firmware_are_named(tmp_path: Path) -> None:
    """An index outside its array and two cores waiting for ever have file and line."""
    (tmp_path / "mine.py").write_text(BAD_FIRMWARE)
    recording = write_recording(tmp_path / "small.mcap")
    for options in ((), ("--sanitize",)):
        message = refused("run", recording, "--firmware", "mine:bad_index", *options, cwd=tmp_path)
        assert "mine.py:7: index 16 is outside of row in kernel outside" in message
        assert "core B, frame 0, outside of stages (" in message
    for core, firmware in (("A", "late_in_l1"), ("B", "late_in_sdram")):
        message = refused("run", recording, "--firmware", f"mine:{firmware}", cwd=tmp_path)
        assert (
            "index 16 is outside of row in kernel mark; an index must be 0 or more and less than len(row), which is 16"
            in message
        )
        assert f"core {core}, frame 1, stage Marks (" in message
        assert "mine.py:20)" in message
    message = refused("run", recording, "--firmware", "mine:deadlock", cwd=tmp_path)
    for words in ("core A waits for semaphore 'never posted for A'", "core B waits for semaphore 'never posted for B'",
                  "mine.py:28"):  # fmt: skip
        assert words in message


ORDERS = {
    "send": [
        {"after_frames": 1, "mode": {"area": [10, 20, 300, 200], "edges": {"edge_threshold": 12}}},
        {"after_frames": 1, "mode": {"area": [100, 20, 300, 200]}},
        {"after_frames": 1, "models": ["ball", {"name": "blue goal", "number": 1}]},
        {"after_frames": 1, "bytes": [0xF1, 0xB5, 2, 0]},
    ]
}


def test_the_strategy_unit_orders_modes_and_models(tmp_path: Path) -> None:
    """A good mode is obeyed from the next frame on; bad orders are in the report with the reason, and change nothing."""
    script = tmp_path / "orders.json"
    script.write_text(json.dumps(ORDERS))
    result = bfsim("run", "--frames", 4, "--script", script, "--json", tmp_path / "run.json")
    assert result.exit_code == 0, result.stderr
    said = " ".join(result.stdout.split())
    for words in (
        "frame 1: core A refused MODE 1: area must be 16x16 px at least and lie in the 320x240 of the pictures",
        "core A refused MODELS 2: model 1 must have a number of its own",
        "core A refused a message: it must have 10 bytes at least, but is cut short after 4",
    ):
        assert words in said
    frames = json.loads((tmp_path / "run.json").read_text())["frames"]
    assert [each["results"]["orders_taken_A"] for each in frames] == [0, 1, 0, 0]
    assert [each["results"]["orders_refused_A"] for each in frames] == [0, 3, 0, 0]
    assert [len(each["remarks"]) for each in frames] == [0, 3, 0, 0]
    spent = [
        sum(stage["issue_cclk"] for stage in each["cores"][0]["stages"] if stage["stage"] == "Edge detection")
        for each in frames
    ]
    share = 300 * 200 / (320 * 240)
    assert all(abs(each / spent[0] - share) < 0.03 for each in spent[2:])


@pytest.mark.exhaustive
def test_small_pictures_run_three_times_as_fast(tmp_path: Path) -> None:
    """160x120 against 320x240 (T §6.6); the change takes effect in the pictures that the cameras begin after it."""
    script = tmp_path / "small.toml"
    script.write_text("[[send]]\nafter_frames = 0\nmode.camera = {width = 160, height = 120}\n")
    result = bfsim("run", "--script", script, "--json", "-")
    assert result.exit_code == 0, result.stderr
    frames = json.loads(result.stdout)["frames"]
    spent = [each["cores"][0]["end_cclk"] - each["cores"][0]["begin_cclk"] for each in frames]
    assert 3 < spent[0] / spent[-1] < 4.5


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (
            {"mode": {"edges": {"edge_treshold": 3}}},
            "send.0.mode.edges.edge_treshold must be one of gauss_px, edge_",
        ),
        ({"mode": {"area": [1, 2, 3]}}, "send.0.mode.area must be 4 numbers (x, y, width, height), not 3"),
        (
            {"mode": {"lines": {"far_gap": 2.5}}},
            "send.0.mode.lines.far_gap must be a whole number of 32 bits, not 2.5",
        ),
        ({"models": ["bal"]}, "send.0.models.0 must be or have the name of one of ball, blue goal"),
        (
            {"mode": {}, "models": []},
            "send.0 must have one of mode, models, words, bytes, not mode and models",
        ),
    ],
)
def test_mistakes_in_orders_are_named(tmp_path: Path, entry: dict[str, Any], message: str) -> None:
    """File, entry, field, and what it must be."""
    script = tmp_path / "orders.json"
    script.write_text(json.dumps({"send": [{"after_frames": 1, **entry}]}))
    told = " ".join(refused("run", "--script", script).split())
    assert f"{script}: {message}" in told
