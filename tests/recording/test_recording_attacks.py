"""MCAP files made to do harm: each is refused in words about what is wrong with it, and in little memory."""

from __future__ import annotations

import io
import struct
import subprocess
import sys
import tracemalloc
from pathlib import Path

import lz4.frame
import numpy as np
import pytest
import zstandard

from bfsim.errors import RecordingError
from bfsim.recording import RecordingReader
from bfsim.recording.importing.rectification_files import load_rectification
from bfsim.recording.writer import RecordingWriter
from tests.recording.attacks import (
    FIRST_CHUNK_AT,
    IMAGE,
    attachment_index,
    chunk,
    chunk_index,
    message,
    pair,
    record,
    text,
    write,
)
from tests.tiers import exhaustive

BOMB_BYTES = 256 << 20
LIMIT_KB = 300 << 10


def read(path: Path) -> int:
    """Read a recording; return how many frames it has."""
    with RecordingReader(path) as reader:
        return len(list(reader.frames()))


def test_the_file_that_is_attacked_is_sound(tmp_path: Path) -> None:
    """What is refused below is refused for its one fault."""
    data = pair() + pair(1)
    for compression, stored in {
        "": data,
        "zstd": zstandard.compress(data),
        "lz4": lz4.frame.compress(data),
    }.items():
        whole = chunk(stored, nbytes=len(data), compression=compression)
        assert read(write(tmp_path / "a.mcap", [whole], counts=(2, 2))) == 2


def streamed(data: bytes) -> bytes:
    """Return data in zstd as a program writes it that does not know its size beforehand."""
    return zstandard.ZstdCompressor(write_content_size=False).compress(data)


ZEROS = bytes(BOMB_BYTES)
BOMBS = {"zstd": zstandard.compress(ZEROS), "lz4": lz4.frame.compress(ZEROS)}


@pytest.mark.parametrize(
    ("stored", "compression", "said", "message"),
    [
        (BOMBS["zstd"], "zstd", BOMB_BYTES, "the chunk at byte 31 must hold at most 128 MiB, not 256 MiB"),
        (BOMBS["lz4"], "lz4", BOMB_BYTES, "the chunk at byte 31 must hold at most 128 MiB, not 256 MiB"),
        (BOMBS["zstd"], "zstd", 1000, "it says 1000 bytes, and its compressed data say 268435456"),
        (streamed(ZEROS), "zstd", 1000, "did not decompress full frame"),
        (BOMBS["lz4"], "lz4", 1000, "it says 1000 bytes and holds 1001"),
        *exhaustive(
            (bytes(200 << 20), "", 1000, "the chunk at byte 31 must hold at most 128 MiB, not 200 MiB")
        ),
        (b"", "", 1 << 63, "must hold at most 128 MiB"),
        (pair(), "brotli", len(pair()), "compression must be zstd, lz4 or none, not 'brotli'"),
        (pair()[:-1], "", len(pair()) - 1, "a record at its byte"),
    ],
)
def test_what_a_chunk_decompresses_to_is_bounded(
    tmp_path: Path, stored: bytes, compression: str, said: int, message: str
) -> None:
    """Whichever of the sizes in it is false, no more is decompressed than the bound."""
    path = write(tmp_path / "bomb.mcap", [chunk(stored, nbytes=said, compression=compression)])
    with pytest.raises(RecordingError, match=message):
        read(path)


