"""Files that are no bag, or a damaged one, and what a bag must not do: grow in memory, make code, or be overwritten."""

from __future__ import annotations

import sys
import tracemalloc
from pathlib import Path
from random import Random

import numpy as np
import pytest
from PIL import Image
from rosbags.rosbag2 import CompressionMode

from bfsim.errors import RecordingError
from bfsim.recording import RecordingReader
from bfsim.recording.importing.importer import import_recording
from bfsim.recording.writer import RecordingWriter
from tests.recording.bag_imports import each_kind, imported
from tests.recording.bags import (
    Ros,
    grey_pair,
)
from tests.recording.test_recording_foreign import raw_image, write_foreign


@each_kind
def test_a_bag_is_not_overwritten_by_its_recording(kind: str, tmp_path: Path) -> None:
    """`record import drive.mcap drive.mcap --force` put the pictures in the place of all that the bag had."""
    ros = Ros(kind)
    path = ros.write(tmp_path, grey_pair(ros, range(2)))
    file = path if path.is_file() else next(each for each in path.iterdir() if each.suffix != ".yaml")
    before = file.read_bytes()
    with pytest.raises(
        RecordingError, match="must be a file of its own, not one that it is made of|not one of pictures"
    ):
        import_recording([path], file, force=True)
    assert file.read_bytes() == before


def test_a_recording_is_no_bag_and_a_bag_no_recording(tmp_path: Path) -> None:
    """Both are MCAP; each is told what it is by its schemas."""
    own = tmp_path / "own.mcap"
    with RecordingWriter(own, width=8, height=4) as writer:
        writer.add(np.zeros((4, 16), np.uint8), np.zeros((4, 16), np.uint8), 0, 0)
    with pytest.raises(RecordingError, match="it is a recording already, which `bfsim run` plays"):
        import_recording([own], tmp_path / "a.mcap")
    foreign = write_foreign(tmp_path / "seen.mcap", [("/camera/left/image_rect", 0, raw_image())])
    with pytest.raises(RecordingError, match=r"its messages are not those of ROS but foxglove\.RawImage$"):
        import_recording(
            [foreign], tmp_path / "a.mcap"
        )  # `bfsim run`, which was told to play it, refused it, too
    ros = Ros("mcap")
    (bag,) = ros.write(tmp_path, grey_pair(ros, range(2))).glob("*.mcap")
    with pytest.raises(RecordingError, match="`bfsim record import` makes a recording of a bag of ROS"):
        RecordingReader(bag)


@pytest.mark.parametrize("kind", ["mcap", "db3"])
@pytest.mark.parametrize("mode", [CompressionMode.FILE, CompressionMode.MESSAGE])
def test_a_compressed_bag_is_read_by_its_folder(kind: str, mode: CompressionMode, tmp_path: Path) -> None:
    """Its file alone does not say how it is compressed: pictures were of an unsupported encapsulation, or no bag at all."""
    folder = Ros(kind).write(tmp_path, grey_pair(Ros(kind), range(2)), compression=mode)
    assert len(imported(folder)) == 2
    (file,) = (each for each in folder.iterdir() if each.name != "metadata.yaml")
    advice = r"it is compressed, as metadata\.yaml beside it says: give the folder with both"
    with pytest.raises(RecordingError, match=rf"{file.name}: .*{advice}"):
        import_recording([file], tmp_path / "a.mcap")


