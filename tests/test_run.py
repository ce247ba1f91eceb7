"""`simulate`, from a recording and the name of a firmware to records: determinism, memory, and bad input."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

import tinyphoon
from bfsim.errors import BfsimError, ConfigError, FirmwareError, LinkError, RecordingError
from bfsim.loading.firmware import load_firmware
from bfsim.planning import planned
from bfsim.report.what_ran.digest import cycle_digest, identity_digest
from bfsim.run import Feed, Fidelity, simulate
from bfsim.shipped import LDF_FOLDER, RECORDING
from tests.eyes import FIRMWARE, record, run_eyes

DIGESTS = """\
import json, sys
sys.modules["numba"] = None  # which cannot be imported then
from pathlib import Path
from bfsim.report.what_ran.digest import cycle_digest, identity_digest
from bfsim.loading.firmware import load_firmware
from bfsim.run import Feed, Fidelity, simulate
runs = [simulate(Path(sys.argv[1]), firmware="fw_eyes:eyes", feed=feed) for feed in Feed]
print(json.dumps([[identity_digest(run.identity), cycle_digest(run.frames)] for run in runs]))
"""


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with firmware in it, the current one."""
    (tmp_path / "fw_eyes.py").write_text(FIRMWARE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def start(folder: Path, recording: Path, **environment: str) -> subprocess.Popen[str]:
    """Start a process that runs the firmware in `folder` with both feeds and prints its digests."""
    command = [sys.executable, "-c", DIGESTS, str(recording)]
    return subprocess.Popen(
        command, cwd=folder, env=os.environ | environment, stdout=subprocess.PIPE, text=True
    )


@pytest.mark.exhaustive
def test_the_same_run_has_the_same_digests_everywhere(home: Path, tmp_path: Path) -> None:
    """In other processes, under other hash seeds, from another folder, with an empty cache and then with its own; none imports numba."""
    recording = record(home / "drive.mcap", 4)
    elsewhere = tmp_path / "else" / "where"
    elsewhere.mkdir(parents=True)
    for name in ("fw_eyes.py", "drive.mcap"):
        shutil.copy(home / name, elsewhere / name)
    cold = tmp_path / "cold"
    processes = [
        start(home, recording, PYTHONHASHSEED="1"),
        start(elsewhere, elsewhere / "drive.mcap", PYTHONHASHSEED="2", BFSIM_CACHE_DIR=str(cold)),
    ]
    here = [run_eyes(recording, feed=feed) for feed in Feed]
    outputs = [each.communicate()[0] for each in processes]
    assert any(cold.rglob("*"))
    warm = start(elsewhere, Path("drive.mcap"), PYTHONHASHSEED="3", BFSIM_CACHE_DIR=str(cold))
    outputs.append(warm.communicate()[0])
    expected = [[identity_digest(each.identity), cycle_digest(each.frames)] for each in here]
    assert [json.loads(each) for each in outputs] == [expected] * 3


def test_what_the_result_depends_on_changes_the_identity(home: Path) -> None:
    """Another recording, board, feed, fidelity or firmware: each is another identity."""
    first, second = record(home / "drive.mcap", 2), record(home / "other.mcap", 3)
    runs = [
        run_eyes(first),
        run_eyes(second),
        run_eyes(second, frames=2),
        run_eyes(first, feed=Feed.RECORDED),
        run_eyes(first, fidelity=Fidelity.DETAILED),
        run_eyes(first, board="cm-bf561-ratings"),
    ]
    (home / "fw_eyes.py").write_text(FIRMWARE + "\n# another version\n")
    runs.append(run_eyes(first))
    assert len({identity_digest(each.identity) for each in runs}) == len(runs)


def test_an_edited_firmware_runs_as_it_is_now(home: Path) -> None:
    """In the same process: cycles, results and identity are those of the file as it was before the run."""
    recording = record(home / "drive.mcap", 1)
    first = run_eyes(recording)
    (home / "fw_eyes.py").write_text(FIRMWARE.replace("line[x] > 100", "line[x] * line[x] > 100"))
    edited = run_eyes(recording)
    command = [sys.executable, "-c", DIGESTS, str(recording)]
    apart = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)[0]
    assert [identity_digest(edited.identity), cycle_digest(edited.frames)] == apart
    assert cycle_digest(edited.frames) != cycle_digest(first.frames)
    (home / "fw_eyes.py").write_text(FIRMWARE)
    again = run_eyes(recording)
    assert (again.identity, again.frames) == (first.identity, first.frames)


