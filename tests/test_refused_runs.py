"""Runs that are refused: recordings, names, LDFs and firmware with a mistake, each told in one paragraph."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bfsim.recording.writer import RecordingWriter
from bfsim.shipped import RECORDING
from tests.commands import refused


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
        assert "mine.py:7:18: index 16 is outside of row in kernel outside" in message
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
