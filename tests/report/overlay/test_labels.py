"""Words on a picture: which are written, and where."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from PIL import Image, ImageDraw

from bfsim.report.overlay import style
from bfsim.report.overlay.labels import Label, write_labels
from bfsim.report.wording.letters import in_letters_of_pillow

RED, GREEN, BLUE = (255, 0, 0), (0, 255, 0), (0, 0, 255)


def written(*labels: Label) -> np.ndarray:
    """The pixels of a black panel of 400x300 with labels."""
    panel = Image.new("RGB", (400, 300))
    write_labels(ImageDraw.Draw(panel), labels, (0, 0, 400, 300))
    return np.asarray(panel)


def label(x: float, y: float, colour: tuple[int, int, int], weight: float = 0, side: float = 40) -> Label:
    """A label of a square thing."""
    return Label(x, y, "thing", colour, is_boxed=True, width=side, height=side, weight=weight)


def rows_of(panel: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    """The rows that have some of a colour."""
    return np.flatnonzero((panel == colour).all(axis=2).any(axis=1))


def test_a_label_stands_above_what_it_names_and_below_where_there_is_no_room() -> None:
    """And never on it."""
    assert rows_of(written(label(200, 150, RED)), RED).max() < 130
    assert rows_of(written(label(200, 15, RED)), RED).min() > 35
    assert (written(label(200, 150, RED))[130:170, 180:220] == 0).all()


def test_letters_that_the_font_lacks_are_others() -> None:
    """Pillow's own font has no accents: a published `größe` had two boxes in it."""
    font = style.font(style.LABEL_FONT)
    missing = bytes(font.getmask("\uffff"))
    for text, drawn in (
        ("größe", "gro?e"),
        ("Röte 赤い", "Rote ??"),
        ("±3 °C · 50 %", "±3 °C · 50 %"),
        ("m² …", "m2 ..."),
    ):
        assert in_letters_of_pillow(text) == drawn
        assert all(bytes(font.getmask(each)) != missing for each in drawn)
    both = (written(replace(label(200, 150, RED), text=text)) for text in ("größe", "gro?e"))
    np.testing.assert_array_equal(*both)


def test_one_place_has_one_label_that_of_the_greatest_weight() -> None:
    """Sixteen labels on one ball are one."""
    many = [label(200 + number % 4, 150 + number // 4, GREEN, weight=number / 100) for number in range(16)]
    panel = written(*many, label(201, 149, RED, weight=1))
    assert len(rows_of(panel, RED))
    assert not len(rows_of(panel, GREEN))


def test_neighbours_keep_off_each_other() -> None:
    """The label of the lower thing would cover the upper one: it goes below its own."""
    panel = written(label(200, 100, RED, weight=1), label(200, 145, BLUE))
    assert rows_of(panel, RED).max() < 80
    assert rows_of(panel, BLUE).min() > 165


def test_a_label_stands_beside_what_it_names_where_above_and_below_are_taken() -> None:
    """At its height, on the right or else on the left."""
    thing = label(200, 150, RED)
    taken = [label(200, y, BLUE, weight=1) for y in (90, 110, 190, 210)]
    for each in ([], [label(245, 150, GREEN, weight=1)]):
        panel = written(thing, *taken, *each)
        rows, columns = rows_of(panel, RED), np.flatnonzero((panel == RED).all(axis=2).any(axis=0))
        assert rows.min() > 130
        assert rows.max() < 170
        assert columns.max() < 180 if each else columns.min() > 220


def test_words_without_a_box_give_way() -> None:
    """A depth in the middle of a line is left out where a box stands."""
    box = label(200, 150, RED)
    assert len(rows_of(written(Label(200, 115, "400", GREEN, is_boxed=False)), GREEN))
    assert not len(rows_of(written(box, Label(200, 115, "400", GREEN, is_boxed=False)), GREEN))
