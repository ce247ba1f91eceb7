"""The drawing of a memory map: to scale, in the right colours, as PNG and as SVG."""

from __future__ import annotations

import colorsys
from io import BytesIO
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from PIL import Image

from bfsim.errors import ConfigError
from bfsim.report.ldf.colours import HUES, colours_of
from bfsim.report.ldf.drawing import BAR_HEIGHT, LETTER_WIDTH, PANEL_WIDTH, drawing_of
from bfsim.report.ldf.map import ContentKind
from bfsim.report.ldf.picture import PIXELS, picture_bytes, png_of, svg_of
from tests.report.ldf_maps import BANK_BYTES, a_map, a_segment, a_symbol

CAMERA = a_symbol("camera", ContentKind.CAMERA, "A", 0, BANK_BYTES // 4)
ODD = a_symbol("<odd> & even", ContentKind.LINES, "B", BANK_BYTES // 2, BANK_BYTES // 2)
KERNELS = a_symbol("13 kernels", ContentKind.CODE, "A", 0xFEB00000, 1000)
MAP = a_map(a_segment("SDRAM", CAMERA, ODD), a_segment("L2", KERNELS, start=0xFEB00000, nbytes=128 * 1024))
COLOURS = colours_of(MAP)
SVG = "{http://www.w3.org/2000/svg}"


def test_names_have_colours_of_their_own() -> None:
    """Forty buffers, forty colours; a name has one colour wherever it is."""
    buffers = [a_symbol(f"b{number}", ContentKind.LINES, "A", number * 1000) for number in range(40)]
    again = [a_symbol(f"b{number}", ContentKind.LINES, "B", number * 1000) for number in range(40)]
    colours = colours_of(a_map(a_segment("SDRAM", *buffers), a_segment("SDRAM", *again)))
    assert len(colours) == len(set(colours.values())) == 40


def test_a_kind_has_a_hue() -> None:
    """Forty buffers of a kind are nearer to its own hue than to that of any other kind, and light enough for black letters."""
    for kind, hue in HUES.items():
        made = [a_symbol(f"b{number}", kind, "A", number * 1000) for number in range(40)]
        for colour in colours_of(a_map(a_segment("SDRAM", *made))).values():
            red, green, blue = (int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5))
            found, lightness, _ = colorsys.rgb_to_hls(red, green, blue)
            off = {each: abs((found - HUES[each] + 0.5) % 1 - 0.5) for each in HUES}
            assert min(off, key=lambda each: off[each]) is kind, (colour, hue)
            assert lightness > 0.59


def test_labels_do_not_overprint() -> None:
    """No two texts of the sheet meet, by the width that is taken for each letter; long names have fewer columns."""
    long = [
        a_symbol(f"a_name_of_more_than_thirty_letters_{number}", ContentKind.ROW, "A", 1000 * number, 900)
        for number in range(5)
    ]
    for made in (MAP, a_map(a_segment("SDRAM", *long))):
        boxes = [
            (x, x + width, each.y)
            for each in drawing_of(made).words
            for width in [len(each.text) * each.font_px * LETTER_WIDTH]
            for x in [each.x - width * each.is_right]
        ]
        for number, (left, right, y) in enumerate(boxes):
            for other in boxes[:number]:
                assert right <= other[0] or other[1] <= left or abs(y - other[2]) >= 12


def test_bars_are_to_scale() -> None:
    """A quarter of a segment is a quarter of its bar, where it begins."""
    bars = {each.fill: each for each in drawing_of(MAP).boxes if each.height == BAR_HEIGHT}
    camera, odd = bars[COLOURS["camera"]], bars[COLOURS["<odd> & even"]]
    assert camera.width == PANEL_WIDTH / 4
    assert (odd.x - camera.x, odd.width) == (PANEL_WIDTH / 2, PANEL_WIDTH / 2)


def test_nothing_is_drawn_beside_the_sheet() -> None:
    """Every box lies inside; texts begin and end inside."""
    sheet = drawing_of(MAP)
    assert all(0 <= each.x <= each.x + each.width <= sheet.width for each in sheet.boxes)
    assert all(0 <= each.y <= each.y + each.height <= sheet.height for each in sheet.boxes)
    assert all(0 < each.x < sheet.width and 0 < each.y < sheet.height for each in sheet.words)


def test_every_symbol_is_named_with_its_size() -> None:
    """Also those that are too small to have their name in the bar."""
    texts = {each.text for each in drawing_of(MAP).words}
    assert {"camera (A)  2.00 MB", "<odd> & even (B)  4.00 MB", "13 kernels (A)  1000 B"} <= texts


def test_png_shows_the_bars() -> None:
    """The middle of the camera's bar has the camera's colour."""
    sheet = drawing_of(MAP)
    box = next(each for each in sheet.boxes if each.fill == COLOURS["camera"] and each.height == BAR_HEIGHT)
    picture = Image.open(BytesIO(png_of(sheet)))
    assert picture.size == (sheet.width * PIXELS, sheet.height * PIXELS)
    spot = round((box.x + 0.9 * box.width) * PIXELS), round((box.y + box.height / 2) * PIXELS)
    assert "#{:02x}{:02x}{:02x}".format(*picture.getpixel(spot)) == COLOURS["camera"]


def test_svg_is_well_formed() -> None:
    """As many boxes and texts as in the drawing, and names with signs of XML come through."""
    sheet = drawing_of(MAP)
    root = ET.fromstring(svg_of(sheet))
    assert len(root.findall(f"{SVG}rect")) == len(sheet.boxes) + 1  # and the paper
    assert [each.text for each in root.findall(f"{SVG}text")] == [each.text for each in sheet.words]


def test_the_suffix_chooses_the_format() -> None:
    """And only what can be written is accepted."""
    assert picture_bytes(MAP, Path("map.PNG")).startswith(b"\x89PNG")
    assert picture_bytes(MAP, Path("map.svg")).startswith(b"<svg")
    with pytest.raises(ConfigError, match=r"--picture must be a file \*\.png or \*\.svg, not map\.jpg"):
        picture_bytes(MAP, Path("map.jpg"))
