"""`bfsim diff` from the terminal's side: results and runs on the spot, all outputs, and mistakes."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from bfsim.cli.main import main
from bfsim.recording.writer import RecordingWriter
from tests.browser import CUT_OFF, PAPER_PX, browsing, needs_chromium

FIRMWARE = """
from bfsim.api import Buffer, BudgetRow, Firmware, i32, kernel, u8

@kernel
def brighten(row: u8[:], by: i32) -> None:
    for x in range(len(row)):
        row[x] = row[x] + by

def main(core):
    while (frame := (yield from core.next_frame())) is not None:
        core.publish(rows=len(frame.rows))
        with core.stage("Brighten"):
            for row in frame.rows[:4]:
                yield core.run(brighten, row, 3)

def buffers(size):
    return {core: [Buffer("camera", u8, 2 * size.width_px, f"sdram_bank{n}", rows=size.height_px)]
            for n, core in enumerate("AB")}

firmware = Firmware(mains={"A": main, "B": main}, buffers=buffers, camera="camera", rows=(BudgetRow(stage="Brighten"),))
"""


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with firmware and a recording of two grey frames, where the user is."""
    picture = np.full((16, 64), 128, np.uint8)
    with RecordingWriter(tmp_path / "drive.mcap", width=32, height=16) as writer:
        for number in range(2):
            writer.add(picture, picture, number * 33_000_000, number * 33_000_000)
    (tmp_path / "slow.py").write_text(FIRMWARE)
    (tmp_path / "fast.py").write_text(FIRMWARE.replace("frame.rows[:4]", "frame.rows[:2]"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def bfsim(*arguments: object) -> Result:
    """Call the command line in this process."""
    return CliRunner(env={"COLUMNS": "80"}).invoke(main, [str(each) for each in arguments])


def keep(name: str, *arguments: object) -> None:
    """Run firmware and keep the result."""
    done = bfsim("run", "drive.mcap", *arguments, "--json", name)
    assert done.exit_code == 0, done.output


def test_only_a_page_needs_the_packages_of_pages(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A plain installation has none of them; `home` is where the result lies."""
    keep("slow.json", "--firmware", "slow.py:firmware")
    monkeypatch.setitem(sys.modules, "bfsim.report.html.diff_page", None)
    done = bfsim("diff", home / "slow.json", "slow.json")
    assert done.exit_code == 0, done.output


def test_results_and_runs_on_the_spot_differ_alike(home: Path) -> None:
    """Half the calls: the cause is named, also where the cameras bound the frame; a side that is run is as good as one that is read."""
    keep("slow.json", "--firmware", "slow.py:firmware")
    keep("fast.json", "--firmware", "fast.py:firmware")
    read = bfsim("diff", "slow.json", "fast.json")
    assert read.exit_code == 0, read.output
    for words in ("as fast as before", "What differs in the configuration", "brighten (fast.py:", "All"):
        assert words in read.output
    on_the_spot = bfsim("diff", "slow.json", "drive.mcap --firmware fast.py:firmware")
    assert on_the_spot.output == read.output
    (home / "a name with spaces.json").write_text((home / "fast.json").read_text())
    assert bfsim("diff", "slow.json", "a name with spaces.json").output == read.output
    markdown = bfsim("diff", "slow.json", "fast.json", "--markdown")
    assert markdown.output.startswith("**")
    assert "| --- |" in markdown.output


def test_the_json_has_the_whole_tree(home: Path) -> None:
    """The parts of everything sum to it, down to the causes of a line."""
    keep("before.json", "--firmware", "slow.py:firmware")
    keep("after.json", "--firmware", "fast.py:firmware", "--ldf", "l2")
    found = json.loads(bfsim("diff", "before.json", "after.json", "--json").output)
    assert found["schema"] == "bfsim.diff/2"
    assert found["cclk"] == found["after_cclk"] - found["before_cclk"]
    levels, parts = 0, [(found["cclk"], found["stages"])]
    while parts:
        assert all(cclk == sum(each["cclk"] for each in of) for cclk, of in parts)
        parts = [(each["cclk"], each["parts"]) for _, of in parts for each in of if each["parts"]]
        levels += 1
    assert levels > 3


def test_a_run_does_not_differ_from_itself(home: Path) -> None:
    """Read back, nothing is lost."""
    keep("once.json", "--firmware", "slow.py:firmware")
    same = bfsim("diff", "once.json", "drive.mcap --firmware slow.py:firmware")
    assert same.output.startswith("No difference")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "must be JSON as `bfsim run --json` writes it"),
        ("[]", "must be a result of `bfsim run --json`, not []"),
        ('{"schema": "bfsim.run/1"}', "must be a result of this version of bfsim"),
        ('{"schema": "SCHEMA"}', "frames must be there"),
        ('{"schema": "SCHEMA", "frames": 3}', "frames must be a valid list, not 3"),
    ],
)
def test_a_file_that_is_no_result_is_refused(home: Path, text: str, told: str) -> None:
    """Before anything runs, with the file's name."""
    from bfsim.report.results.as_json import SCHEMA

    (home / "wrong.json").write_text(text.replace("SCHEMA", SCHEMA))
    refused = bfsim("diff", "wrong.json", "no-such-recording.mcap")
    assert refused.exit_code == 2
    assert "wrong.json" in refused.stderr
    assert told in " ".join(refused.stderr.split())


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("owners", 3, "wrong.json: owners must be a valid list, not 3"),
        ("version", 1 << 1000, "a number must have at most 64 bits, not be 10715086071862673209"),
        ("version", -(1 << 63) - 1, "a number must have at most 64 bits, not be -9223372036854775809"),
        ("owners", [3], "wrong.json: owners.0 must be a dictionary, not 3"),
        ("kernels", "all", "wrong.json: kernels must be a valid list, not 'all'"),
        ("code", [{}], "wrong.json: code.0.core must be there"),
    ],
)
def test_a_result_that_was_edited_is_told_with_its_key(
    home: Path, key: str, value: object, told: str
) -> None:
    """In words of the file, and none of Python's."""
    keep("once.json", "--firmware", "slow.py:firmware")
    (home / "wrong.json").write_text(json.dumps(json.loads((home / "once.json").read_text()) | {key: value}))
    refused = bfsim("diff", "once.json", "wrong.json")
    assert refused.exit_code == 2
    assert told in " ".join(refused.stderr.split())


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        (("frames", 0, "cores"), [], "frames must have what at least one core did in each"),
        (("identity", "cclk_hz"), 0, "identity.cclk_hz must be a rate in Hz, not 0.0"),
        (("identity", "sclk_hz"), float("nan"), "identity.sclk_hz must be a rate in Hz, not nan"),
        (("owners", 0, "waiting_cclk"), [], "owners must have a number for each of the 2 frames"),
    ],
)
def test_a_result_that_no_run_leaves_is_refused(
    home: Path, key: tuple[str | int, ...], value: object, told: str
) -> None:
    """Each ended in a traceback, or in frames of `nan` ms."""
    keep("once.json", "--firmware", "slow.py:firmware")
    plain = part = json.loads((home / "once.json").read_text())
    for each in key[:-1]:
        part = part[each]
    part[key[-1]] = value
    (home / "wrong.json").write_text(json.dumps(plain))
    refused = bfsim("diff", "once.json", "wrong.json")
    assert refused.exit_code == 2
    assert f"wrong.json: {told}" in " ".join(refused.stderr.split())


