"""Pictures and options that no recording can be made of: refused in words, and nothing is written."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from bfsim.errors import RecordingError
from bfsim.recording.importing.importer import import_recording
from tests.recording.pictures import noise, save_grey


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with a little of everything that can be wrong."""
    monkeypatch.chdir(tmp_path)
    for k in range(3):
        save_grey(Path("three") / f"{k}.png", k)
    for k in range(2):
        save_grey(Path("two") / f"{k}.png", k)
        save_grey(Path("stamped") / f"{1000 + k}.png", k)
        save_grey(Path("large") / f"{k}.png", k, (10, 4))
        save_grey(Path("odd") / f"{k}.png", k, (7, 4))
        save_grey(Path("mixed") / f"{k}.png", k, (8, 4 + k))
    Path("sequence").mkdir()
    save_grey(Path("sequence/data/0.png"), 0)
    Path("sides").mkdir()
    for side in ("left", "right"):
        save_grey(Path("sides") / side / "0.png", 0)
        save_grey(Path("both") / f"img{side.capitalize()}0.png", 0)
    Path("empty").mkdir()
    Path("texts").mkdir()
    Path("texts/a.txt").touch()
    Path("texts/cam0").mkdir()
    Image.fromarray(noise((32, 32))).save("whole.png")
    Path("bad.png").write_bytes(Path("whole.png").read_bytes()[:500])
    Path("text.png").write_text("no image")
    Image.fromarray(np.full((4, 8), 4032, np.uint16)).save("deep.png")
    Image.fromarray(np.zeros((4, 8), np.float32)).save("floats.tiff")
    Path("short.uyvy").write_bytes(bytes(100))
    Path("none.uyvy").touch()
    os.mkfifo("pipe.uyvy")
    Path("frames.raw").write_bytes(bytes(64))
    head = b"YUV4MPEG2 W8 H4 F25:1 C420\n"
    one = b"FRAME\n" + bytes(48)
    Path("one.y4m").write_bytes(head + one)
    Path("two.y4m").write_bytes(head + 2 * one)
    Path("cut.y4m").write_bytes(head + one + one[:20])
    Path("frameless.y4m").write_bytes(head)
    Path("framing.y4m").write_bytes(head + one + b"X" + one)
    Path("ten_bit.y4m").write_bytes(head.replace(b"C420", b"C420p10") + one)
    Path("sizeless.y4m").write_bytes(head.replace(b"W8", b"W0") + one)
    Path("rate.y4m").write_bytes(head.replace(b"F25:1", b"Fast") + one)
    Path("fast.y4m").write_bytes(head.replace(b"F25:1", b"F50:1") + one)
    Path("other.y4m").write_bytes(b"RIFF" + bytes(2000))


@pytest.mark.usefixtures("sources")
def test_standard_output_is_no_recording() -> None:
    """A file called - is what a later command would take for standard input, and nobody would find."""
    with pytest.raises(RecordingError, match=r"^-: recording must have a name like run\.mcap"):
        import_recording(["three"], Path("-"), mono=True)


