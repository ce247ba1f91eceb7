"""Recordings made from images, raw frames, y4m and video: the right bytes, or an error that says where."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from bfsim.errors import RecordingError
from bfsim.recording import (
    RecordingReader,
    RectificationTables,
    StereoFrame,
    StereoGeometry,
)
from bfsim.recording.importer import import_recording, load_rectification
from bfsim.recording.planes import YuvPlanes

PRIMARIES = {"red": (255, 0, 0), "green": (0, 255, 0), "blue": (0, 0, 255), "white": (255, 255, 255)}
# BT.601, full range, by the equations of JFIF 1.02: (U, Y, V).
PRIMARIES_UYV = {
    "red": (85, 76, 255),
    "green": (44, 150, 21),
    "blue": (255, 29, 107),
    "white": (128, 255, 128),
}


def frames_of(path: Path) -> list[StereoFrame]:
    """Return all frames of a recording."""
    with RecordingReader(path) as reader:
        return list(reader.frames())


def save_grey(path: Path, level: int, size: tuple[int, int] = (8, 4)) -> None:
    """Save an image of one grey level."""
    path.parent.mkdir(exist_ok=True)
    Image.new("L", size, level).save(path)


def noise(shape: tuple[int, ...], seed: int = 0) -> np.ndarray:
    """Return random bytes."""
    return np.random.default_rng(seed).integers(0, 256, shape, dtype=np.uint8)


def test_pictures_of_one_camera_alone_are_skipped_and_listed(tmp_path: Path) -> None:
    """Frames that either camera missed: the others go together by their numbers."""
    for side, numbers in (("left", (1, 2, 3, 5)), ("right", (2, 4, 5))):
        for number in numbers:
            save_grey(tmp_path / side / f"{side}_{number}.png", 10 * number + (side == "right"))
    made = import_recording([tmp_path / "left", tmp_path / "right"], tmp_path / "a.mcap")
    levels = [(each.left[0, 1], each.right[0, 1]) for each in frames_of(tmp_path / "a.mcap")]
    assert levels == [(20, 21), (50, 51)]
    assert [each.name for each in made.skipped] == ["left/left_1.png", "left/left_3.png", "right/right_4.png"]
    assert {each.reason for each in made.skipped} == {"has no picture of the other camera"}


def test_two_folders_in_natural_order(tmp_path: Path) -> None:
    """Image 2 comes before image 10, other files are no images, and grey has no colour."""
    for k in (1, 2, 10):
        save_grey(tmp_path / "left" / f"im{k}.png", k)
        save_grey(tmp_path / "right" / f"im{k}.bmp", 100 + k)
    (tmp_path / "left" / "im1.txt").write_text("a label")
    geometry = StereoGeometry(386, 30, 60, 20)
    summary = import_recording(
        [tmp_path / "left", tmp_path / "right"],
        tmp_path / "a.mcap",
        fps=25,
        geometry=geometry,
        description="x",
    )
    assert (summary.width, summary.height, summary.frame_count, summary.fps) == (8, 4, 3, 25)
    frames = frames_of(tmp_path / "a.mcap")
    assert [frame.left[0].tolist() for frame in frames] == [[128, k] * 8 for k in (1, 2, 10)]
    assert [frame.right[3, 1] for frame in frames] == [101, 102, 110]
    assert [(frame.left_ns, frame.right_ns) for frame in frames] == [(k * 40_000_000,) * 2 for k in range(3)]
    with RecordingReader(tmp_path / "a.mcap") as reader:
        assert (reader.geometry, reader.description) == (geometry, "x")


def test_pattern_and_single_files(tmp_path: Path) -> None:
    """Left and right images may share a folder, picked by pattern or one by one."""
    for k in range(2):
        save_grey(tmp_path / "both" / f"l{k}.png", k)
        save_grey(tmp_path / "both" / f"r{k}.png", 10 + k)
    import_recording([tmp_path / "both" / "l*.png", tmp_path / "both" / "r*.png"], tmp_path / "a.mcap")
    assert [(frame.left[0, 1], frame.right[0, 1]) for frame in frames_of(tmp_path / "a.mcap")] == [
        (0, 10),
        (1, 11),
    ]
    import_recording([tmp_path / "both" / "l1.png", tmp_path / "both" / "r0.png"], tmp_path / "b.mcap")
    assert [(frame.left[0, 1], frame.right[0, 1]) for frame in frames_of(tmp_path / "b.mcap")] == [(1, 10)]


@pytest.mark.parametrize("colour", PRIMARIES)
def test_colours(tmp_path: Path, colour: str) -> None:
    """Colours become full-range BT.601 in the byte order U Y V Y."""
    Image.new("RGB", (4, 2), PRIMARIES[colour]).save(tmp_path / "a.png")
    import_recording([tmp_path / "a.png"], tmp_path / "a.mcap", mono=True)
    u, y, v = PRIMARIES_UYV[colour]
    (frame,) = frames_of(tmp_path / "a.mcap")
    np.testing.assert_array_equal(frame.left, np.tile(np.array([u, y, v, y], np.uint8), (2, 2)))
    np.testing.assert_array_equal(frame.left, frame.right)


def test_colour_is_the_mean_of_a_pair(tmp_path: Path) -> None:
    """Two neighbouring pixels share the mean of their colours and keep their own brightness."""
    pixels = np.array([[PRIMARIES["red"], PRIMARIES["blue"]]], np.uint8)
    Image.fromarray(pixels).save(tmp_path / "a.png")
    import_recording([tmp_path / "a.png"], tmp_path / "a.mcap", mono=True)
    assert frames_of(tmp_path / "a.mcap")[0].left.tolist() == [[(85 + 255) // 2, 76, (255 + 107) // 2, 29]]


def test_side_by_side(tmp_path: Path) -> None:
    """The left half of each picture is the left camera's."""
    halves = np.hstack([np.full((4, 8), 10, np.uint8), np.full((4, 8), 200, np.uint8)])
    save_grey(tmp_path / "im" / "0.png", 0)
    Image.fromarray(halves).save(tmp_path / "im" / "0.png")
    summary = import_recording([tmp_path / "im"], tmp_path / "a.mcap", side_by_side=True)
    assert (summary.width, summary.height) == (8, 4)
    (frame,) = frames_of(tmp_path / "a.mcap")
    assert set(frame.left[:, 1::2].flat) == {10}
    assert set(frame.right[:, 1::2].flat) == {200}


