"""Raw frames with two bytes a pixel: told where `--bits` was not said, never of one byte, and what is wrong with some of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from bfsim.errors import RecordingError
from bfsim.recording.importing.importer import import_recording
from bfsim.recording.importing.pixel_bytes import order_of_two_bytes
from tests.recording.pictures import noise

SIZE = WIDTH, HEIGHT = (64, 48)


def picture(bits: int) -> np.ndarray:
    """Return a picture whose pixels use so many bits, the lowest of them noise above 8: (48, 64)."""
    rng = np.random.default_rng(bits)
    rough = Image.fromarray(rng.integers(0, 256, (6, 8), np.uint8)).resize(SIZE, Image.Resampling.BILINEAR)
    more = bits - 8
    return (np.asarray(rough).astype(np.uint16) << more) + rng.integers(
        0, 1 << more, (HEIGHT, WIDTH), np.uint16
    )


def imported(
    tmp_path: Path, content: bytes, *, name: str = "a.grey", bits: int | None = None
) -> tuple[str, ...]:
    """Return what is said of an import of raw frames."""
    (tmp_path / name).write_bytes(content)
    given = {"format": "bayer_rggb8"} if name.endswith(".raw") else {}
    summary = import_recording(
        [tmp_path / name], tmp_path / "out.mcap", force=True, mono=True, size=SIZE, bits=bits, **given
    )
    return (*summary.notes, *(f"{each.name}: {each.reason}" for each in summary.skipped))


@pytest.mark.parametrize("name", ["a.grey", "a.raw"])
@pytest.mark.parametrize("bits", [10, 12, 16])
@pytest.mark.parametrize(
    ("order", "said"),
    [("<u2", "two bytes, the lower one first: say with `--bits`"), (">u2", "the upper one first: swap them")],
)
def test_two_bytes_are_told_by_their_order(
    tmp_path: Path, name: str, bits: int, order: str, said: str
) -> None:
    """Twice as many frames came of it, without a word or with one about the length of rows."""
    if name.endswith(".raw"):
        pytest.importorskip("cv2")
    (warning,) = imported(tmp_path, picture(bits).astype(order).tobytes(), name=name)
    assert said in warning
    assert not imported(tmp_path, picture(bits).astype("<u2").tobytes(), name=name, bits=bits)


@pytest.mark.parametrize("name", ["a.grey", "a.raw"])
def test_the_upper_byte_alone_is_no_swapped_one(tmp_path: Path, name: str) -> None:
    """Of 8 bits in the upper byte it was said that the upper one came first, and that they would fit the other way round."""
    if name.endswith(".raw"):
        pytest.importorskip("cv2")
    content = (picture(8) << 8).astype("<u2").tobytes()
    (warning,) = imported(tmp_path, content, name=name)
    assert (
        "two bytes, of which the first one is always the same: the upper one has all, say `--bits 16`"
        in warning
    )
    assert not imported(tmp_path, content, name=name, bits=16)
    with pytest.raises(
        RecordingError, match="lowest 8 bits of all are 0, .* say `--bits 16`, and no picture"
    ):
        imported(tmp_path, content, name=name, bits=8)


def test_bits_at_the_upper_end_are_told(tmp_path: Path) -> None:
    """As cameras send them that call it MSB-aligned."""
    with pytest.raises(
        RecordingError,
        match=r"the lowest 4 bits of all are 0, so that the upper 12 are used: say `--bits 16`",
    ):
        imported(tmp_path, (picture(12) << 4).astype("<u2").tobytes(), bits=12)


def test_one_byte_is_not_told(tmp_path: Path) -> None:
    """A picture, noise, a single value, two pixels, and columns that differ."""
    columns = np.tile(np.array([20, 200], np.uint8), (HEIGHT, WIDTH // 2))
    for frame in (
        picture(8).astype(np.uint8),
        noise((HEIGHT, WIDTH), 1),
        columns,
        columns * 0,
        columns[:1, :2],
    ):
        assert not order_of_two_bytes(frame.ravel())
    assert not imported(tmp_path, picture(8).astype(np.uint8).tobytes())


def test_a_frame_with_more_bits_is_skipped(tmp_path: Path) -> None:
    """As a picture in a file of its own is; the whole file was refused, in words without its name."""
    good, swapped = picture(12).astype("<u2").tobytes(), picture(12).astype(">u2").tobytes()
    (skipped,) = imported(tmp_path, good + swapped + good, bits=12)
    assert skipped.startswith(
        f"{tmp_path / 'a.grey'} 1: pixels must fit into the bits of `--bits 12`, but one is "
    )
    assert skipped.endswith(
        "; they would with their bytes the other way round: swap them, as `dd conv=swab` does"
    )
    with pytest.raises(
        RecordingError,
        match=r"a.grey 0: pixels must fit into the bits of `--bits 11`, but one is [\d,]+, and no picture",
    ):
        imported(tmp_path, picture(12).astype("<u2").tobytes(), bits=11)
