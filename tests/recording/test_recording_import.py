"""Recordings made from images and raw frames: the right bytes, or an error that says where."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from bfsim.errors import RecordingError
from bfsim.recording import (
    RecordingReader,
    RectificationTables,
)
from bfsim.recording.importing.importer import import_recording
from bfsim.recording.importing.rectification_files import load_rectification
from bfsim.recording.planes import YuvPlanes
from tests.recording.pictures import frames_of, noise, save_grey

PRIMARIES = {"red": (255, 0, 0), "green": (0, 255, 0), "blue": (0, 0, 255), "white": (255, 255, 255)}
# BT.601, full range, by the equations of JFIF 1.02: (U, Y, V).
PRIMARIES_UYV = {
    "red": (85, 76, 255),
    "green": (44, 150, 21),
    "blue": (255, 29, 107),
    "white": (128, 255, 128),
}


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


@pytest.mark.parametrize("bits", [None, 12])
@pytest.mark.parametrize("is_plain", [False, True])
def test_a_pgm_says_its_brightest_pixel_itself(tmp_path: Path, bits: int | None, *, is_plain: bool) -> None:
    """Pillow stretches its pixels to 16 bits: one of 12 bits was refused with `--bits 12`, for a number that is not in it."""
    y = np.linspace(0, 4095, 8 * 256).astype(np.uint16).reshape(8, 256)
    pixels = " ".join(map(str, y.ravel())).encode() if is_plain else y.astype(">u2").tobytes()
    (tmp_path / "a.pgm").write_bytes(b"%s\n256 8\n4095\n%s" % (b"P2" if is_plain else b"P5", pixels))
    import_recording([tmp_path / "a.pgm"], tmp_path / "a.mcap", mono=True, bits=bits)
    with RecordingReader(tmp_path / "a.mcap") as reader:
        (frame,) = reader.frames()
    np.testing.assert_array_equal(frame.left[:, 1::2], y >> 4)


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


@pytest.mark.parametrize(("brightest", "left"), [(4095, 15), (0x3FFF, 63), (0x4000, None)])
def test_colours_of_16_bits_that_are_dark_are_told_of(
    tmp_path: Path, brightest: int, left: int | None
) -> None:
    """Those of a camera that uses 12 of the bits were imported nearly black, without a word."""
    cv2 = pytest.importorskip("cv2")
    cv2.imwrite(str(tmp_path / "a.png"), np.full((4, 8, 3), brightest, np.uint16))
    Image.new("RGB", (8, 4), (9, 9, 9)).save(tmp_path / "night.png")  # 8 bits may be dark
    notes, none = (
        import_recording([tmp_path / each], tmp_path / "a.mcap", mono=True, force=True).notes
        for each in ("a.png", "night.png")
    )
    assert [f"reach only {left} of 255 in a.png" in each for each in notes] == ([True] if left else [])
    assert not none


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
    monkeypatch.setattr(
        "bfsim.recording.importing.rectification_files.LARGEST_TABLE_MB", 0
    )  # a device never ends
    with pytest.raises(RecordingError, match=r"far\.npy: .* must be a readable file: it has more than 0 MB"):
        load_rectification(tmp_path / "far.npy", tmp_path / "far.npy")
    monkeypatch.undo()
    with pytest.raises(RecordingError, match="must point at rows 0 to 3 and columns 0 to 7"):
        load_rectification(tmp_path / "far.npy", tmp_path / "far.npy").check(8, 4)


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


def test_force_overwrites_no_source(tmp_path: Path) -> None:
    """`record import --force eye.py left/` put a recording in the place of the firmware."""
    save_grey(tmp_path / "a.png", 7)
    for name in ("eye.py", "placed.ldf", "notes"):
        (tmp_path / name).write_bytes(b"precious")
        with pytest.raises(RecordingError, match=f"{name}: recording must not exist yet, or be called"):
            import_recording([tmp_path / "a.png"], tmp_path / name, mono=True, force=True)
        assert (tmp_path / name).read_bytes() == b"precious"


def test_progress(tmp_path: Path) -> None:
    """The caller hears of every frame."""
    for k in range(3):
        save_grey(tmp_path / "im" / f"{k}.png", k)
    heard: list[tuple[int, int | None]] = []
    import_recording(
        [tmp_path / "im"], tmp_path / "a.mcap", mono=True, progress=lambda *now: heard.append(now)
    )
    assert heard == [(1, 3), (2, 3), (3, 3)]


@pytest.mark.parametrize("layout", ["444", "422", "420"])
def test_crop_keeps_the_middle(layout: str) -> None:
    """Brightness and colour are cut alike, on whole colour samples."""
    y, u = noise((9, 12)), noise({"444": (9, 12), "422": (9, 6), "420": (5, 6)}[layout], 1)
    found = YuvPlanes(y, u, u).cropped(6, 4)
    np.testing.assert_array_equal(found.y, y[2:6, 2:8])
    across, down = (12 // u.shape[1], -(-9 // u.shape[0]))
    np.testing.assert_array_equal(found.v, u[2 // down : 6 // down, 2 // across : 8 // across])


def test_every_grey_level_is_kept(tmp_path: Path) -> None:
    """A grey image arrives bit for bit, level by level, without colour."""
    levels = np.arange(256, dtype=np.uint8).reshape(16, 16)
    Image.fromarray(levels).save(tmp_path / "a.png")
    import_recording([tmp_path / "a.png"], tmp_path / "a.mcap", mono=True)
    (frame,) = frames_of(tmp_path / "a.mcap")
    np.testing.assert_array_equal(frame.left[:, 1::2], levels)
    assert set(frame.left[:, 0::2].flat) == {128}