def test_raw_uyvy_keeps_every_byte(tmp_path: Path) -> None:
    """Raw UYVY goes into the recording as it is."""
    pixels = noise((2, 3, 6, 16))
    for side, name in enumerate(("l.uyvy", "r.uyvy")):
        (tmp_path / name).write_bytes(pixels[side].tobytes())
    import_recording([tmp_path / "l.uyvy", tmp_path / "r.uyvy"], tmp_path / "a.mcap", size=(8, 6))
    for k, frame in enumerate(frames_of(tmp_path / "a.mcap")):
        np.testing.assert_array_equal(frame.left, pixels[0, k])
        np.testing.assert_array_equal(frame.right, pixels[1, k])


@pytest.mark.parametrize("suffix", ["yuyv", "yuy2"])
def test_raw_yuyv_is_uyvy_with_its_bytes_the_other_way_round(tmp_path: Path, suffix: str) -> None:
    """As cameras on USB send it: Y before U and V."""
    pixels = noise((3, 6, 8, 2))
    (tmp_path / f"a.{suffix}").write_bytes(pixels[..., ::-1].tobytes())
    import_recording([tmp_path / f"a.{suffix}"], tmp_path / "a.mcap", size=(8, 6), mono=True)
    for k, frame in enumerate(frames_of(tmp_path / "a.mcap")):
        np.testing.assert_array_equal(frame.left, pixels[k].reshape(6, 16))


def test_raw_i420(tmp_path: Path) -> None:
    """I420 keeps its brightness; a row of colour serves two rows of pixels."""
    y, u, v = noise((4, 8)), noise((2, 4), 1), noise((2, 4), 2)
    (tmp_path / "a.yuv").write_bytes(y.tobytes() + u.tobytes() + v.tobytes())
    import_recording([tmp_path / "a.yuv"], tmp_path / "a.mcap", mono=True, size=(8, 4))
    (frame,) = frames_of(tmp_path / "a.mcap")
    np.testing.assert_array_equal(frame.left[:, 1::2], y)
    np.testing.assert_array_equal(frame.left[:, 0::4], u.repeat(2, axis=0))
    np.testing.assert_array_equal(frame.left[:, 2::4], v.repeat(2, axis=0))


def test_raw_nv12_is_i420_with_u_and_v_by_turns(tmp_path: Path) -> None:
    """As encoders and boards have it."""
    y, u, v = noise((4, 8)), noise((2, 4), 1), noise((2, 4), 2)
    (tmp_path / "a.nv12").write_bytes(2 * (y.tobytes() + np.stack([u, v], axis=-1).tobytes()))
    import_recording([tmp_path / "a.nv12"], tmp_path / "a.mcap", mono=True, size=(8, 4))
    frames = frames_of(tmp_path / "a.mcap")
    assert len(frames) == 2
    np.testing.assert_array_equal(frames[1].left[:, 1::2], y)
    np.testing.assert_array_equal(frames[1].left[:, 0::4], u.repeat(2, axis=0))
    np.testing.assert_array_equal(frames[1].left[:, 2::4], v.repeat(2, axis=0))


def test_raw_grey_has_no_colour(tmp_path: Path) -> None:
    """A byte a pixel, kept as it is."""
    y = noise((2, 3, 8))
    (tmp_path / "a.y8").write_bytes(y.tobytes())
    import_recording([tmp_path / "a.y8"], tmp_path / "a.mcap", mono=True, size=(8, 3))
    for frame, luma in zip(frames_of(tmp_path / "a.mcap"), y, strict=True):
        np.testing.assert_array_equal(frame.left[:, 1::2], luma)
        assert set(frame.left[:, 0::2].flat) == {128}


@pytest.mark.parametrize("bits", [8, 10, 12, 16])
@pytest.mark.parametrize("name", ["a.png", "a.tiff", "a.pgm", "a.grey"])
def test_of_pixels_of_16_bits_the_upper_8_that_the_camera_uses_are_taken(
    tmp_path: Path, name: str, bits: int
) -> None:
    """Of 12 bits in 16, 4,095 is white; taken as 16 bits, it is nearly black."""
    y = np.linspace(0, (1 << bits) - 1, 8 * 256).astype(np.uint16).reshape(8, 256)
    if name == "a.grey":
        (tmp_path / name).write_bytes(y.astype("<u2").tobytes())
    elif name == "a.pgm":
        (tmp_path / name).write_bytes(b"P5 256 8 65535\n" + y.astype(">u2").tobytes())
    else:
        Image.fromarray(y).save(tmp_path / name)
    size = {"size": (256, 8)} if name == "a.grey" else {}
    import_recording([tmp_path / name], tmp_path / "a.mcap", mono=True, bits=bits, **size)
    (frame,) = frames_of(tmp_path / "a.mcap")
    np.testing.assert_array_equal(frame.left[:, 1::2], y >> (bits - 8))
    assert set(frame.left[:, 0::2].flat) == {128}


