"""A recorded run that is played on other hardware is the run of the firmware there, to the cycle; else it is refused in words."""

from __future__ import annotations

import random
import sys
from dataclasses import fields
from itertools import islice
from pathlib import Path
from typing import Any

import pytest

from bfsim.errors import BfsimWarning, ConfigError, WorkError
from bfsim.kernel import Kernel
from bfsim.recording import RecordingReader
from bfsim.recording.writer import RecordingWriter
from bfsim.result import Run
from bfsim.run import Feed, Fidelity, simulate
from bfsim.shipped import RECORDING
from tests.eyes import FIRMWARE, record
from tests.tiers import exhaustive
from tests.work_files import rewritten

FRAMES = 2
HOSTS_OWN = {"events"}
"""Fields of a run that say what it took the host; the ones below also say what was asked for."""


def random_hardware(seed: int) -> dict[str, object]:
    """Return numbers of a board to change: clocks, latencies, DMA and bus settings."""
    among = random.Random(seed)
    return {
        "clocks.cclk_hz": among.choice([300e6, 450e6, 500e6, 600e6]),
        "clocks.sclk_hz": among.choice([75e6, 100e6, 120e6]),
        "sdram.nRP": among.randint(2, 5),
        "sdram.nRCD": among.randint(2, 5),
        "chip.l2.read_cclk": among.randint(5, 30),
        "chip.events.mmr_write_cclk": among.randint(1, 9),
        "dma_over_core": among.random() < 0.5,
        "deb_period_transfers": among.choice([0, 3, 15]),
        "mdma_period_transfers": among.choice([0, 5]),
    }


