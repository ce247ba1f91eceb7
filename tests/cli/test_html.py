"""`bfsim run --html` and `bfsim profile --html`, from the terminal's side, and the page in a real browser."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from bfsim import run_page
from bfsim.cli.main import main
from bfsim.report.html.pictures import Pictures
from bfsim.shipped import accuracy_on
from tests.browser import CUT_OFF, PAPER_PX, PATIENCE_S, Browser, browsing, needs_chromium
from tests.pages import ROOT
from tests.report.evil import evil_run
from tests.report.pages_by_hand import page_of
from tests.seen_frames import frame as seen_frame


def bfsim(*arguments: object, frames: int = 1) -> Result:
    """Run a command on the first frames of the built-in recording."""
    command, *others = map(str, arguments)
    return CliRunner().invoke(
        main, [command, "--frames", str(frames), *others], catch_exceptions=False, prog_name="bfsim"
    )


def refused(*arguments: object) -> str:
    """Run what is a mistake: exit code 2, and nothing has been simulated."""
    result = bfsim(*arguments)
    assert result.exit_code == 2, result.output
    assert not result.stdout
    return " ".join(result.stderr.split())


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, object]]:
    """The page of three frames, and the JSON of the same run."""
    folder = tmp_path_factory.mktemp("written")
    page, report = folder / "run.html", folder / "run.json"
    result = bfsim("run", "--html", page, "--json", report, "--target", "15Hz", frames=3)
    assert result.exit_code == 0, result.output
    return page, json.loads(report.read_text())


@pytest.mark.exhaustive
def test_the_cycles_are_the_same_with_a_page(written: tuple[Path, dict[str, object]]) -> None:
    """Looking costs nothing on the simulated machine."""
    plain = json.loads(bfsim("run", "--json", "-", frames=3).stdout)
    assert written[1]["digests"] == plain["digests"]


def test_a_profile_writes_a_page_too(tmp_path: Path) -> None:
    """Beside its tables; without a target there is no slack."""
    result = bfsim("profile", "--html", tmp_path / "profile.html", "--ldf", "thesis", "--set", "sdram.nRP=3")
    assert result.exit_code == 0, result.output
    text = (tmp_path / "profile.html").read_text()
    assert text.count("data:image/webp") == 2
    assert "slack, worst" not in text
    assert "thesis.ldf on cm-bf561" in text


def test_mistakes_are_told_before_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each in one sentence that says what to do."""
    page = tmp_path / "run.html"
    for command in ("run", "profile"):
        assert "--target must come with the tables or --html FILE" in refused(
            command, "--target", "15Hz", "--json", "-"
        )
    assert "must be a frame rate such as 15Hz or a frame time such as 66ms, not 'soon'" in refused(
        "run", "--html", page, "--target", "soon"
    )
    assert "must exist to write a file there" in refused("run", "--html", tmp_path / "no" / "run.html")
    both = tmp_path / "run.json"
    assert "must be a file of its own" in refused("run", "--html", both, "--json", both)
    monkeypatch.setattr(run_page, "find_spec", lambda name: None if name == "vl_convert" else object())
    assert (
        'needs the package vl_convert; install all that it needs with: pip install "bfsim[html]"'
        in refused("profile", "--html", page)
    )
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("full", [[], ["--full"]])
def test_a_target_stands_on_the_screen(full: list[str]) -> None:
    """In one sentence, without a page; the same in the full report."""
    words = " ".join(bfsim("run", "--target", "15Hz", *full, frames=2).stdout.split())
    assert re.search(
        r"Target 15 Hz, 66\.67 ms a frame: kept by 0 of 2 frames; the worst, frame \d, must save [\d.]+ ms\. "
        r"Most of it, on core [AB]: Edge detection [\d.]+, ",
        words,
    )


@pytest.mark.exhaustive
def test_firmware_without_a_view_has_its_pictures(tmp_path: Path) -> None:
    """The plain ones, and where in them its time went."""
    firmware = tmp_path / "blind.py"
    firmware.write_text(
        "from dataclasses import replace\nfrom tinyphoon import tinyphoon\nblind = replace(tinyphoon, view=None)\n"
    )
    result = bfsim("run", "--firmware", f"{firmware}:blind", "--html", tmp_path / "run.html")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "run.html").read_text().count("data:image/webp") == 2


def test_the_page_says_of_accuracy_what_the_readme_says() -> None:
    """Both have it from the page about accuracy."""
    assert accuracy_on("In short")
    assert accuracy_on("In short") in (ROOT / "README.md").read_text()
    assert accuracy_on("What is not modelled").startswith("- ")


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """One browser for all."""
    with browsing(tmp_path_factory.mktemp("chromium")) as found:
        yield found


@pytest.fixture
def opened(browser: Browser, written: tuple[Path, dict[str, object]]) -> Browser:
    """The page of the run, anew."""
    browser.look()
    browser.driver.get("about:blank")
    browser.open(written[0])
    return browser


def shown_frame(browser: Browser) -> tuple[str, list[str]]:
    """The frame that can be seen, and its pictures, what was seen and the heat map; no other one can."""
    (article,) = [
        each for each in browser.driver.find_elements(By.TAG_NAME, "article") if each.is_displayed()
    ]
    images = article.find_elements(By.TAG_NAME, "img")
    for image in images:
        assert browser.driver.execute_script(
            "return arguments[0].decode().then(() => arguments[0].naturalWidth)", image
        )
    return article.get_attribute("id") or "", [image.get_attribute("src") or "" for image in images]