def test_of_a_sensors_pixels_of_16_bits_the_upper_8_have_the_same_colours(tmp_path: Path) -> None:
    """A pattern of 12 bits is that of its upper 8."""
    pytest.importorskip("cv2")
    seen = noise((6, 8))
    (tmp_path / "deep.raw").write_bytes((seen.astype("<u2") << 4 | 5).astype("<u2").tobytes())
    (tmp_path / "plain.raw").write_bytes(seen.tobytes())
    for name, more in (("deep", {"bits": 12}), ("plain", {})):
        import_recording(
            [tmp_path / f"{name}.raw"],
            tmp_path / f"{name}.mcap",
            mono=True,
            size=(8, 6),
            format="bayer_rggb8",
            **more,
        )
    deep, plain = (frames_of(tmp_path / f"{name}.mcap")[0].left for name in ("deep", "plain"))
    np.testing.assert_array_equal(deep, plain)


def test_of_colours_of_16_bits_the_upper_8_are_taken(tmp_path: Path) -> None:
    """Which is all that Pillow keeps of them: a camera that uses 12 would be nearly black."""
    cv2 = pytest.importorskip("cv2")
    cv2.imwrite(str(tmp_path / "a.png"), np.full((4, 8, 3), 0xC8FF, np.uint16))
    for bits in (None, 16):
        import_recording([tmp_path / "a.png"], tmp_path / "a.mcap", mono=True, bits=bits, force=True)
        assert set(frames_of(tmp_path / "a.mcap")[0].left[:, 1::2].flat) == {0xC8}
    with pytest.raises(RecordingError, match="grey pixels of 16 bits for `--bits 12`, not colours$"):
        import_recording([tmp_path / "a.png"], tmp_path / "b.mcap", mono=True, bits=12)


@pytest.mark.parametrize("pattern", ["rggb", "bggr", "gbrg", "grbg"])
def test_raw_frames_of_a_sensor_have_the_colours_of_their_filters(tmp_path: Path, pattern: str) -> None:
    """Light of one colour, of which only the pixels behind its filter see anything."""
    pytest.importorskip("cv2")
    for colour in ("red", "green", "blue"):
        seen = np.array([255 * (each == colour[0]) for each in pattern], np.uint8).reshape(2, 2)
        (tmp_path / "a.raw").write_bytes(np.tile(seen, (3, 4)).tobytes())
        import_recording(
            [tmp_path / "a.raw"],
            tmp_path / "a.mcap",
            mono=True,
            size=(8, 6),
            format=f"bayer_{pattern}8",
            force=True,
        )
        (frame,) = frames_of(tmp_path / "a.mcap")
        u, y, v = PRIMARIES_UYV[colour]
        assert set(frame.left[2:4].reshape(-1, 4)[1:3].flat) == {u, y, v}


