"""What the firmware calls the colours of a picture, for people."""

from __future__ import annotations

from pathlib import Path

from click.testing import CliRunner
from PIL import Image

from benchmarks.colours import as_seen, main, reduced, rows

LIMITS = 28, 125, 28


def painted(path: Path) -> Path:
    """A picture of three thirds: an orange, a grey and a navy one."""
    picture = Image.new("RGB", (8, 6), (255, 128, 0))
    picture.paste((110, 110, 100), (0, 2, 8, 4))
    picture.paste((0, 0, 128), (0, 4, 8, 6))
    picture.save(path)
    return path


def test_the_table_has_each_colour_with_its_share(tmp_path: Path) -> None:
    """By name, in degrees and as a bit; grey has no colour, and dark blue is blue."""
    _, uyvy = as_seen(painted(tmp_path / "thirds.png"))
    found = {(name, degrees): share for name, degrees, _, share in rows(reduced(uyvy, LIMITS))}
    assert len(found) == 31
    seen = {name: share for name, share in found.items() if float(share) > 0}
    assert set(seen) == {("orange", "309 to 321"), ("blue", "90 to 103"), ("no colour", "")}
    assert set(seen.values()) == {"33.3"}


def test_the_picture_stands_beside_its_colours(tmp_path: Path) -> None:
    """As it is, then an orange, grey and blue third; the table is printed."""
    out = tmp_path / "out.png"
    result = CliRunner().invoke(main, [str(painted(tmp_path / "thirds.png")), str(out)])
    assert result.exit_code == 0, result.output
    with Image.open(out) as pair:
        assert pair.size == (16, 6)
        assert pair.getpixel((1, 1)) == (255, 128, 0)
        red, green, blue = pair.getpixel((9, 1))  # type: ignore[misc]
        assert red > green > blue
        assert pair.getpixel((9, 3)) == (128, 128, 128)
    assert "orange" in result.output