@needs_chromium
def test_the_console_is_silent(opened: Browser) -> None:
    """No error, no warning, nothing asked of the network."""
    assert not opened.complaints()
    assert (
        opened.ask(
            "performance.getEntriesByType('resource').filter(each => !each.name.startsWith('data:')).length"
        )
        == 0
    )


@needs_chromium
def test_the_numbers_are_those_of_the_run(opened: Browser, written: tuple[Path, dict[str, object]]) -> None:
    """Frame rate, digests, and what core A used of the worst frame, beside the target."""
    report = written[1]
    words = opened.driver.find_element(By.TAG_NAME, "body").text
    assert f"{report['budget']['frame_rate_hz']:.2f}" in words
    assert set(report["digests"].values()) <= set(words.split())
    hz = report["identity"]["cclk_hz"]
    used_ms = [
        sum(cost["issue_cclk"] + sum(cost["stall_cclk"].values()) for cost in frame["cores"][0]["stages"])
        * 1000
        / hz
        for frame in report["frames"]
    ]
    row = opened.driver.find_element(By.CSS_SELECTOR, ".slacks tbody tr").text.split()
    slacks = [1000 / 15 - each for each in (sorted(used_ms)[1], max(used_ms))]
    assert row == [
        "A",
        f"{sorted(used_ms)[1]:.2f}",
        f"{max(used_ms):.2f}",
        *(f"\N{MINUS SIGN}{-each:.2f}" for each in slacks),
    ]
    assert "kept by 0 of 3 frames" in words


@needs_chromium
def test_choosing_a_frame_changes_the_picture(opened: Browser) -> None:
    """By a link, the arrow keys of the slider, the buttons and a bar of a chart; first there is the worst frame."""
    link = opened.driver.find_element(By.CSS_SELECTOR, ".chip")
    worst = (link.get_attribute("href") or "").rpartition("#")[2]
    assert shown_frame(opened)[0] == worst
    opened.driver.find_element(By.ID, "choose").send_keys(Keys.HOME)
    first, pictures = shown_frame(opened)
    gantt = opened.ask("document.getElementById('gantt').innerHTML")
    opened.driver.find_element(By.ID, "choose").send_keys(Keys.ARROW_RIGHT)
    second, others = shown_frame(opened)
    assert (first, second) == ("frame-0", "frame-1")
    assert len({*pictures, *others}) == 4
    redrawn = "return document.getElementById('gantt').innerHTML !== arguments[0]"
    WebDriverWait(opened.driver, PATIENCE_S).until(lambda driver: driver.execute_script(redrawn, gantt))
    opened.driver.find_element(By.ID, "after").click()
    assert shown_frame(opened)[0] == "frame-2"
    opened.driver.find_elements(By.CSS_SELECTOR, "#series-A .mark-rect path")[0].click()
    assert shown_frame(opened) == (first, pictures)
    link.send_keys(Keys.ENTER)
    assert shown_frame(opened)[0] == worst


@needs_chromium
def test_the_tab_key_reaches_every_control(opened: Browser) -> None:
    """And one sees where it is."""
    seen = []
    for _ in range(60):
        opened.driver.switch_to.active_element.send_keys(Keys.TAB)
        seen.append(str(opened.ask("document.activeElement.id || document.activeElement.tagName")))
        if seen[-1] != "BODY":
            assert opened.ask("getComputedStyle(document.activeElement).outlineStyle") != "none"
    assert {"A", "choose", "SUMMARY", "DIV"} <= set(seen)


@needs_chromium
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [360, 1280])
def test_it_fits_a_phone_and_a_screen_in_light_and_dark(opened: Browser, width: int, scheme: str) -> None:
    """Nothing is wider than the window, and words differ from what they are on by 4.5 to 1 at least."""
    opened.look(width=width, scheme=scheme)
    opened.driver.refresh()
    assert opened.ask("document.documentElement.scrollWidth <= innerWidth")
    for where in ("body", ".faint", "a", "text"):
        ink = str(
            opened.ask(
                f"((each) => getComputedStyle(each)[each instanceof SVGElement ? 'fill' : 'color'])(document.querySelector('main {where}, {where}'))"
            )
        )
        paper = str(opened.ask("getComputedStyle(document.body).backgroundColor"))
        assert contrast(ink, paper) >= 4.5, (where, ink, paper)


@needs_chromium
def test_on_paper_nothing_is_cut_off(opened: Browser) -> None:
    """Tables that scroll on a screen ended at the edge of the page, with the bar that nobody can move."""
    opened.look(width=PAPER_PX, medium="print")
    assert not opened.ask(CUT_OFF)  # what is wider than the page, browsers shrink to it


def contrast(one: str, other: str) -> float:
    """Contrast of two colours by WCAG 2."""
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def luminance(colour: str) -> float:
    """Relative luminance of rgb(r, g, b) by WCAG 2."""
    parts = [int(each) / 255 for each in re.findall(r"\d+", colour)[:3]]
    red, green, blue = (
        part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


@needs_chromium
def test_evil_names_do_nothing(browser: Browser, tmp_path: Path) -> None:
    """Not in words, not in charts and not in what hovers over them."""
    page = tmp_path / "evil.html"
    with Pictures() as pictures:
        pictures.add(seen_frame(0))
        page.write_text(page_of(evil_run(), pictures), encoding="utf-8")
    browser.open(page)
    assert not browser.complaints()
    assert browser.ask("typeof pwned") == "undefined"
    assert browser.ask("document.querySelectorAll('script').length") == 3
