"""Recordings as files: what goes in comes out, in constant memory, and damage is always noticed."""

from __future__ import annotations

import json
import os
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from mcap.reader import make_reader

from bfsim.errors import RecordingError
from bfsim.recording import (
    DisparityImage,
    RecordingReader,
    RectificationTables,
    StereoGeometry,
    UyvyImage,
)
from bfsim.recording.writer import RecordingWriter

LEFT, RIGHT = "/camera/left/image_raw", "/camera/right/image_raw"
WIDTH, HEIGHT = 16, 8
GEOMETRY = StereoGeometry(focal_px=386.0, baseline_mm=30.0, height_mm=61.5, tilt_deg=-12.25)


def picture(seed: int, width: int = WIDTH, height: int = HEIGHT) -> UyvyImage:
    """Return a picture of noise, other for every seed."""
    return np.random.default_rng(seed).integers(0, 256, (height, 2 * width), dtype=np.uint8)


def disparity(seed: int, width: int = WIDTH, height: int = HEIGHT) -> DisparityImage:
    """Return disparities of chance, other for every seed."""
    return np.random.default_rng(seed).random((height, width), np.float32)


def write(path: Path, count: int = 3, width: int = WIDTH, height: int = HEIGHT) -> Path:
    """Write a recording of noise with geometry, tables and ground truth; the right camera lags by 7 us."""
    table = np.indices((height, width), np.int32)[:, ::-1].copy()
    table[:, 0, 0] = -1
    with RecordingWriter(
        path,
        width=width,
        height=height,
        geometry=GEOMETRY,
        description="noise",
        rectification=RectificationTables(table, table),
    ) as writer:
        for k in range(count):
            images = picture(2 * k, width, height), picture(2 * k + 1, width, height)
            writer.add(
                *images, k * 40_000_000, k * 40_000_000 + 7_000, {"frame": k}, disparity(k, width, height)
            )
    return path


def read(path: Path) -> list[tuple[object, ...]]:
    """Return everything a reader sees, comparable."""
    with RecordingReader(path) as reader:
        head = (reader.geometry, reader.description, reader.width, reader.height, reader.frame_count)
        tables = reader.rectification
        sides = (tables.left.tobytes(), tables.right.tobytes()) if tables else ()
        frames = [
            (f.index, f.left.tobytes(), f.right.tobytes(), f.left_ns, f.right_ns, f.truth)
            for f in reader.frames()
        ]
    return [head, sides, *frames]


def test_round_trip(tmp_path: Path) -> None:
    """Pictures, stamps, geometry, tables, description, truth and disparities come back bit for bit."""
    with RecordingReader(write(tmp_path / "a.mcap")) as reader:
        assert (reader.width, reader.height, reader.frame_count) == (WIDTH, HEIGHT, 3)
        assert (reader.geometry, reader.description, reader.truth_count) == (GEOMETRY, "noise", 3)
        assert reader.rectification is not None
        assert reader.rectification.right[:, 0, 0].tolist() == [-1, -1]
        assert reader.rectification.right[:, 0, 1].tolist() == [HEIGHT - 1, 1]
        for k, frame in enumerate(reader.frames()):
            assert frame.index == k
            np.testing.assert_array_equal(frame.left, picture(2 * k))
            np.testing.assert_array_equal(frame.right, picture(2 * k + 1))
            assert (frame.left_ns, frame.right_ns) == (k * 40_000_000, k * 40_000_000 + 7_000)
            assert frame.truth == {"frame": k}
            np.testing.assert_array_equal(frame.disparity_px, disparity(k))


def test_bare_recording_has_no_extras(tmp_path: Path) -> None:
    """Without geometry, tables and truth the reader says None, not some default."""
    with RecordingWriter(tmp_path / "a.mcap", width=WIDTH, height=HEIGHT) as writer:
        writer.add(picture(0), picture(1), 5, 3)
    with RecordingReader(tmp_path / "a.mcap") as reader:
        assert (reader.geometry, reader.rectification, reader.description) == (None, None, "")
        assert next(reader.frames()).truth is None


def test_truth_belongs_to_its_frame(tmp_path: Path) -> None:
    """Truth of some frames only, with the right camera ahead of the left, stays with those frames."""
    with RecordingWriter(tmp_path / "a.mcap", width=WIDTH, height=HEIGHT) as writer:
        for k in range(6):
            writer.add(picture(0), picture(1), 100 * k + 90, 100 * k, {"k": k} if k % 2 else None)
    with RecordingReader(tmp_path / "a.mcap") as reader:
        assert [frame.truth for frame in reader.frames()] == [None, {"k": 1}, None, {"k": 3}, None, {"k": 5}]


def test_limit(tmp_path: Path) -> None:
    """A limit ends the frames early; one beyond the end does not matter; each call starts anew."""
    with RecordingReader(write(tmp_path / "a.mcap", 5)) as reader:
        assert [frame.index for frame in reader.frames(2)] == [0, 1]
        assert len(list(reader.frames(99))) == 5
        assert list(reader.frames(0)) == []