def test_what_is_imported_while_it_runs_is_of_the_firmware(home: Path) -> None:
    """A module that the main loop imports is found beside it, and is among the files."""
    recording = record(home / "drive.mcap", 1)
    (home / "fw_late.py").write_text("LIMIT = 3\n")
    late = "def main(core):\n    import fw_late\n    assert fw_late.LIMIT == 3"
    (home / "fw_eyes.py").write_text(FIRMWARE.replace("def main(core):", late))
    run = run_eyes(recording)
    assert run.identity.firmware_files == ("fw_eyes.py", "fw_late.py")
    assert run.firmware_place == str(home / "fw_eyes.py")
    assert "fw_late" not in sys.modules


def test_a_cut_run_is_the_beginning_of_the_whole(home: Path) -> None:
    """Frame n does not depend on what comes after it: the first frames have the same cycles."""
    recording = record(home / "drive.mcap", 5)
    whole, cut = run_eyes(recording), run_eyes(recording, frames=3)
    assert [each.index for each in cut.frames] == [0, 1, 2]
    assert cut.frames == whole.frames[:3]


def test_results_and_identity_say_what_ran(home: Path) -> None:
    """Numbers that the firmware published, bit-exact; names without folders; sizes and clocks."""
    run = run_eyes(record(home / "drive.mcap", 2))
    rng = np.random.default_rng(561)
    for frame in run.frames:
        left, right = rng.integers(0, 256, (2, 16, 64), np.uint8)
        assert dict(frame.results) == {"bright_A": np.sum(left > 100), "bright_B": np.sum(right > 100)}
    identity = run.identity
    assert (identity.recording, identity.firmware, identity.ldf) == (
        "drive.mcap",
        "fw_eyes:eyes",
        "thesis.ldf",
    )
    assert (identity.width_px, identity.height_px, identity.cclk_hz, identity.sclk_hz) == (
        32,
        16,
        600e6,
        120e6,
    )


def test_a_name_that_is_no_text_becomes_one(home: Path) -> None:
    """Reports, JSON and baselines are UTF-8, and names of files need not be."""
    recording = record(home / "drive.mcap", 1)
    identity = run_eyes(recording.rename(home / os.fsdecode(b"\xff.mcap"))).identity
    assert identity.recording == "\N{REPLACEMENT CHARACTER}.mcap"


def test_progress_counts_frames_up_to_the_total(home: Path) -> None:
    """As many calls as frames, each with the number that will be done in all."""
    calls: list[tuple[int, int]] = []
    run_eyes(
        record(home / "drive.mcap", 5), frames=3, progress=lambda done, total: calls.append((done, total))
    )
    assert calls == [(1, 3), (2, 3), (3, 3)]


def peak_bytes(recording: Path, frames: int) -> int:
    """Most memory that Python and numpy held during a run, in bytes."""
    tracemalloc.start()
    run = run_eyes(recording, frames=frames)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(run.frames) == frames
    return peak


@pytest.mark.exhaustive
def test_memory_does_not_grow_with_the_pictures(home: Path) -> None:
    """Ten times as many frames need no more memory than their records: a few kB each, where a pair of pictures has 20."""
    recording = record(home / "drive.mcap", 200, width=640, height=8)
    peak_bytes(recording, 2)  # what is imported or compiled once
    growth = peak_bytes(recording, 200) - peak_bytes(recording, 20)
    assert growth < 180 * 4_000


@pytest.mark.parametrize(
    ("how", "kind", "message"),
    [
        ({"board": "cm-bf562"}, ConfigError, "--board must be one of"),
        (
            {"board": "cm-bf533"},
            FirmwareError,
            r"must have main loops for A, not for A, B \(board cm-bf533\); --board takes another",
        ),
        ({"firmware": "fw_missing:fw"}, FirmwareError, "'fw_missing' must be installed or in the folder"),
        ({"recording": Path("missing.mcap")}, RecordingError, "missing.mcap"),
        ({"recording": Path("fw_eyes.py")}, RecordingError, "fw_eyes.py"),
        ({"ldf": Path("missing.ldf")}, LinkError, "missing.ldf"),
        ({"ldf": Path("fw_eyes.py")}, LinkError, r"fw_eyes.py:\d+"),
    ],
)
def test_bad_input_is_told_by_its_name(
    home: Path, how: dict[str, object], kind: type[BfsimError], message: str
) -> None:
    """Board, firmware, recording and LDF: whatever is wrong is the subject of the error."""
    good: dict[str, object] = {"recording": record(home / "drive.mcap", 1), "firmware": "fw_eyes:eyes"}
    with pytest.raises(kind, match=message):
        simulate(**good | how)  # type: ignore[arg-type]