def differing(one: Run, other: Run) -> set[str]:
    """Return the fields in which two runs differ."""
    compared = [each.name for each in fields(one) if each.compare]
    return {each for each in compared if getattr(one, each) != getattr(other, each)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder for recorded runs."""
    return tmp_path_factory.mktemp("work")


@pytest.fixture(scope="module")
def plain() -> Run:
    """Return a run of the built-in firmware."""
    return simulate(frames=FRAMES)


@pytest.fixture(scope="module")
def work(folder: Path, plain: Run) -> Path:
    """Return the recorded work of that run; recording it changes nothing, and takes no event more: it runs ahead, too."""
    path = folder / "thesis.work"
    assert not differing(plain, simulate(frames=FRAMES, record_work=path))
    return path


def test_a_recorded_run_is_played_as_it_was(work: Path, plain: Run) -> None:
    """Every record is the same: frames, owners, stalls by site, traffic, results, messages, identity."""
    assert differing(plain, simulate(frames=FRAMES, work=work)) <= HOSTS_OWN


def test_a_play_makes_no_kernel_ready_to_run(work: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the calls cost was recorded. That they were bound to their rows, and their machine code loaded, was a fifth of a short play."""

    def refused(*_: object, **__: object) -> Any:
        raise AssertionError("a play wants to call a kernel")

    monkeypatch.setattr(Kernel, "prepare", refused)
    assert simulate(frames=FRAMES, work=work).frames


def test_a_play_does_not_look_at_pictures_again(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What it is warned of is what their cameras were doubted for in the run: here left is right."""
    recording, path = folder / "exchanged.mcap", folder / "exchanged.work"
    with (
        RecordingReader(RECORDING) as reader,
        RecordingWriter(recording, width=reader.width, height=reader.height) as writer,
    ):
        for frame in islice(reader.frames(), FRAMES):
            writer.add(frame.right, frame.left, frame.left_ns, frame.right_ns)
    plain = simulate(recording, record_work=path)
    assert any("seem to be exchanged" in each.text for each in plain.assumptions)

    def refused(*_: object) -> Any:
        raise AssertionError("a play looks at pictures")

    for name in ("exchanged_places", "row_offsets"):
        monkeypatch.setattr(f"bfsim.recording.stereo.stereo_check.{name}", refused)
    assert differing(plain, simulate(recording, work=path)) <= HOSTS_OWN


def test_pictures_are_those_of_the_recorded_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file that is the same, byte by byte, is not unpacked; of one that is stored otherwise each pixel is compared."""
    recording, path = small(tmp_path, monkeypatch)
    what: dict[str, Any] = {"firmware": "fw_mixed:eyes"}
    plain = simulate(recording, record_work=path, **what)
    with RecordingReader(recording) as reader:
        frames = [(each.left.copy(), each.right, each.left_ns, each.right_ns) for each in reader.frames()]
        size = {"width": reader.width, "height": reader.height}

    def store() -> None:
        with RecordingWriter(recording, **size, description="stored anew") as writer:
            for each in frames:
                writer.add(*each)

    def unread(*_: object) -> Any:
        raise AssertionError("a play unpacks pictures")

    with monkeypatch.context() as patched:
        patched.setattr(RecordingReader, "frames", unread)
        assert differing(plain, simulate(recording, work=path, **what)) <= HOSTS_OWN
    store()
    assert differing(plain, simulate(recording, work=path, **what)) <= HOSTS_OWN
    frames[1][0][-1, -1] ^= 1
    store()
    with pytest.raises(WorkError, match=r"must be as it was when its run was recorded, but frame 1 differs"):
        simulate(recording, work=path, **what)


@pytest.mark.parametrize("seed", [0, *exhaustive(1, 2, 3)])
def test_it_is_the_run_of_other_hardware(work: Path, plain: Run, seed: int) -> None:
    """Whatever the clocks, the latencies, and the settings of DMA and bus."""
    settings = random_hardware(seed)
    there = simulate(frames=FRAMES, settings=settings)
    assert there.frames != plain.frames
    assert differing(there, simulate(frames=FRAMES, work=work, settings=settings)) <= HOSTS_OWN


@pytest.mark.exhaustive
@pytest.mark.parametrize("profile", ["gcc-adi", "vdsp-O2"])
def test_it_is_the_run_of_another_placement(folder: Path, profile: str) -> None:
    """What was recorded with buffers outside of L1 is played where they are elsewhere, and code that is fetched, too.

    The reverse is refused, with a buffer's name.
    """
    path = folder / "sdram.work"
    outside = simulate(frames=1, ldf=Path("sdram"), profile=profile, record_work=path)
    for ldf in ("thesis", "l2"):
        there = simulate(frames=1, ldf=Path(ldf), profile=profile)
        assert there.frames != outside.frames
        assert differing(there, simulate(frames=1, ldf=Path(ldf), profile=profile, work=path)) <= HOSTS_OWN
    simulate(frames=1, profile=profile, record_work=path)
    with pytest.raises(WorkError, match=r"must be in L1, for it was when the run was recorded"):
        simulate(frames=1, ldf=Path("sdram"), profile=profile, work=path)


@pytest.mark.exhaustive
def test_caches_are_played_with_their_ldf(folder: Path) -> None:
    """Which lines a cache fetches depends on addresses: another board is the same run, another LDF is refused."""
    path, settings = folder / "cache.work", {"sdram.nRP": 5}
    simulate(frames=1, ldf=Path("cache"), record_work=path)
    there = simulate(frames=1, ldf=Path("cache"), settings=settings)
    assert differing(there, simulate(frames=1, ldf=Path("cache"), work=path, settings=settings)) <= HOSTS_OWN
    with pytest.raises(WorkError, match=r"must be played with the LDF that it was recorded with"):
        simulate(frames=1, work=path)


def test_missed_frames_are_said(folder: Path) -> None:
    """Where slower cores miss a frame, they do something else than was recorded."""
    path = folder / "recorded.work"
    simulate(frames=5, feed=Feed.RECORDED, record_work=path)
    with pytest.raises(WorkError, match=r"core [AB] gets .* where it got frame \d when the run was recorded"):
        simulate(frames=5, feed=Feed.RECORDED, work=path, settings={"clocks.cclk_hz": 200e6})


WITH_HANDLERS = """
from dataclasses import replace

from tinyphoon import tinyphoon


def with_handler(main):
    def handled(core):
        core.on_interrupt("SPI_DMA", lambda _: None)
        yield from main(core)

    return handled


interrupted = replace(tinyphoon, mains={core: with_handler(main) for core, main in tinyphoon.mains.items()})
"""


def test_handlers_of_interrupts_are_said(folder: Path) -> None:
    """They come when the hardware has them, between other calls on other hardware."""
    path, source = folder / "handlers.work", folder / "with_handlers.py"
    source.write_text(WITH_HANDLERS)
    firmware = f"{source}:interrupted"
    said = r"cannot be played on other hardware, .*: core A has a handler of the interrupt SPI_DMA.*, and 1 more like it"
    with pytest.warns(BfsimWarning, match=said):
        simulate(firmware=firmware, frames=1, record_work=path)
    with pytest.raises(WorkError, match=said):
        simulate(firmware=firmware, frames=1, work=path)


def small(folder: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, Path]:
    """Go where a firmware of one kernel is, `fw_mixed`; return a recording for it, and where to record its work."""
    (folder / "fw_mixed.py").write_text(FIRMWARE)
    monkeypatch.chdir(folder)
    return record(folder / "drive.mcap", FRAMES), folder / "thesis.work"


def test_an_interrupted_run_leaves_the_file_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A part of a run cannot be played: it is not put in the place of a whole one, nor where there was none."""
    recording, path = small(tmp_path, monkeypatch)
    stops = FIRMWARE.replace(
        "core.next_frame())) is not None:\n",
        "core.next_frame())) is not None:\n        if frame.index:\n            raise KeyboardInterrupt\n",
    )
    (tmp_path / "fw_stops.py").write_text(stops)
    assert simulate(recording, firmware="fw_stops:eyes", record_work=path).interrupted
    assert not path.exists()
    simulate(recording, firmware="fw_mixed:eyes", record_work=path)
    whole = path.read_bytes()
    assert simulate(recording, firmware="fw_stops:eyes", record_work=path).interrupted
    assert path.read_bytes() == whole


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ({"frames": 1}, r"must be played for as many frames as it has, 2, not for 1"),
        (
            {"profile": "gcc-O2"},
            r"must be recorded with the same compiler, 'gcc-O2', not with 'gcc-adi': give it again by --profile, or",
        ),
        (
            {"firmware": "tinyphoon"},
            r"firmware, 'tinyphoon', not with 'fw_mixed:eyes': give it again by --firmware, or record it",
        ),
    ],
)
def test_another_run_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, what: dict[str, Any], said: str
) -> None:
    """Frames and compiler must be those of the recorded run."""
    recording, path = small(tmp_path, monkeypatch)
    simulate(recording, firmware="fw_mixed:eyes", record_work=path)
    with pytest.raises(WorkError, match=said):
        simulate(recording, work=path, **{"firmware": "fw_mixed:eyes"} | what)


def test_what_needs_more_than_cycles_is_refused(work: Path, folder: Path) -> None:
    """There are no pictures, and no events of single words."""
    with pytest.raises(ConfigError, match="--work must go without pictures"):
        simulate(frames=FRAMES, work=work, on_seen=lambda _: None)
    with pytest.raises(ConfigError, match="--work must go with --fidelity fast"):
        simulate(frames=FRAMES, work=work, fidelity=Fidelity.DETAILED)
    with pytest.raises(ConfigError, match="--record-work must go with --fidelity fast"):
        simulate(frames=FRAMES, record_work=folder / "none.work", fidelity=Fidelity.DETAILED)
    with pytest.raises(ConfigError, match="--record-work must go without --trace"):
        simulate(frames=FRAMES, record_work=folder / "none.work", on_spans=lambda _: None)
    assert not (folder / "none.work").exists()


def test_firmware_that_imports_while_it_runs_is_played(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A module of its own folder, and no other that the file names: it ended in a ModuleNotFoundError."""
    kernel, main = FIRMWARE[: FIRMWARE.index("def main")], FIRMWARE[FIRMWARE.index("def main") :]
    (tmp_path / "fw_kernels.py").write_text(kernel)
    head, _, rest = main.partition("\n")
    api = "from bfsim.api import *\n"
    (tmp_path / "fw_late.py").write_text(f"{api}{head}\n    from fw_kernels import threshold\n{rest}")
    record(tmp_path / "drive.mcap", 1)
    what = {"recording": tmp_path / "drive.mcap", "firmware": f"{tmp_path}/fw_late.py"}
    plain = simulate(**what, record_work=tmp_path / "run.work")
    other = rewritten(
        tmp_path / "run.work",
        tmp_path / "odd.work",
        lambda end: end["modules"].append("antigravity"),
        "end.json",
    )
    monkeypatch.setitem(sys.modules, "antigravity", None)  # would be an ImportError
    for path in (tmp_path / "run.work", other):
        monkeypatch.setattr("bfsim.loading.modules._imported", {})  # as in another process
        assert simulate(**what, work=path).frames == plain.frames


def test_a_frame_takes_less_than_200_kb(work: Path) -> None:
    """With the LDF of the built-in firmware."""
    assert work.stat().st_size / FRAMES < 200_000


def test_what_leaves_l1_is_refused_even_beside_what_was_outside(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A kernel with one array in L2 has accesses on record, but not those to its rows in L1, which `l2` puts outside."""
    recording, path = small(tmp_path, monkeypatch)
    simulate(recording, firmware="fw_mixed:eyes", record_work=path)
    with pytest.raises(WorkError, match=r"ring \(A\), out \(A\) must be in L1"):
        simulate(recording, firmware="fw_mixed:eyes", ldf=Path("l2"), work=path)