@pytest.mark.usefixtures("sources")
@pytest.mark.parametrize(
    ("names", "options", "message"),
    [
        (
            ["three", "stamped"],
            {},
            r"three and stamped: images must have names that tell the pairs.* not 3 and 2",
        ),
        (["two", "large"], {}, r"one size, not 8x4 \(two\) and 10x4 \(large\)"),
        (["one.y4m", "two.y4m"], {}, r"but one\.y4m ends after 1 and two\.y4m has more"),
        (["two.y4m", "one.y4m"], {}, r"but one\.y4m ends after 1 and two\.y4m has more"),
        (["one.y4m", "fast.y4m"], {}, "one frame rate, not 25 and 50; `--fps` sets it"),
        (["odd"], {"mono": True}, "odd: image width must be even .* not 7; `--resize`"),
        (
            ["large"],
            {"side_by_side": True},
            "large: side-by-side image must have a width of 4 x n pixels, not 10",
        ),
        (
            ["mixed"],
            {"mono": True},
            r"mixed/1\.png: image must be 8x4 like 0\.png, .* not 8x5; `--resize` or",
        ),
        (["mixed"], {"mono": True, "crop": (20, 4)}, "mixed: picture 1: 8x5 is too small for `--crop` 20x4"),
        (["two"], {"mono": True, "crop": (6, 4), "resize": (8, 4)}, "`--resize` or `--crop`, not both"),
        (["empty"], {"mono": True}, r"empty: source must hold images \(\.bmp, .*none of its 0 files"),
        (["texts"], {"mono": True}, r"none of its 2 files is one: a\.txt, cam0/$"),
        (["sequence"], {"mono": True}, r"none of its 1 files is one: data/; sequence/data holds some$"),
        (["both"], {}, r'sources must be 2, not 1: .* in quotes, such as "both/\*Left\*" "both/\*Right\*"$'),
        (["sides"], {}, r"in quotes, such as sides/left sides/right$"),
        (["three"], {}, r'in quotes, such as "left\*\.jpg"$'),
        (["two/*.jpg"], {"mono": True}, "none of its 0 files"),
        (["nowhere/left*"], {"mono": True}, r"nowhere/left\*: the folder nowhere must be there, but is not"),
        (["nowhere"], {"mono": True}, "nowhere: source .* is not there"),
        (["nowhere.png"], {"mono": True}, r"nowhere\.png: source must be .* is not there"),
        (["nowhere.uyvy"], {"mono": True, "size": (8, 4)}, "must be a readable file: No such file"),
        (["bad.png"], {"mono": True}, r"bad\.png: image must be readable: "),
        (["text.png"], {"mono": True}, r"text\.png: file must be an image that Pillow reads"),
        (
            ["deep.png"],
            {"mono": True},
            r"deep\.png: pixels must have 8 bits, or 16 of which .* --bits` .*: the brightest one here, 4,032, has 12$",
        ),
        (["deep.png"], {"mono": True, "bits": 11}, "fit into the bits of `--bits 11`, but one is 4,032"),
        (["deep.png"], {"mono": True, "bits": 7}, "`--bits` must be 8 to 16, not 7"),
        (["floats.tiff"], {"mono": True}, "pixels of 8 bits, or grey ones of 16, not the pixel format F"),
        (
            ["two/0.png"],
            {"mono": True, "bits": 12},
            "grey pixels of 16 bits for `--bits 12`, not pixels of 8",
        ),
        (["short.uyvy"], {"mono": True, "bits": 12}, "`--bits` must go with images, grey, bayer_rggb8"),
        (["short.uyvy"], {"mono": True}, r"short\.uyvy: raw UYVY needs the size .* `--size 320x240`"),
        (
            ["short.uyvy"],
            {"mono": True, "size": (8, 4)},
            "8x4 UYVY frames of 64 bytes, not 100 bytes: 1 frames and 36 bytes",
        ),
        (["none.uyvy"], {"mono": True, "size": (8, 4)}, "not 0 bytes"),
        (["short.uyvy"], {"mono": True, "size": (7, 4)}, "width of UYVY frames must be even, not 7"),
        (["short.uyvy"], {"mono": True, "size": (8, 3), "format": "i420"}, "must be even, not 8x3"),
        (["frames.raw"], {"mono": True}, r"does not tell its format \(`--format` images, uyvy, i420"),
        (["cut.y4m"], {"mono": True}, r"frame 1 must have 48 bytes, not 14: .* starts at byte 87"),
        (["frameless.y4m"], {"mono": True}, "at least one whole frame"),
        (["framing.y4m"], {"mono": True}, r"frame 1 must start with FRAME, not 'XFRAME' \(before byte 88\)"),
        (["ten_bit.y4m"], {"mono": True}, "colourspace must be one of 420, .* not 420p10"),
        (["sizeless.y4m"], {"mono": True}, "must give a size .* not W0 H4"),
        (["rate.y4m"], {"mono": True}, "frame rate must be like F30:1, not Fast"),
        (["other.y4m"], {"mono": True}, r"header line must end within 1024 bytes \(frame 0, byte 0\)"),
        (["two"], {}, "sources must be 2, not 1: two"),
        (["two", "two", "two"], {}, 'sources must be 2, not 3: .*, or a pattern in quotes, such as "left'),
        (["two", "two"], {}, "two: sources must be of two cameras, .* not one twice; .* `--mono`"),
        (["two", "sides/../two"], {}, "sources must be of two cameras"),
        (["two/*.png", "two/*.png"], {}, "sources must be of two cameras"),
        (
            ["pipe.uyvy"],
            {"mono": True, "size": (8, 4)},
            r"pipe\.uyvy: source must be a file, .* not a pipe; save",
        ),
        (["two", "two"], {"mono": True}, "sources must be 1, not 2"),
        (["two"], {"mono": True, "side_by_side": True}, "not both"),
        (["two"], {"mono": True, "fps": 0}, "frame rate must be 0.000001 to .* not 0"),
        (["two"], {"mono": True, "fps": 1e-300}, "frame rate must be 0.000001 to .* not 1e-300"),
        (["two"], {"mono": True, "fps": float("nan")}, "frame rate must be 0.000001 to .* not nan"),
        (
            ["two"],
            {"mono": True, "size": (8, 4), "format": "images"},
            "two: `--size` must go with raw frames, .*; `--resize` ",
        ),
        (["cut.y4m"], {"mono": True, "size": (8, 4)}, r"cut.y4m: `--size` must go with raw frames"),
        (["two"], {"mono": True, "resize": (7, 4)}, "`--resize` must be above 0 and of even width, not 7x4"),
    ],
)
def test_bad_input(names: list[str], options: dict[str, Any], message: str) -> None:
    """Each mistake is named with its file and place, and no recording, not even half of one, is left."""
    before = sorted(Path().rglob("*"))
    with pytest.raises(RecordingError, match=message):
        import_recording(names, "out.mcap", **options)
    assert sorted(Path().rglob("*")) == before