def test_an_argument_that_there_is_not_is_told_with_the_function() -> None:
    """`got an unexpected keyword argument 'frame'` stood at the end of twenty lines of Python's `inspect`."""
    with pytest.raises(
        TypeError, match=r"^simulate\(\) got an unexpected keyword argument 'frame'$"
    ) as caught:
        simulate(frame=1)  # type: ignore[call-arg]
    assert caught.traceback[-1].path.name == "run.py"


def test_a_recording_that_breaks_off_is_told_with_its_name(home: Path) -> None:
    """Half a file: the error is the recording's, and nothing was reported before it."""
    recording = record(home / "drive.mcap", 20)
    recording.write_bytes(recording.read_bytes()[: recording.stat().st_size // 2])
    with pytest.raises(RecordingError, match="drive.mcap"):
        run_eyes(recording)


def test_pictures_too_large_for_the_rings_are_a_link_error(home: Path) -> None:
    """Lines of 12 000 pixels do not fit twice into 32 KB: the section and the memory are named."""
    recording = record(home / "drive.mcap", 1, width=12_000, height=2)
    with pytest.raises(LinkError, match="ring.*L1_data_a|L1_data_a.*ring") as refused:
        run_eyes(recording)
    largest = re.search(
        r"of 12000x2 need more memory .* takes with this LDF are (\d+)x2, and ", str(refused.value)
    )
    assert largest
    width = int(largest[1])
    assert run_eyes(record(home / "largest.mcap", 1, width=width, height=2)).identity.width_px == width
    with pytest.raises(LinkError):
        run_eyes(record(home / "larger.mcap", 1, width=width + 192, height=2))


def test_names_stand_for_files_and_choices() -> None:
    """As text, as a notebook has them; what there is not is refused in one sentence."""
    run = simulate(str(RECORDING), frames=1, ldf="thesis", feed="recorded", fidelity="fast")
    assert run.identity == simulate(frames=1, ldf=LDF_FOLDER / "thesis.ldf", feed=Feed.RECORDED).identity
    for wrong, words in (
        ({"feed": "slow"}, "feed must be one of demand, recorded, cameras, not 'slow'"),
        ({"fidelity": "good"}, "fidelity must be one of fast, detailed, not 'good'"),
        ({"ldf": "nowhere"}, "LDF must be a file or a shipped one"),
        ({"script": 5}, "script must be a file, not int"),
        ({"firmware": tinyphoon}, "a Firmware or the name of one, not module; it has tinyphoon.tinyphoon, "),
        ({"firmware": None}, "firmware must be a Firmware or the name of one, not NoneType"),
        ({"board": 561}, "board must be a BoardSpec or the name of one, not int"),
        ({"settings": [3]}, "settings must be a dict of numbers by their paths, .* not list"),
        ({"defines": "USE_SDRAM"}, "defines must be a dict of macros, .* not str"),
        ({"include_dirs": "vdk"}, "include_dirs must be a list of folders, not str"),
        ({"include_dirs": Path("vdk")}, "include_dirs must be a list of folders, not PosixPath"),
        ({"ldf": 3}, "ldf must be a file or the name of a shipped one, not int"),
        ({"profile": None}, "profile must be the name of a compiler profile, not NoneType"),
        ({"on_seen": []}, "on_seen must be a function, not list"),
        (
            {"recording": load_firmware("tinyphoon").firmware},
            r"recording must be a file, not Firmware; write `simulate\(firmware=...\)`",
        ),
    ):
        with pytest.raises(BfsimError, match=words):
            simulate(frames=1, **wrong)  # type: ignore[arg-type]
    for number in ("2", 2.5):
        with pytest.raises(ConfigError, match=f"frames must be a whole number, not {type(number).__name__}"):
            simulate(frames=number)  # type: ignore[arg-type]
    assert simulate(frames=np.int64(1)).identity == simulate(frames=1).identity


def test_a_camera_that_is_too_fast_is_told_before_anything_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As by `bfsim sweep --dry-run`, which listed such a point as one to run."""
    monkeypatch.chdir(tmp_path)
    Path("fw_eyes.py").write_text(FIRMWARE)
    recording = record(tmp_path / "large.mcap", 1, width=640, height=480)
    with pytest.raises(
        ConfigError, match="pictures of 640x480 are too large for a camera that sends 30 of them a second"
    ):
        planned(recording=recording, firmware="fw_eyes:eyes", settings={"clocks.sclk_hz": 40_000_000})
