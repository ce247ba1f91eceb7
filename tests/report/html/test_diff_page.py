"""The page of a difference: all of its contributions, pictures where there are some, and nobody's markup but its own."""

from __future__ import annotations

from dataclasses import replace

import pytest

from bfsim.report.diff.contributions import walk
from bfsim.report.diff.difference import (
    Change,
    Contribution,
    ContributionKind,
    Difference,
    FrameChange,
    SeenChange,
)
from bfsim.report.html.diff_page import FRAMES, DiffPage, PagedSide
from bfsim.report.html.undrawn import UndrawnFrames
from bfsim.report.overlay.overlay import overlay_of
from tests.report.evil import EVIL, Elements
from tests.seen_frames import frame as seen_frame


def contribution(kind: ContributionKind, name: str, cclk: int, *parts: Contribution) -> Contribution:
    """A part of a difference, of 1000 cycles before."""
    return Contribution(
        kind=kind,
        name=name,
        place="",
        before_cclk=1000,
        after_cclk=1000 + cclk,
        cclk=cclk,
        parts=parts,
    )


CAUSE = replace(
    contribution(ContributionKind.CAUSE, "stall: L2 port", 700), before_cclk=None, after_cclk=None
)
LINE = contribution(ContributionKind.LINE, "row[x] += by", 700, CAUSE)
STAGES = (
    contribution(
        ContributionKind.STAGE, "Edges", 700, contribution(ContributionKind.KERNEL, "blur", 700, LINE)
    ),
    contribution(
        ContributionKind.STAGE, "Lines", -350, contribution(ContributionKind.FOLLOWS, "waits", -350)
    ),
)
DIFFERENCE = Difference(
    configuration=(Change(what="ldf", before="l2.ldf", after="thesis.ldf"),),
    frames=(4, 5),
    measured_frames=2,
    has_lines=True,
    before_ms=10.0,
    after_ms=10.5,
    before_cclk_hz=1e6,
    after_cclk_hz=2e6,
    before_cclk=2000,
    after_cclk=2350,
    stages=STAGES,
    changed_frames=tuple(
        FrameChange(index=4 + each, before_cclk=9000, after_cclk=9500) for each in range(FRAMES + 1)
    ),
    results=(Change(what="edges", before="5", after="6"),),
    seen=(SeenChange(name="ball", gone=True, frames=1, first=4),),
)


def page(difference: Difference, frames: UndrawnFrames | None = None, name: str = "now") -> Elements:
    """The page of a difference to a result that was read."""
    return Elements(
        "".join(DiffPage(difference, PagedSide("old.json", None), PagedSide(name, frames)).chunks())
    )


def test_the_whole_tree_is_there() -> None:
    """Every contribution with its cycles, what has parts as something to open; the bars are parts of the largest stage."""
    found = page(DIFFERENCE)
    for _, each in walk(STAGES):
        assert f"{each.cclk:+,}" in found.words
        assert each.name in found.words
    assert found.names.count("summary") == 4 + FRAMES
    assert "Cycles of all cores in 2 frames" in found.words  # a board may have one
    text = "".join(DiffPage(DIFFERENCE, PagedSide("a", None), PagedSide("b", None)).chunks())
    assert text.count("width:50.00%") == 4
    assert text.count("width:25.00%") == 2


def test_many_buffers_that_moved_alike_are_one_row_and_all_are_there_to_open() -> None:
    """With another LDF fifty rows stood before the causes; the screen has a few."""
    moved = tuple(Change(what=f"buffer b{each}", before="L2", after="SDRAM") for each in range(9))
    found = page(replace(DIFFERENCE, configuration=(*DIFFERENCE.configuration, *moved)))
    assert "buffer b0 and 8 others" in found.words
    assert "All 10, one by one" in found.words
    assert "buffer b8" in found.words
    assert "one by one" not in page(DIFFERENCE).words


def test_the_frames_that_changed_most_have_the_pictures_that_there_are(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each in the clock of its own run, and no others are drawn; a result that was read has none, and says so."""
    drawn = []
    monkeypatch.setattr(
        "bfsim.report.html.pictures.overlay_of",
        lambda *given: drawn.append(given[0].index) or overlay_of(*given),
    )
    with UndrawnFrames(2) as frames:
        frames.add(seen_frame(4))
        frames.add(seen_frame(3))
        assert not drawn
        found = page(DIFFERENCE, frames)
    assert drawn == [4]
    words = " ".join(found.words.split())
    assert "Frame 4 9.00 → 4.75 ms" in words
    assert found.names.count("img") == 1
    assert words.count("No picture: old.json was read") == FRAMES
    assert f"{FRAMES + 1} of 2 changed" in words


def test_what_is_not_there_has_no_part_of_the_page() -> None:
    """Two runs that are the same: a sentence, and nothing to click."""
    same = replace(
        DIFFERENCE, configuration=(), after_cclk_hz=1e6, after_ms=10.0, after_cclk=2000,
        stages=(), changed_frames=(), results=(), seen=(),
    )  # fmt: skip
    found = page(same)
    assert "No difference: 10.00 ms a frame" in found.words
    assert "section" not in found.names


def test_commands_in_its_sentences_are_code() -> None:
    """They stand between backticks in a terminal."""
    change = Change(what="code", before="GCC 12.2.0", after="estimated")
    difference = replace(DIFFERENCE, configuration=(change,))
    text = "".join(DiffPage(difference, PagedSide("a", None), PagedSide("b", None)).chunks())
    assert "or with <code>--profile gcc-O2</code>, which estimates" in text
    assert "`" not in text.partition("<main>")[2]


def test_names_are_words_and_no_markup() -> None:
    """Of firmware, lines, numbers, objects and of the runs themselves; the page has no script at all."""
    evil = contribution(ContributionKind.STAGE, EVIL, 5, replace(LINE, name=EVIL, place=EVIL))
    change = Change(what=EVIL, before=EVIL, after=EVIL)
    seen = SeenChange(name=EVIL, gone=False, frames=1, first=0)
    found = page(
        replace(DIFFERENCE, configuration=(change,), stages=(evil,), results=(change,), seen=(seen,)),
        name=EVIL,
    )
    assert "script" not in found.names
    assert "img" not in found.names
    assert found.words.count(EVIL) >= 8
    assert all(each.startswith("#") for each in found.addresses)
