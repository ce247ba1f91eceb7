"""Recordings made from y4m, videos and animations: their pixels, their times, and which way up they are."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bfsim.errors import RecordingError
from bfsim.recording.importing.importer import import_recording
from bfsim.recording.importing.sources import guess_format
from tests.recording.pictures import animation, frames_of, noise


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
            "pictures are 33 to 200 ms apart, as in the video; `--fps` spaces them",
        ),
        ([0, 67, 133, 200], [0, 67, 133, 200], "pictures are 66 to 67 ms apart, as in the video"),
        ([0, 40, 80, 120], [0, 40, 80, 120], "pictures are 40 ms apart, as in the video"),
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


def test_a_video_that_was_cut_off_is_told(tmp_path: Path) -> None:
    """FFmpeg takes it as one that is over: half of a copy was imported without a word."""
    video(tmp_path / "a.mkv", range(0, 4000, 100))
    whole = (tmp_path / "a.mkv").read_bytes()
    assert import_recording([tmp_path / "a.mkv"], tmp_path / "a.mcap", mono=True, fps=10).notes == ()
    (tmp_path / "b.mkv").write_bytes(whole[: len(whole) // 2])
    cut = import_recording([tmp_path / "b.mkv"], tmp_path / "b.mcap", mono=True, fps=10)
    assert 10 < cut.frame_count < 30
    assert f"b.mkv: the pictures end after {cut.frame_count / 10:.2f} of 3.93 s" in cut.notes[0]
    assert cut.notes[0].endswith(", as if the file were cut off there")


def test_a_video_may_have_a_title_in_any_encoding(tmp_path: Path) -> None:
    """Cameras and old programs write Latin-1: that ended in a traceback."""
    video(tmp_path / "a.mkv", [0, 33])
    octets = (tmp_path / "a.mkv").read_bytes()
    assert b"Lavf" in octets
    (tmp_path / "a.mkv").write_bytes(octets.replace(b"Lavf", b"L\xe4vf"))
    assert import_recording([tmp_path / "a.mkv"], tmp_path / "a.mcap", mono=True).frame_count == 2


@pytest.mark.parametrize("name", ["cam.h264", "cam.265", "CAM.HEVC", "cam.m2v", "phone.3gp", "handycam.MTS"])
def test_videos_of_cameras_are_told_by_their_names(name: str) -> None:
    """Those of a Raspberry Pi, which are codec alone, needed `--format video`."""
    assert guess_format(name) == "video"


@pytest.mark.parametrize("name", ["a.gif", "a.apng"])
def test_all_pictures_of_an_animation_are_a_video(tmp_path: Path, name: str) -> None:
    """A GIF was refused by its name, and of a PNG with three pictures one came."""
    pytest.importorskip("av", reason="needs the optional extra: video")
    animation(tmp_path / name, "GIF" if name == "a.gif" else "PNG")
    summary = import_recording([tmp_path / name], tmp_path / "a.mcap", mono=True)
    assert (summary.frame_count, summary.fps) == (3, 10)


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


def test_damaged_pictures_of_a_video_are_skipped_and_listed(tmp_path: Path) -> None:
    """The decoder makes up a part of them: a card that was pulled out too early, say. The others keep their place."""
    av = pytest.importorskip("av", reason="needs the optional extra: video")
    path = tmp_path / "a.avi"
    with av.open(path, "w") as container:
        stream = container.add_stream("mpeg4", rate=25, options={"g": "1"})
        stream.width, stream.height, stream.pix_fmt = 320, 240, "yuv420p"
        for seed in range(3):
            container.mux(
                stream.encode(av.VideoFrame.from_ndarray(noise((360, 320), seed), format="yuv420p"))
            )
        container.mux(stream.encode())
    with av.open(path) as container:
        packets = [(each.pos, each.size) for each in container.demux(video=0) if each.size]
    begin, nbytes = packets[1]
    content = bytearray(path.read_bytes())
    content[begin + nbytes // 2 : begin + nbytes // 2 + 2000] = bytes(2000)
    path.write_bytes(content)
    made = import_recording([path], tmp_path / "a.mcap", mono=True)
    assert made.frame_count == 2
    assert [(each.name, each.reason) for each in made.skipped] == [
        (f"{path} 1", "the video is damaged there")
    ]


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