@pytest.mark.parametrize(
    ("colourspace", "chroma_shape", "expected"),
    [
        ("C420jpeg", (2, 4), lambda u: u.repeat(2, axis=0)[:3]),
        ("C422", (3, 4), lambda u: u),
        ("C444", (3, 8), lambda u: ((u[:, 0::2].astype(int) + u[:, 1::2] + 1) // 2).astype(np.uint8)),
        ("Cmono", (0, 0), lambda u: np.full((3, 4), 128, np.uint8)),
    ],
)
def test_y4m(
    tmp_path: Path, colourspace: str, chroma_shape: tuple[int, int], expected: Callable[..., Any]
) -> None:
    """Each colour layout, an odd number of rows, parameters on FRAME, and the frame rate of the header."""
    y, u, v = noise((3, 8)), noise(chroma_shape, 1), noise(chroma_shape, 2)
    frame_bytes = y.tobytes() + u.tobytes() + v.tobytes()
    header = f"YUV4MPEG2 W8 H3 F30000:1001 Ip A1:1 {colourspace} XYSCSS=X\n".encode()
    (tmp_path / "a.y4m").write_bytes(header + b"FRAME\n" + frame_bytes + b"FRAME Ip\n" + frame_bytes)
    summary = import_recording([tmp_path / "a.y4m"], tmp_path / "a.mcap", mono=True)
    assert (summary.frame_count, summary.fps) == (2, Fraction(30000, 1001))
    frames = frames_of(tmp_path / "a.mcap")
    np.testing.assert_array_equal(frames[1].left[:, 1::2], y)
    np.testing.assert_array_equal(frames[1].left[:, 0::4], expected(u))
    np.testing.assert_array_equal(frames[1].left[:, 2::4], expected(v))
    assert frames[1].left_ns == 33_366_667


def test_y4m_of_limited_range_is_stretched(tmp_path: Path) -> None:
    """Black 16 and white 235 become 0 and 255 when the header says that they are black and white."""
    pixels = bytes([16, 235, 126, 0]) + bytes([128, 240]) * 2
    (tmp_path / "a.y4m").write_bytes(b"YUV4MPEG2 W4 H1 F25:1 C422 XCOLORRANGE=LIMITED\nFRAME\n" + pixels)
    import_recording([tmp_path / "a.y4m"], tmp_path / "a.mcap", mono=True)
    assert frames_of(tmp_path / "a.mcap")[0].left.tolist() == [[128, 0, 128, 255, 255, 128, 255, 0]]


def test_resize_keeps_shapes(tmp_path: Path) -> None:
    """A tall image is cut to the camera's aspect ratio about its centre, then scaled; odd widths are fine."""
    tall = np.zeros((30, 15), np.uint8)
    tall[10:20] = 200
    Image.fromarray(tall).save(tmp_path / "a.png")
    summary = import_recording([tmp_path / "a.png"], tmp_path / "a.mcap", mono=True, resize=(6, 4))
    assert (summary.width, summary.height) == (6, 4)
    luma = frames_of(tmp_path / "a.mcap")[0].left[:, 1::2]
    assert luma.min() > 150


def test_rectification_tables_from_npy(tmp_path: Path) -> None:
    """Tables come from .npy files of any integer type, and reach the recording."""
    table = np.stack([np.indices((4, 8))[0][::-1], np.indices((4, 8))[1]])
    np.save(tmp_path / "l.npy", table)
    np.save(tmp_path / "r.npy", table.astype(np.uint16))
    tables = load_rectification(tmp_path / "l.npy", tmp_path / "r.npy")
    save_grey(tmp_path / "a.png", 1)
    import_recording([tmp_path / "a.png"], tmp_path / "a.mcap", mono=True, rectification=tables)
    with RecordingReader(tmp_path / "a.mcap") as reader:
        assert isinstance(reader.rectification, RectificationTables)
        np.testing.assert_array_equal(reader.rectification.left, table)
        np.testing.assert_array_equal(reader.rectification.right, table)


def test_rectification_tables_of_other_kinds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A missing file, a table of floats, a flat one and one of 64-bit rows beyond the picture are refused."""
    np.save(tmp_path / "float.npy", np.zeros((2, 4, 8)))
    np.save(tmp_path / "flat.npy", np.zeros(32, int))
    np.save(tmp_path / "far.npy", np.full((2, 4, 8), 1 << 32))
    with pytest.raises(RecordingError, match=r"none\.npy: .* must be a readable file"):
        load_rectification(tmp_path / "none.npy", tmp_path / "none.npy")
    for name, found in (("float", r"float64 of shape \(2, 4, 8\)"), ("flat", r"int64 of shape \(32,\)")):
        with pytest.raises(
            RecordingError, match=rf"{name}\.npy: .* must hold integers of shape .*, not {found}"
        ):
            load_rectification(tmp_path / f"{name}.npy", tmp_path / f"{name}.npy")
    monkeypatch.setattr("bfsim.recording.importer.LARGEST_TABLE_MB", 0)  # a device never ends
    with pytest.raises(RecordingError, match=r"far\.npy: .* must be a readable file: it has more than 0 MB"):
        load_rectification(tmp_path / "far.npy", tmp_path / "far.npy")
    monkeypatch.undo()
    with pytest.raises(RecordingError, match="must point at rows 0 to 3 and columns 0 to 7"):
        load_rectification(tmp_path / "far.npy", tmp_path / "far.npy").check(8, 4)


def test_video_without_pyav(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the optional package the error says which command brings it."""
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(RecordingError, match=r'a\.mp4: .* pip install "bfsim\[video\]"'):
        import_recording([tmp_path / "a.mp4"], tmp_path / "a.mcap", mono=True)


def test_video(tmp_path: Path) -> None:
    """A video in limited range arrives in full range, with its frame rate."""
    av = pytest.importorskip("av", reason="needs the optional extra: video")
    with av.open(tmp_path / "a.mkv", "w") as container:
        stream = container.add_stream("ffv1", rate=12)
        stream.width, stream.height, stream.pix_fmt = 32, 16, "yuv420p"
        for level in (16, 235):
            planes = np.vstack([np.full((16, 32), level, np.uint8), np.full((8, 32), 128, np.uint8)])
            container.mux(stream.encode(av.VideoFrame.from_ndarray(planes, format="yuv420p")))
        container.mux(stream.encode())
    summary = import_recording([tmp_path / "a.mkv"], tmp_path / "a.mcap", mono=True)
    assert (summary.frame_count, summary.fps) == (2, 12)
    frames = frames_of(tmp_path / "a.mcap")
    assert [set(frame.left[:, 1::2].flat) for frame in frames] == [{0}, {255}]
    assert set(frames[0].left[:, 0::4].flat) == {128}


def video(path: Path, times_ms: Sequence[int]) -> None:
    """Write grey pictures with these times."""
    av = pytest.importorskip("av", reason="needs the optional extra: video")
    with av.open(path, "w") as container:
        stream = container.add_stream("ffv1", rate=30)
        stream.width, stream.height, stream.pix_fmt = 32, 16, "yuv420p"
        stream.codec_context.time_base = Fraction(1, 1000)
        for time_ms in times_ms:
            frame = av.VideoFrame.from_ndarray(np.full((24, 32), 99, np.uint8), format="yuv420p")
            frame.pts, frame.time_base = time_ms, Fraction(1, 1000)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())


def test_uneven_videos_of_two_cameras_must_have_been_taken_at_once(tmp_path: Path) -> None:
    """Where they were, each has its own times; where one has lost a picture, those of a number are no pair."""
    left, right, late = (tmp_path / f"{name}.mkv" for name in ("left", "right", "late"))
    video(left, [0, 33, 233, 266])
    video(right, [0, 34, 236, 270])
    video(late, [0, 233, 266, 299])
    import_recording([left, right], tmp_path / "a.mcap")
    assert [each.right_ns // 10**6 for each in frames_of(tmp_path / "a.mcap")] == [0, 34, 236, 270]
    with pytest.raises(
        RecordingError, match=r"left\.mkv and .*late\.mkv: pictures 1 must be taken at once, not 200 ms"
    ):
        import_recording([left, late], tmp_path / "b.mcap")
    assert import_recording([left, late], tmp_path / "b.mcap", fps=30).frame_count == 4


@pytest.mark.parametrize(
    ("times_ms", "recorded_ms", "note"),
    [
        ([0, 33, 67, 100], [0, 33 + 1 / 3, 66 + 2 / 3, 100], ""),
        (
            [7, 40, 240, 273],
            [0, 33, 233, 266],
            "pictures are 33 to 200 ms apart, as there; `--fps` spaces them",
        ),
        ([0, 67, 133, 200], [0, 67, 133, 200], "pictures are 66 to 67 ms apart, as there"),
    ],
)
def test_pictures_of_a_video_come_when_they_came(
    tmp_path: Path, times_ms: list[int], recorded_ms: list[float], note: str
) -> None:
    """Phones take a picture when there is light enough: of a rate that the video does not keep it was recorded, without a word."""
    video(tmp_path / "a.mkv", times_ms)
    notes = import_recording([tmp_path / "a.mkv"], tmp_path / "a.mcap", mono=True).notes
    assert [note in each for each in notes] == ([True] if note else [])
    assert [each.left_ns / 1e6 for each in frames_of(tmp_path / "a.mcap")] == pytest.approx(recorded_ms)
    even = import_recording([tmp_path / "a.mkv"], tmp_path / "even.mcap", mono=True, fps=10)
    assert (even.fps, even.notes) == (10, ())
    assert [each.left_ns / 1e6 for each in frames_of(tmp_path / "even.mcap")] == [0, 100, 200, 300]


def animation(path: Path, format: str) -> None:
    """Write three pictures that differ."""
    pictures = [Image.fromarray(each) for each in noise((3, 4, 8, 3))]
    pictures[0].save(path, format, save_all=True, append_images=pictures[1:], duration=100)


@pytest.mark.parametrize("name", ["a.gif", "a.apng"])
def test_all_pictures_of_an_animation_are_a_video(tmp_path: Path, name: str) -> None:
    """A GIF was refused by its name, and of a PNG with three pictures one came."""
    pytest.importorskip("av", reason="needs the optional extra: video")
    animation(tmp_path / name, "GIF" if name == "a.gif" else "PNG")
    summary = import_recording([tmp_path / name], tmp_path / "a.mcap", mono=True)
    assert (summary.frame_count, summary.fps) == (3, 10)


def test_gifs_in_a_folder_are_pictures(tmp_path: Path) -> None:
    """They were passed over by their name; an animation among them is none, as any file of several pictures."""
    for side in ("left", "right"):
        (tmp_path / side).mkdir()
        for number, level in enumerate((10, 200)):
            Image.new("L", (8, 4), level).save(tmp_path / side / f"{number}.gif")
        animation(tmp_path / side / "9.gif", "GIF")
    summary = import_recording([tmp_path / "left", tmp_path / "right"], tmp_path / "a.mcap")
    assert [frame.left[0, 1] for frame in frames_of(tmp_path / "a.mcap")] == [10, 200]
    assert {each.name for each in summary.skipped} == {"9.gif"}
    assert summary.skipped[0].reason.startswith("image must be one picture, not 3")


@pytest.mark.parametrize(("name", "format"), [("a.png", "PNG"), ("a.webp", "WEBP"), ("a.tiff", "TIFF")])
def test_a_picture_of_several_is_refused(tmp_path: Path, name: str, format: str) -> None:
    """The first one came, and the others were lost without a word."""
    animation(tmp_path / name, format)
    with pytest.raises(
        RecordingError, match=r"a\.\w+: image must be one picture, not 3; `--format video` reads"
    ):
        import_recording([tmp_path / name], tmp_path / "a.mcap", mono=True)


def test_a_picture_that_a_decoder_stumbles_over_is_skipped(tmp_path: Path) -> None:
    """Pillow raises a TypeError of a TIFF with a number of another type, which ended the import."""
    for name in ("bad.tif", "whole.tif"):
        save_grey(tmp_path / "im" / name, 7)
    damaged = bytearray((tmp_path / "im" / "bad.tif").read_bytes())
    damaged[72] = 2
    (tmp_path / "im" / "bad.tif").write_bytes(damaged)
    summary = import_recording([tmp_path / "im"], tmp_path / "a.mcap", mono=True)
    assert summary.frame_count == 1
    assert [each.name for each in summary.skipped] == ["bad.tif"]
    assert summary.skipped[0].reason.startswith("image must be whole, but Pillow stops in it (TypeError: ")


def test_a_jpeg_with_a_copy_behind_it_is_one_picture(tmp_path: Path) -> None:
    """Phones put a smaller copy behind the picture."""
    animation(tmp_path / "a.jpg", "MPO")
    assert import_recording([tmp_path / "a.jpg"], tmp_path / "a.mcap", mono=True).frame_count == 1


@pytest.mark.parametrize(("degrees", "corner"), [(90, (15, 0)), (180, (7, 15)), (-90, (0, 7))])
def test_video_of_a_turned_camera_is_upright(tmp_path: Path, degrees: int, corner: tuple[int, int]) -> None:
    """A phone stores its pictures as its sensor lies; the bright upper left corner goes where the video says."""
    av = pytest.importorskip("av", reason="needs the optional extra: video")
    picture = np.zeros((8, 16, 3), np.uint8)
    picture[0, :2] = 255
    with av.open(tmp_path / "a.mp4", "w") as container:
        stream = container.add_stream("mpeg4", rate=25)
        stream.width, stream.height, stream.pix_fmt = 16, 8, "yuv420p"
        stream.set_display_rotation(degrees)
        container.mux(stream.encode(av.VideoFrame.from_ndarray(picture)))
        container.mux(stream.encode())
    import_recording([tmp_path / "a.mp4"], tmp_path / "a.mcap", mono=True)
    luma = frames_of(tmp_path / "a.mcap")[0].left[:, 1::2]
    assert luma.shape == ((8, 16) if degrees == 180 else (16, 8))
    assert luma[corner] == luma.max() > 200


def test_a_file_with_sound_alone_is_no_video(tmp_path: Path) -> None:
    """The error says what is in it."""
    av = pytest.importorskip("av", reason="needs the optional extra: video")
    with av.open(tmp_path / "a.mkv", "w") as container:
        stream = container.add_stream("pcm_s16le", rate=8000)
        sound = av.AudioFrame.from_ndarray(np.zeros((1, 64), np.int16), layout="mono")
        sound.sample_rate = 8000
        container.mux(stream.encode(sound))
    with pytest.raises(
        RecordingError, match=r"a\.mkv: file must be whole and have a video stream, not audio"
    ):
        import_recording([tmp_path / "a.mkv"], tmp_path / "a.mcap", mono=True)


def test_existing_recording_needs_force(tmp_path: Path) -> None:
    """A recording is not overwritten by accident."""
    save_grey(tmp_path / "a.png", 7)
    (tmp_path / "a.mcap").write_bytes(b"precious")
    with pytest.raises(RecordingError, match=r"a\.mcap: recording must not exist yet; `--force`"):
        import_recording([tmp_path / "a.png"], tmp_path / "a.mcap", mono=True)
    assert (tmp_path / "a.mcap").read_bytes() == b"precious"
    import_recording([tmp_path / "a.png"], tmp_path / "a.mcap", mono=True, force=True)
    assert frames_of(tmp_path / "a.mcap")[0].left[0, 1] == 7


@pytest.mark.parametrize("name", ["left.png", "left.y4m", "pictures"])
def test_forgotten_output_costs_no_picture(tmp_path: Path, name: str) -> None:
    """The first source stands where the recording should: it stays, even with `force`."""
    (tmp_path / "pictures").mkdir()
    output = tmp_path / name
    with pytest.raises(RecordingError, match=f"{name}: recording must have a name like run.mcap"):
        import_recording([output], output, mono=True, force=True)


def test_progress(tmp_path: Path) -> None:
    """The caller hears of every frame."""
    for k in range(3):
        save_grey(tmp_path / "im" / f"{k}.png", k)
    heard: list[tuple[int, int | None]] = []
    import_recording(
        [tmp_path / "im"], tmp_path / "a.mcap", mono=True, progress=lambda *now: heard.append(now)
    )
    assert heard == [(1, 3), (2, 3), (3, 3)]


def test_mixed_sizes_and_stray_files(tmp_path: Path) -> None:
    """Upright and lying pictures come to one size; what is no picture is listed, and takes no frame."""
    (tmp_path / "im").mkdir()
    save_grey(tmp_path / "im" / "0.png", 10, (30, 40))
    save_grey(tmp_path / "im" / "1.png", 20, (64, 48))
    save_grey(tmp_path / "im" / "3.png", 30, (7, 5))
    (tmp_path / "im" / "2.png").write_text("no image")
    (tmp_path / "im" / "notes.txt").write_text("a label")
    for fit, levels in (({"resize": (8, 6)}, [10, 20, 30]), ({"crop": (8, 6)}, [10, 20])):
        summary = import_recording([tmp_path / "im"], tmp_path / "a.mcap", mono=True, force=True, **fit)
        frames = frames_of(tmp_path / "a.mcap")
        assert [set(frame.left[:, 1::2].flat) for frame in frames] == [{level} for level in levels]
        assert [frame.left_ns for frame in frames] == [round(k * 1e9 / 30) for k in range(len(levels))]
        assert [each.name for each in summary.skipped][:2] == ["notes.txt", "2.png"]
    assert summary.skipped[2].reason.startswith("7x5 is too small for `--crop` 8x6")
    assert summary.source_sizes == ((30, 40), (64, 48))


def test_one_bad_picture_takes_its_pair_along(tmp_path: Path) -> None:
    """What follows stays with its own partner."""
    for k in range(3):
        save_grey(tmp_path / "left" / f"{k}.png", k)
        save_grey(tmp_path / "right" / f"{k}.png", 100 + k)
    (tmp_path / "left" / "0.png").write_bytes(b"")
    summary = import_recording([tmp_path / "left", tmp_path / "right"], tmp_path / "a.mcap")
    frames = frames_of(tmp_path / "a.mcap")
    assert [(frame.left[0, 1], frame.right[0, 1]) for frame in frames] == [(1, 101), (2, 102)]
    assert [each.name for each in summary.skipped] == ["0.png"]


def test_a_link_that_leads_nowhere_is_a_picture_that_cannot_be_read(tmp_path: Path) -> None:
    """Data sets kept by git-annex have those where a picture was not fetched."""
    save_grey(tmp_path / "left" / "0.png", 1)
    (tmp_path / "left" / "1.png").symlink_to("nowhere.png")
    (tmp_path / "left" / "2.png").symlink_to(tmp_path / "left" / "2.png")
    summary = import_recording([tmp_path / "left"], tmp_path / "a.mcap", mono=True)
    assert summary.frame_count == 1
    assert [each.name for each in summary.skipped] == ["1.png", "2.png"]
    assert "No such file" in summary.skipped[0].reason


def test_a_pattern_in_a_folder_with_brackets(tmp_path: Path) -> None:
    """Brackets of a folder that is there are its name; those of the rest are a pattern."""
    for k in (1, 2, 3):
        save_grey(tmp_path / "run [1]" / f"left_{k}.png", k)
    import_recording([str(tmp_path / "run [1]" / "left_[12].png")], tmp_path / "a.mcap", mono=True)
    assert [frame.left[0, 1] for frame in frames_of(tmp_path / "a.mcap")] == [1, 2]


@pytest.mark.parametrize("layout", ["444", "422", "420"])
def test_crop_keeps_the_middle(layout: str) -> None:
    """Brightness and colour are cut alike, on whole colour samples."""
    y, u = noise((9, 12)), noise({"444": (9, 12), "422": (9, 6), "420": (5, 6)}[layout], 1)
    found = YuvPlanes(y, u, u).cropped(6, 4)
    np.testing.assert_array_equal(found.y, y[2:6, 2:8])
    across, down = (12 // u.shape[1], -(-9 // u.shape[0]))
    np.testing.assert_array_equal(found.v, u[2 // down : 6 // down, 2 // across : 8 // across])


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with a little of everything that can be wrong."""
    monkeypatch.chdir(tmp_path)
    for k in range(3):
        save_grey(Path("three") / f"{k}.png", k)
    for k in range(2):
        save_grey(Path("two") / f"{k}.png", k)
        save_grey(Path("stamped") / f"{1000 + k}.png", k)
        save_grey(Path("large") / f"{k}.png", k, (10, 4))
        save_grey(Path("odd") / f"{k}.png", k, (7, 4))
        save_grey(Path("mixed") / f"{k}.png", k, (8, 4 + k))
    Path("sequence").mkdir()
    save_grey(Path("sequence/data/0.png"), 0)
    Path("sides").mkdir()
    for side in ("left", "right"):
        save_grey(Path("sides") / side / "0.png", 0)
        save_grey(Path("both") / f"img{side.capitalize()}0.png", 0)
    Path("empty").mkdir()
    Path("texts").mkdir()
    Path("texts/a.txt").touch()
    Path("texts/cam0").mkdir()
    Image.fromarray(noise((32, 32))).save("whole.png")
    Path("bad.png").write_bytes(Path("whole.png").read_bytes()[:500])
    Path("text.png").write_text("no image")
    Image.fromarray(np.full((4, 8), 4032, np.uint16)).save("deep.png")
    Image.fromarray(np.zeros((4, 8), np.float32)).save("floats.tiff")
    Path("short.uyvy").write_bytes(bytes(100))
    Path("none.uyvy").touch()
    Path("frames.raw").write_bytes(bytes(64))
    head = b"YUV4MPEG2 W8 H4 F25:1 C420\n"
    one = b"FRAME\n" + bytes(48)
    Path("one.y4m").write_bytes(head + one)
    Path("two.y4m").write_bytes(head + 2 * one)
    Path("cut.y4m").write_bytes(head + one + one[:20])
    Path("frameless.y4m").write_bytes(head)
    Path("framing.y4m").write_bytes(head + one + b"X" + one)
    Path("ten_bit.y4m").write_bytes(head.replace(b"C420", b"C420p10") + one)
    Path("sizeless.y4m").write_bytes(head.replace(b"W8", b"W0") + one)
    Path("rate.y4m").write_bytes(head.replace(b"F25:1", b"Fast") + one)
    Path("fast.y4m").write_bytes(head.replace(b"F25:1", b"F50:1") + one)
    Path("other.y4m").write_bytes(b"RIFF" + bytes(2000))


@pytest.mark.usefixtures("sources")
@pytest.mark.parametrize(
    ("names", "options", "message"),
    [
        (
            ["three", "stamped"],
            {},
            r"three and stamped: images must have names that tell the pairs.* not 3 and 2",
        ),
        (["two", "large"], {}, r"one size, not 8x4 \(two\) and 10x4 \(large\)"),
        (["one.y4m", "two.y4m"], {}, r"but one\.y4m ends after 1 and two\.y4m has more"),
        (["two.y4m", "one.y4m"], {}, r"but one\.y4m ends after 1 and two\.y4m has more"),
        (["one.y4m", "fast.y4m"], {}, "one frame rate, not 25 and 50; `--fps` sets it"),
        (["odd"], {"mono": True}, "odd: image width must be even .* not 7; `--resize`"),
        (
            ["large"],
            {"side_by_side": True},
            "large: side-by-side image must have a width of 4 x n pixels, not 10",
        ),
        (
            ["mixed"],
            {"mono": True},
            r"mixed/1\.png: image must be 8x4 like 0\.png, .* not 8x5; `--resize` or",
        ),
        (["mixed"], {"mono": True, "crop": (20, 4)}, "mixed: picture 1: 8x5 is too small for `--crop` 20x4"),
        (["two"], {"mono": True, "crop": (6, 4), "resize": (8, 4)}, "`--resize` or `--crop`, not both"),
        (["empty"], {"mono": True}, r"empty: source must hold images \(\.bmp, .*none of its 0 files"),
        (["texts"], {"mono": True}, r"none of its 2 files is one: a\.txt, cam0/$"),
        (["sequence"], {"mono": True}, r"none of its 1 files is one: data/; sequence/data holds some$"),
        (["both"], {}, r'sources must be 2, not 1: .* in quotes, such as "both/\*Left\*" "both/\*Right\*"$'),
        (["sides"], {}, r"in quotes, such as sides/left sides/right$"),
        (["three"], {}, r'in quotes, such as "left\*\.jpg"$'),
        (["two/*.jpg"], {"mono": True}, "none of its 0 files"),
        (["nowhere/left*"], {"mono": True}, r"nowhere/left\*: the folder nowhere must be there, but is not"),
        (["nowhere"], {"mono": True}, "nowhere: source .* is not there"),
        (["nowhere.png"], {"mono": True}, r"nowhere\.png: source must be .* is not there"),
        (["nowhere.uyvy"], {"mono": True, "size": (8, 4)}, "must be a readable file: No such file"),
        (["bad.png"], {"mono": True}, r"bad\.png: image must be readable: "),
        (["text.png"], {"mono": True}, r"text\.png: file must be an image that Pillow reads"),
        (
            ["deep.png"],
            {"mono": True},
            r"deep\.png: pixels must have 8 bits, or 16 of which .* --bits` .*: the brightest one here, 4,032, has 12$",
        ),
        (["deep.png"], {"mono": True, "bits": 11}, "fit into the bits of `--bits 11`, but one is 4,032"),
        (["deep.png"], {"mono": True, "bits": 7}, "`--bits` must be 8 to 16, not 7"),
        (["floats.tiff"], {"mono": True}, "pixels of 8 bits, or grey ones of 16, not the pixel format F"),
        (
            ["two/0.png"],
            {"mono": True, "bits": 12},
            "grey pixels of 16 bits for `--bits 12`, not pixels of 8",
        ),
        (["short.uyvy"], {"mono": True, "bits": 12}, "`--bits` must go with images, grey, bayer_rggb8"),
        (["short.uyvy"], {"mono": True}, r"short\.uyvy: raw UYVY needs the size .* `--size 320x240`"),
        (
            ["short.uyvy"],
            {"mono": True, "size": (8, 4)},
            "8x4 UYVY frames of 64 bytes, not 100 bytes = 1.56 frames",
        ),
        (["none.uyvy"], {"mono": True, "size": (8, 4)}, "not 0 bytes"),
        (["short.uyvy"], {"mono": True, "size": (7, 4)}, "width of UYVY frames must be even, not 7"),
        (["short.uyvy"], {"mono": True, "size": (8, 3), "format": "i420"}, "must be even, not 8x3"),
        (["frames.raw"], {"mono": True}, r"does not tell its format \(`--format` images, uyvy, i420"),
        (["cut.y4m"], {"mono": True}, r"frame 1 must have 48 bytes, not 14: .* starts at byte 87"),
        (["frameless.y4m"], {"mono": True}, "at least one whole frame"),
        (["framing.y4m"], {"mono": True}, r"frame 1 must start with FRAME, not 'XFRAME' \(before byte 88\)"),
        (["ten_bit.y4m"], {"mono": True}, "colourspace must be one of 420, .* not 420p10"),
        (["sizeless.y4m"], {"mono": True}, "must give a size .* not W0 H4"),
        (["rate.y4m"], {"mono": True}, "frame rate must be like F30:1, not Fast"),
        (["other.y4m"], {"mono": True}, r"header line must end within 1024 bytes \(frame 0, byte 0\)"),
        (["two"], {}, "sources must be 2, not 1: two"),
        (["two", "two", "two"], {}, 'sources must be 2, not 3: .*, or a pattern in quotes, such as "left'),
        (["two", "two"], {"mono": True}, "sources must be 1, not 2"),
        (["two"], {"mono": True, "side_by_side": True}, "not both"),
        (["two"], {"mono": True, "fps": 0}, "frame rate must be 0.000001 to .* not 0"),
        (["two"], {"mono": True, "fps": 1e-300}, "frame rate must be 0.000001 to .* not 1e-300"),
        (["two"], {"mono": True, "fps": float("nan")}, "frame rate must be 0.000001 to .* not nan"),
        (
            ["two"],
            {"mono": True, "size": (8, 4), "format": "images"},
            "two: `--size` must go with raw frames, .*; `--resize` ",
        ),
        (["cut.y4m"], {"mono": True, "size": (8, 4)}, r"cut.y4m: `--size` must go with raw frames"),
        (["two"], {"mono": True, "resize": (7, 4)}, "`--resize` must be above 0 and of even width, not 7x4"),
    ],
)
def test_bad_input(names: list[str], options: dict[str, Any], message: str) -> None:
    """Each mistake is named with its file and place, and no recording, not even half of one, is left."""
    before = sorted(Path().rglob("*"))
    with pytest.raises(RecordingError, match=message):
        import_recording(names, "out.mcap", **options)
    assert sorted(Path().rglob("*")) == before


def test_every_grey_level_is_kept(tmp_path: Path) -> None:
    """A grey image arrives bit for bit, level by level, without colour."""
    levels = np.arange(256, dtype=np.uint8).reshape(16, 16)
    Image.fromarray(levels).save(tmp_path / "a.png")
    import_recording([tmp_path / "a.png"], tmp_path / "a.mcap", mono=True)
    (frame,) = frames_of(tmp_path / "a.mcap")
    np.testing.assert_array_equal(frame.left[:, 1::2], levels)
    assert set(frame.left[:, 0::2].flat) == {128}
