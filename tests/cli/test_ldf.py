"""`bfsim ldf` as it is called."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from PIL import Image

from bfsim.cli.main import main
from bfsim.shipped import LDF_FOLDER

# a single core of another chip, as its default LDF begins
BF533 = """
ARCHITECTURE(ADSP-BF533)
$OBJECTS = $COMMAND_LINE_OBJECTS;
MEMORY
{
   MEM_L1_CODE    { TYPE(RAM) START(0xFFA00000) END(0xFFA0FFFF) WIDTH(8) }
   MEM_L1_DATA_A  { TYPE(RAM) START(0xFF800000) END(0xFF803FFF) WIDTH(8) }
}
PROCESSOR p0
{
   SECTIONS
   {
      code { INPUT_SECTIONS($OBJECTS(L1_code program)) } > MEM_L1_CODE
      data { INPUT_SECTIONS($OBJECTS(L1_data_a)) INPUT_SECTIONS($OBJECTS(data1)) } > MEM_L1_DATA_A
   }
}
"""


def call(*arguments: str) -> Result:
    """Call the command line in this process; unexpected exceptions come through."""
    return CliRunner().invoke(main, ["ldf", *arguments], catch_exceptions=False, prog_name="bfsim")


def test_the_thesis_placement_is_shown_by_default() -> None:
    """Every segment and every buffer is there."""
    done = call()
    assert done.exit_code == 0
    assert done.output.startswith("thesis.ldf on cm-bf561: tinyphoon, 320x240 px")
    for text in ("MEM_B_L1_SCRATCH", "camera_ring", "0xFF800800", "tinyphoon_stages_open_closing_erode_row"):
        assert text in done.output
    assert max(map(len, done.output.splitlines())) <= 100


@pytest.mark.parametrize("name", ["l2", "l2.ldf"])
def test_shipped_ldfs_are_found_by_name_from_anywhere(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file of that name in the current folder is meant before; a folder is not."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "l2").mkdir()
    assert call(name, "--no-symbols").output == call(str(LDF_FOLDER / "l2.ldf"), "--no-symbols").output
    (tmp_path / "l2").rmdir()
    (tmp_path / name).write_text(BF533)
    assert "no firmware: the LDF is for an ADSP-BF533" in call(name, "--no-symbols").output


def test_shipped_parts_of_ldfs_are_included_from_anywhere(tmp_path: Path) -> None:
    """A placement of one's own is a few lines; a file of that name beside it is meant before."""
    own = tmp_path / "mine.ldf"
    own.write_text((LDF_FOLDER / "thesis.ldf").read_text())
    done = call(str(own), "--no-symbols")
    assert done.exit_code == 0
    assert done.output.replace("mine.ldf", "thesis.ldf") == call("thesis", "--no-symbols").output
    (tmp_path / "cm-bf561.ldfi").write_text("#error mine")
    assert "#error mine" in call(str(own)).output


def test_an_unknown_name_is_told_the_known_ones() -> None:
    """Those that are shipped."""
    done = call("l3")
    assert done.exit_code == 2
    assert "LDF must be a file or a shipped one (cache, cm-bf533, l2, sdram, thesis), not 'l3'" in done.stderr


def test_findings_do_not_fail() -> None:
    """Lint is advice: exit code 0."""
    done = call(str(LDF_FOLDER / "sdram.ldf"), "--no-symbols")
    assert done.exit_code == 0
    assert "MEM_SDRAM_BANK2: table in SDRAM" in done.output
    assert "\nSymbols" not in done.output


@pytest.mark.exhaustive
def test_size_and_profile_count() -> None:
    """Larger pictures take larger rings, and unoptimised code is longer; what L1 has no room for is in L2."""
    small, large, unoptimised = (
        json.loads(call("--json", *options).output)["segments"]
        for options in (
            ("--size", "160x120"),
            ("--size", "640x480"),
            ("--size", "160x120", "--profile", "gcc-O0"),
        )
    )
    used = [{each["name"]: each["used_bytes"] for each in one} for one in (small, large, unoptimised)]
    assert used[1]["MEM_SDRAM_BANK0"] - used[0]["MEM_SDRAM_BANK0"] == 3 * 2 * (640 * 480 - 160 * 120)
    assert used[1]["MEM_A_L1_DATA_A"] > used[0]["MEM_A_L1_DATA_A"]
    with_code = ("MEM_A_L1_CODE", "MEM_A_L1_CODE_CACHE", "MEM_L2_SRAM")
    code = [sum(each[name] for name in with_code) for each in used]
    assert code[2] > code[0] + 1024