def test_a_bomb_takes_little_memory(tmp_path: Path) -> None:
    """`bfsim record info` of a file of 8 KB that says it holds 256 MiB."""
    path = write(tmp_path / "bomb.mcap", [chunk(BOMBS["zstd"], nbytes=BOMB_BYTES, compression="zstd")])
    program = "from bfsim.cli.main import main\ntry: main()\nexcept SystemExit as end: print(end.code, open('/proc/self/status').read())"
    command = [sys.executable, "-c", program, "record", "info", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    words = done.stdout.split()
    assert words[0] == "2"
    assert int(words[words.index("VmHWM:") + 1]) < LIMIT_KB


def test_a_chunk_in_the_index_is_not_decompressed(tmp_path: Path) -> None:
    """The index holds no pictures."""
    bomb = chunk(BOMBS["zstd"], nbytes=BOMB_BYTES, compression="zstd")
    good = chunk(pair(), nbytes=len(pair()))
    tracemalloc.start()
    try:
        assert read(write(tmp_path / "a.mcap", [good], index=bomb)) == 1
        assert tracemalloc.get_traced_memory()[1] < BOMB_BYTES // 10
    finally:
        tracemalloc.stop()


def test_messages_without_end(tmp_path: Path) -> None:
    """Millions of empty messages compress to nothing."""
    many = message(1, 0, b"") * 70_000
    path = write(tmp_path / "a.mcap", [chunk(zstandard.compress(many), nbytes=len(many), compression="zstd")])
    with pytest.raises(RecordingError, match="must hold at most 65536 messages of the cameras"):
        read(path)


def test_one_chunk_many_times(tmp_path: Path) -> None:
    """An index may list one chunk a thousand times; its messages all wait for each other."""
    big = message(1, 5, bytes(100 << 20))
    whole = chunk(zstandard.compress(big), nbytes=len(big), compression="zstd")
    path = write(tmp_path / "a.mcap", [whole], index=chunk_index(FIRST_CHUNK_AT, len(whole)) * 1000)
    with pytest.raises(
        RecordingError, match="must follow the others in time, but 300 MiB of pictures overlap"
    ):
        read(path)


@pytest.mark.parametrize("offset", [(1 << 64) - 1, 1 << 63, (1 << 63) - 1, 1 << 40])
def test_offsets_behind_the_end(tmp_path: Path, offset: int) -> None:
    """Of an attachment and of a chunk, also where the system's own offsets end."""
    good = chunk(pair(), nbytes=len(pair()))
    for name in ("rectification_left.npy", "rectification_right.npy"):
        path = write(tmp_path / "a.mcap", [good], index=attachment_index(name, offset))
        with pytest.raises(
            RecordingError, match=f"{name}' at byte {offset} must be readable, but .* behind the end"
        ):
            read(path)
    path = write(tmp_path / "a.mcap", [], index=chunk_index(offset, 100))
    with pytest.raises(
        RecordingError, match=f"the chunk at byte {offset} must be readable, but .* behind the end"
    ):
        read(path)


@pytest.mark.parametrize("left_bytes", [1, 8])
def test_an_attachment_in_the_last_bytes(tmp_path: Path, left_bytes: int) -> None:
    """Not even its head has room there."""
    good, name = chunk(pair(), nbytes=len(pair())), "rectification_left.npy"
    path = write(tmp_path / "a.mcap", [good], index=attachment_index(name, 0))
    offset = path.stat().st_size - left_bytes
    write(path, [good], index=attachment_index(name, offset))
    with pytest.raises(
        RecordingError, match=f"{name}' at byte {offset} must be readable, but .* behind the end"
    ):
        read(path)


@pytest.mark.parametrize("counts", [(0, 0), (1, 1), (5, 5)])
def test_a_recording_without_pictures(tmp_path: Path, counts: tuple[int, int]) -> None:
    """Whatever it promises, and also where it holds some that it does not promise."""
    nothing = chunk(b"", nbytes=0)
    with pytest.raises(RecordingError, match="must have images in /camera/left/image_raw, not none"):
        read(write(tmp_path / "a.mcap", [nothing], counts=counts))
    some = chunk(pair(), nbytes=len(pair()))
    if counts == (0, 0):
        with pytest.raises(RecordingError, match="must have at least one stereo frame, not none"):
            read(write(tmp_path / "a.mcap", [some], counts=counts))


def test_a_picture_that_no_board_holds(tmp_path: Path) -> None:
    """It is refused for its size, and so is writing it."""
    side = 6000
    data = b"".join(message(camera, 0, IMAGE + bytes(2 * side * side)) for camera in (1, 2))
    whole = chunk(zstandard.compress(data), nbytes=len(data), compression="zstd")
    with pytest.raises(RecordingError, match="must hold at most 128 MiB, not 137 MiB"):
        read(write(tmp_path / "a.mcap", [whole]))
    with pytest.raises(RecordingError, match="must have at most 64 MiB in UYVY, not 6000x6000 pixels"):
        RecordingWriter(tmp_path / "b.mcap", width=side, height=side)


def npz() -> bytes:
    """Return an archive of arrays."""
    stream = io.BytesIO()
    np.savez(stream, np.zeros((2, 1, 2), np.int32))
    return stream.getvalue()


def npy(header: str) -> bytes:
    """Return a .npy file with any header."""
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode()


@pytest.mark.parametrize(
    "data",
    [
        npz(),
        b"",
        npy("{'descr': '<i4', 'fortran_order': False, 'shape': (2, 100000, 1000000)}\n"),
        npy("{'descr': '|O', 'fortran_order': False, 'shape': ()}\n"),
        npy("{'descr': '<i4', 'fortran_order': False, 'shape': (-1,)}\n"),
        npy("(((((((((\n"),
        npy("{'descr': '<i4', 'shape': [L\n"),
    ],
)
def test_a_table_that_is_no_array(tmp_path: Path, data: bytes) -> None:
    """In a recording and in a file alike."""
    good = chunk(pair(), nbytes=len(pair()))
    body = (
        struct.pack("<QQ", 0, 0)
        + text("rectification_left.npy")
        + text("")
        + struct.pack("<Q", len(data))
        + data
    )
    attachment = record(9, body + bytes(4))
    offset = FIRST_CHUNK_AT + len(good)
    index = b"".join(attachment_index(f"rectification_{side}.npy", offset) for side in ("left", "right"))
    path = write(tmp_path / "a.mcap", [good], index=index, attachments=[attachment])
    with pytest.raises(RecordingError, match="rectification table must be a .npy array"):
        read(path)
    (tmp_path / "table.npy").write_bytes(data)
    with pytest.raises(RecordingError, match="rectification table must be a .npy array"):
        load_rectification(tmp_path / "table.npy", tmp_path / "table.npy")