def test_other_viewers_understand_it(tmp_path: Path) -> None:
    """The file says what Foxglove needs: RawImage in protobuf, encoding uyvy, stamps in both places."""
    with write(tmp_path / "a.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        schema, channel, message = next(iter(reader.iter_messages([RIGHT])))
    assert summary is not None
    assert {index.compression for index in summary.chunk_indexes} == {"zstd"}
    assert schema is not None
    assert (schema.name, schema.encoding, channel.message_encoding) == (
        "foxglove.RawImage",
        "protobuf",
        "protobuf",
    )
    image = RawImage.FromString(message.data)
    assert (image.encoding, image.step, image.frame_id) == ("uyvy", 2 * WIDTH, "right")
    assert image.timestamp.ToNanoseconds() == message.log_time == 7_000


def test_same_input_gives_same_bytes(tmp_path: Path) -> None:
    """A recording carries no clock time and no path, so it can be compared and cached by its bytes."""
    assert write(tmp_path / "a.mcap").read_bytes() == write(tmp_path / "b.mcap").read_bytes()


@pytest.mark.exhaustive
def test_memory_does_not_grow_with_length(tmp_path: Path) -> None:
    """Reading 400 frames takes no more memory than 40 (several chunks each)."""
    peaks = []
    for count in (40, 400):
        path = write(tmp_path / f"{count}.mcap", count, width=160, height=120)
        tracemalloc.start()
        with RecordingReader(path) as reader:
            assert sum(1 for _ in reader.frames()) == count
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.15 * peaks[0]
    assert peaks[1] < 8 << 20


def test_every_cut_is_noticed(tmp_path: Path) -> None:
    """A recording cut off after any byte is refused when it is opened, in a message that names the file."""
    whole = write(tmp_path / "a.mcap", 2).read_bytes()
    cut = tmp_path / "cut.mcap"
    for length in range(0, len(whole), 23):
        cut.write_bytes(whole[:length])
        with pytest.raises(RecordingError, match=r"cut\.mcap: recording must"):
            RecordingReader(cut)


def test_every_flipped_bit_is_noticed_or_harmless(tmp_path: Path) -> None:
    """With one bit wrong anywhere, reading either raises or still gives the very same frames."""
    path = write(tmp_path / "a.mcap", 2)
    whole, expected = path.read_bytes(), read(path)
    refused = 0
    for position in range(0, len(whole), 5):
        damaged = bytearray(whole)
        damaged[position] ^= 1 << position % 8
        path.write_bytes(damaged)
        try:
            assert read(path) == expected, f"byte {position}"
        except RecordingError:
            refused += 1
    assert refused > len(whole) / 5 * 0.8


def test_corrupt_chunk_names_its_byte(tmp_path: Path) -> None:
    """Damage in the pictures is reported with the offset of the chunk."""
    path = write(tmp_path / "a.mcap", 2)
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    chunk = summary.chunk_indexes[0]
    damaged = bytearray(path.read_bytes())
    damaged[chunk.chunk_start_offset + chunk.chunk_length // 2] ^= 0xFF
    path.write_bytes(damaged)
    with pytest.raises(
        RecordingError, match=f"the chunk at byte {chunk.chunk_start_offset} must be readable"
    ):
        read(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "not an empty one"),
        (
            b"\x89PNG\r\n\x1a\n" + bytes(99),
            r"must be an MCAP file, not one that starts with '\\x89PNG.*record import",
        ),
    ],
)
def test_not_an_mcap(tmp_path: Path, content: bytes, message: str) -> None:
    """A file of another kind is refused by its first bytes, with a hint at the importer."""
    (tmp_path / "x.mcap").write_bytes(content)
    with pytest.raises(RecordingError, match=message):
        RecordingReader(tmp_path / "x.mcap")


@pytest.mark.parametrize(
    ("name", "advice"), [("mine.py", "--firmware"), ("placed.LDF", "--ldf"), ("orders.json", "--script"), ("budget.toml", "--baseline")]
)  # fmt: skip
def test_another_file_of_the_user_is_told_where_it_goes(tmp_path: Path, name: str, advice: str) -> None:
    """`bfsim run mine.py` is a slip of whoever begins: no recording is to be made of it."""
    (tmp_path / name).write_text("firmware = 3\n")
    with pytest.raises(RecordingError, match=rf"must be an MCAP file, not one .*goes behind .*{advice}"):
        RecordingReader(tmp_path / name)


def test_a_pipe_is_told_as_one(tmp_path: Path) -> None:
    """It could only be read from its begin to its end; one that nobody writes to is not waited for."""
    os.mkfifo(tmp_path / "a.mcap")
    with pytest.raises(RecordingError, match=r"a\.mcap: recording must be a file .*, not a pipe; save it"):
        RecordingReader(tmp_path / "a.mcap")


def test_missing_file(tmp_path: Path) -> None:
    """A path that is not there, or is a folder, is an error of the recording and not of the program."""
    for path, why in (
        (tmp_path / "none.mcap", ": No such"),
        (tmp_path, ", not a folder; `bfsim record import` makes one"),
    ):
        with pytest.raises(RecordingError, match=f"must be a readable file{why}"):
            RecordingReader(path)


def test_truth_is_json_of_its_schema(tmp_path: Path) -> None:
    """The truth channel is plain JSON with a JSON schema, so other programs can read it."""
    with write(tmp_path / "a.mcap").open("rb") as stream:
        schema, channel, message = next(iter(make_reader(stream).iter_messages(["/truth"])))
    assert schema is not None
    assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
    assert json.loads(schema.data)["type"] == "object"
    assert json.loads(message.data) == {"frame": 0}