@pytest.mark.parametrize(
    ("side", "told"),
    [
        ("missing.json", "there is no such file"),
        ("drive.mcap --no-such-option", "No such option"),
        ("drive.mcap --script no-such-orders.toml", "no-such-orders.toml must be a readable file"),
        ("drive.mcap 'open", "words as a shell takes them"),
        ("missing.toml", "missing.toml must be a baseline file, but there is none"),
        ("two.toml", "two.toml:NAME must name one of its runs; they are 'a', 'b'"),
        ("two.toml:c", "two.toml must have a run called 'c'; they are 'a', 'b'"),
        ("two.toml:a", "run 'a' must have been measured: --update does that"),
    ],
)
def test_a_side_that_cannot_be_is_refused(home: Path, side: str, told: str) -> None:
    """As `bfsim run` or `bfsim check` would refuse it."""
    (home / "two.toml").write_text("[[run]]\nname = 'a'\n[[run]]\nname = 'b'\n")
    refused = bfsim("diff", "drive.mcap --firmware slow.py:firmware", side)
    assert refused.exit_code == 2
    assert told in " ".join(refused.stderr.split())


def test_a_page_has_the_pictures_of_what_was_run(home: Path) -> None:
    """Beside the table, which stays as it is; a side that was read has none, and the cycles are the same with a page."""
    keep("slow.json", "--firmware", "slow.py:firmware")
    arguments = "diff", "slow.json", "drive.mcap --firmware fast.py:firmware"
    plain, paged = bfsim(*arguments), bfsim(*arguments, "--html", "page.html")
    assert paged.exit_code == 0, paged.output
    assert paged.output == plain.output
    text = (home / "page.html").read_text()
    assert text.count("data:image/webp") == 2
    assert text.count("No picture: slow.json") == 2
    assert "brighten (fast.py:" in text


def test_a_page_that_cannot_be_written_is_refused_before_the_run(home: Path) -> None:
    """Nowhere to write, or what is read."""
    keep("slow.json", "--firmware", "slow.py:firmware")
    for where, words in (("no/page.html", "must exist"), ("slow.json", "must be a file of its own")):
        refused = bfsim("diff", "slow.json", "drive.mcap --firmware fast.py:firmware", "--html", where)
        assert refused.exit_code == 2
        assert words in " ".join(refused.output.split())
    assert bfsim("diff", "slow.json", "slow.json").exit_code == 0


@needs_chromium
def test_the_page_opens_in_a_browser(home: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Without a complaint; the keyboard opens the tree down to the cause; it fits a phone, and paper."""
    bfsim(
        "diff",
        "drive.mcap --firmware slow.py:firmware",
        "drive.mcap --firmware fast.py:firmware",
        "--html",
        "page.html",
    )
    with browsing(tmp_path_factory.mktemp("chromium")) as browser:
        browser.look(width=360, scheme="dark")
        browser.driver.get((home / "page.html").as_uri())
        assert not browser.complaints()
        assert browser.ask("document.documentElement.scrollWidth <= innerWidth")
        closed = browser.driver.find_element(By.CSS_SELECTOR, ".tree details:not([open]) > summary")
        closed.send_keys(Keys.ENTER)
        assert closed.find_element(By.XPATH, "..").get_attribute("open")
        causes = browser.driver.find_elements(By.CSS_SELECTOR, ".row.cause")
        assert any(each.is_displayed() for each in causes)
        browser.look(width=PAPER_PX, medium="print")
        assert not browser.ask(CUT_OFF)  # of a kernel's name, eight letters were printed