@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_picture(suffix: str, tmp_path: Path) -> None:
    """It is written beside the tables, whole."""
    path = tmp_path / f"map.{suffix}"
    assert call("--no-symbols", "--picture", str(path)).exit_code == 0
    if suffix == "png":
        with Image.open(path) as picture:
            assert picture.width > 2000
    else:
        assert path.read_text().endswith("</svg>\n")


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (BF533, "the LDF is for an ADSP-BF533, the board cm-bf561 has an ADSP-BF561"),
        (BF533.replace("BF533", "BF561"), "the PROCESSORs of the LDF must be p0 and p1, not p0"),
        (
            BF533.replace("BF533", "BF561").replace("p0", "P0"),
            "the PROCESSORs of the LDF must be p0 and p1, not P0",
        ),
    ],
    ids=["another chip", "one processor", "another name"],
)
def test_an_ldf_of_other_cores_is_shown_without_the_firmware(text: str, why: str, tmp_path: Path) -> None:
    """Segments, and what they take in what order, and why there is no more."""
    path = tmp_path / "other.ldf"
    path.write_text(text)
    done = call(str(path))
    assert done.exit_code == 0
    assert f"no firmware: {why}" in " ".join(done.output.split())
    assert "L1_data_a data1" in done.output
    assert json.loads(call(str(path), "--json").output)["firmware"] == ""


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--size", "wide"], "must be width x height, such as 320x240, 1 to 9999 each, not 'wide'"),
        (["--size", "0x240"], "must be width x height"),
        (["--size", "9" * 5000 + "x1"], "must be width x height"),
        (["--board", "arduino"], "but there is none; built in are cm-bf561, "),
        (["--firmware", "nowhere:at_all"], "'nowhere' must be installed"),
        (["--picture", "map.jpg"], "--picture must be a file *.png or *.svg, not map.jpg"),
        (["--picture", "/no/such/folder/map.png"], "the folder /no/such/folder must exist"),
        (
            ["far/no.ldf"],
            "LDF must be a file or a shipped one (cache, cm-bf533, l2, sdram, thesis), not 'far/no.ldf'",
        ),
        (["--size", "1280x960"], "Out of memory in output section"),
    ],
)
def test_mistakes_end_with_2(arguments: list[str], message: str) -> None:
    """And with one paragraph."""
    done = call(*arguments)
    assert done.exit_code == 2
    assert message in done.output
    assert "Traceback" not in done.output


NEEDS_A_MACRO = BF533.replace(
    "MEMORY", '#if !defined(USE_SDRAM)\n#error define USE_SDRAM\n#endif\n#include "VDK.h"\nMEMORY'
)


def test_macros_and_folders_are_given_on_the_command_line(tmp_path: Path) -> None:
    """As the compiler's driver takes them, so that no file must be edited."""
    path, folder = tmp_path / "a.ldf", tmp_path / "vdk"
    path.write_text(NEEDS_A_MACRO)
    folder.mkdir()
    (folder / "VDK.h").write_text("#define VDK 1\n")
    assert "#error define USE_SDRAM" in call(str(path)).stderr
    assert "not 'VDK.h'" in call(str(path), "-D", "USE_SDRAM").stderr
    assert call(str(path), "-DUSE_SDRAM=1", "-I", str(folder)).exit_code == 0
    assert "must be NAME or NAME=VALUE, not '1X=2'" in call(str(path), "-D", "1X=2").stderr


def test_another_chip_is_not_drawn_over_the_board(tmp_path: Path) -> None:
    """At the addresses of its memories, the board may have others."""
    path = tmp_path / "other.ldf"
    path.write_text(BF533)
    found = json.loads(call(str(path), "--json").stdout)
    assert found["board"] == "ADSP-BF533"
    assert {each["memory"] for each in found["segments"]} == {"unknown"}


def test_a_segment_over_two_memories_has_both_names(tmp_path: Path) -> None:
    """Code SRAM of a BF533 and the part behind it that can be cache, in one, as its default LDF has it."""
    path = tmp_path / "one.ldf"
    path.write_text(BF533.replace("0xFFA0FFFF", "0xFFA13FFF").replace("p0", "P0"))
    found = json.loads(call(str(path), "--board", "cm-bf533", "--json").stdout)
    memories = {each["name"]: (each["memory"], each["owner"]) for each in found["segments"]}
    assert memories["MEM_L1_CODE"] == ("COREA_L1_CODE+CACHE", "A")