@each_kind
def test_a_cut_bag_is_refused(kind: str, tmp_path: Path) -> None:
    """Wherever it was cut, with its name; nothing is left of the recording."""
    ros = Ros(kind)
    path = ros.write(tmp_path, grey_pair(ros, range(4)))
    file = path if path.is_file() else next(path.glob("*.[md]*[p3]"))
    whole = file.read_bytes()
    for part in (0, 7, 100, len(whole) // 3, len(whole) // 2):
        file.write_bytes(whole[:part])
        assert frames_of(path, tmp_path / "out.mcap") == 0
    file.write_bytes(whole[:-20])
    # newer versions of SQLite end a file with a page that no picture needs
    assert frames_of(path, tmp_path / "out.mcap") in ((0, 4) if kind == "db3" else (0,))


def frames_of(bag: Path, made: Path) -> int:
    """How many frames of a bag are imported: 0 if it is refused with its name, and nothing is left."""
    try:
        return import_recording([bag], made).frame_count
    except RecordingError as error:
        assert "drive" in str(error)
        assert not made.exists()
        return 0


@pytest.mark.exhaustive
@each_kind
def test_a_damaged_bag_is_refused_or_read(kind: str, tmp_path: Path) -> None:
    """Some bytes are others: no traceback, and no picture of another size."""
    ros = Ros(kind)
    path = ros.write(tmp_path, grey_pair(ros, range(4)))
    file = path if path.is_file() else next(path.glob("*.[md]*[p3]"))
    whole = file.read_bytes()
    refused = 0
    random = Random(15)
    for _ in range(60):
        octets = bytearray(whole)
        for _ in range(random.choice((1, 2, 8))):
            octets[random.randrange(len(octets))] = random.choice((0, 1, 127, 255, random.randrange(256)))
        file.write_bytes(octets)
        try:
            summary = import_recording([path], tmp_path / "out.mcap", force=True)
        except RecordingError as error:
            refused += 1
            assert len(str(error)) < 1000
        else:
            assert (summary.width, summary.height) == (8, 4)
    assert refused


def test_other_files_are_no_bags(tmp_path: Path) -> None:
    """By name, and by what is in them."""
    for name, octets in (
        ("a.bag", b""),
        ("b.bag", b"#ROSBAG V1.2\n"),
        ("c.db3", b"SQLite format 3\0"),
        ("d.mcap", b"mcap"),
    ):
        (tmp_path / name).write_bytes(octets)
        with pytest.raises(RecordingError, match=f"{name}: bag must be whole and of ROS"):
            import_recording([tmp_path / name], tmp_path / "out.mcap")
    with pytest.raises(RecordingError, match="none.bag: bag must be a file or a folder, but is not there"):
        import_recording([tmp_path / "none.bag"], tmp_path / "out.mcap")
    (tmp_path / "metadata.yaml").write_text("!!python/object/apply:os.system ['touch pwned']\n")
    with pytest.raises(RecordingError, match="bag must be whole and of ROS"):
        import_recording([tmp_path], tmp_path.parent / "out.mcap")
    assert not Path("pwned").exists()


def test_a_recording_that_was_cut_short_is_told_how_it_is_mended(tmp_path: Path) -> None:
    """A bag of ROS 2 whose recorder died has a part of a file and no metadata: it was no bag, and no advice was given."""
    ros = Ros("mcap")
    path = ros.write(tmp_path, grey_pair(ros, range(2)))
    (file,) = path.glob("*.mcap")
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])
    for source in (file, path):
        with pytest.raises(RecordingError, match=r"must be whole and of ROS: .*; `mcap recover` may mend it"):
            import_recording([source], tmp_path / "out.mcap")
    (path / "metadata.yaml").unlink()
    file.rename(path / "drive_0.mcap")
    with pytest.raises(RecordingError, match=r"metadata.yaml is written at the end .* `ros2 bag reindex`"):
        import_recording([path], tmp_path / "out.mcap")
    Image.new("L", (8, 4)).save(path / "seen.png")
    assert import_recording([path], tmp_path / "out.mcap", mono=True).frame_count == 1, (
        "pictures beside recordings"
    )


def test_nothing_is_made_of_the_definitions_in_a_bag(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """rosbags would make code of them; an Image of one's own is refused."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, grey_pair(ros, range(2)))
    octets = path.read_bytes()
    assert len(imported(path)) == 2

    def refuse(*_: object) -> None:
        raise AssertionError("a definition was compiled")

    monkeypatch.setattr("rosbags.typesys.store.Typestore.register", refuse)
    assert len(imported(path)) == 2
    path.write_bytes(octets.replace(b"060021388200f6f0f447d0fcd9c64743", b"1" * 32))
    with pytest.raises(
        RecordingError, match="must have sensor_msgs/msg/Image as ROS defines it, not another"
    ):
        imported(path)


def test_without_rosbags_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is optional."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, grey_pair(ros, range(2)))
    monkeypatch.setitem(sys.modules, "rosbags", None)
    with pytest.raises(RecordingError, match=r'pip install "bfsim\[ros\]"'):
        imported(path)


@pytest.mark.exhaustive
def test_memory_does_not_grow_with_the_bag(tmp_path: Path) -> None:
    """Four times as many pictures, the same peak."""
    ros = Ros("ros1")
    peaks = []
    for count in (10, 40):
        folder = tmp_path / str(count)
        folder.mkdir()
        path = ros.write(folder, grey_pair(ros, range(count), size=(320, 240)))
        imported(path.parent / path.name, mono=False)
        tracemalloc.start()
        import_recording([path], folder / "again.mcap")
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.2 * peaks[0]
