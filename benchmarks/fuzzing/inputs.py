"""One function for each kind of input: writes files into a folder and returns the arguments of `bfsim`.

Nothing is simulated: where a run could begin, the recording is one that is not there, and so the end of a good input is the
message about that.
"""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path
from random import Random

import numpy as np
import tomlkit
import zstandard
from PIL import Image

from benchmarks.fuzzing.values import NUMBERS, WORDS, any_value, changed_bytes, changed_text, changed_tree
from bfsim import shipped
from bfsim.chip.boards import BOARDS
from bfsim.fields import leaves
from tests.recording import attacks

NO_RECORDING = "no-such-recording.mcap"

SCRIPT = {
    "send": [
        {"after_frames": 3, "mode": {"edges": {"edge_threshold": 12}, "area": [10, 20, 300, 200]}},
        {"after_frames": 5, "mode": {"camera": {"width": 160, "height": 120, "gain": 20}}},
        {"after_frames": 6, "models": ["ball", {"name": "blue goal", "width_mm": 600}]},
        {"after_frames": 7, "bytes": [241, 181, 2, 0]},
        {"after_frames": 8, "type": "MODE", "words": [8, 28, 125]},
    ]
}
BASELINE = {
    "run": [
        {
            "name": "soccer", "recording": "soccer.mcap", "frames": 8, "ldf": "l2", "feed": "demand", "set": {"sdram.nRP": "3"},
            "tolerance_percent": 0.5, "results_tolerance_percent": 1,
            "require": ["frame_rate >= 15 Hz", '"Edge detection".A.max <= 80 ms', "memory.L2 <= 90 %"],
            "limits": ["frame_rate >= 10.98 Hz", "results.balls == 1*3 0 1*4"],
            "kernels": {"Edge detection": {"A": {"sobel_row": 1000}}},
            "measured_on": {
                "recording": "0" * 64, "frames": 8, "board": "0", "compiler": "0", "script": "", "firmware": "0", "ldf": "0",
                "bfsim_version": "0.1.0", "llvm_version": "20.1.8",
            },
        }
    ]
}  # fmt: skip
OPTIONS = (
    "--firmware", "--board", "--set", "--ldf", "-D", "-I", "--profile", "--frames", "--feed", "--script", "--fidelity", "--sanitize",
    "--json", "--features", "--show", "--overlay", "--mcap", "--core", "--top", "--baseline", "--update", "--size", "--picture",
    "--corners", "--square", "--fps", "--geometry", "--resize", "--format", "--mono", "--help", "--nonsense",
)  # fmt: skip
COMMANDS = (
    ["run"], ["profile"], ["check"], ["explain"], ["boards"], ["ldf"], ["record", "import"], ["record", "info"],
    ["record", "calibrate"], ["record"], [], ["nonsense"],
)  # fmt: skip
DATA = Path(__file__).parent.parent.parent / "tests" / "blackfin" / "data"
OBJECT_FILES = (
    ("sums.o", "sums", "row=u8[:], out=i32[:], n=i32, first=i32, result=i32"),
    ("callbacks.o", "handed_over", "values=i32[:], n=i32, result=i32"),
    ("callbacks.elf", "from_table", "which=i32[:], values=i32[:], n=i32, result=i32"),
    ("labels.o", "chosen", "x=i32, result=i32"),
    ("prototypes.o", "state_of", "state=i32, result=i32"),
)
SMALL_LDF = """ARCHITECTURE(ADSP-BF533)
#define SIZE 16K
$OBJECTS = crt.doj, $COMMAND_LINE_OBJECTS{!prefersMem("external")};
MEMORY { CODE { TYPE(RAM) START(0xFFA00000) END(0xFFA13FFF) WIDTH(8) } DATA { TYPE(RAM) START(0xFF800000) LENGTH(SIZE) WIDTH(8) } }
PROCESSOR p0 { OUTPUT(a.dxe) RESOLVE(start, 0xFFA00000) KEEP(_main)
  SECTIONS { RESERVE(r = 0xFF803F00, rl = 76)
    code { INPUT_SECTION_ALIGN(4) INPUT_SECTIONS($OBJECTS(program *_code)) } > CODE
    data { RESERVE(heap, heapl = 2K, 4) a = . + SIZEOF(code); INPUT_SECTIONS($OBJECTS(data1)) RESERVE_EXPAND(heap, heapl, 0, 4) } > DATA } }
"""


def script(random: Random, folder: Path) -> list[str]:
    """A script for the firmware's device, JSON or TOML."""
    tree = changed_tree(random, SCRIPT)
    if random.random() < 0.5:
        path, text = folder / "script.json", json.dumps(tree)
    else:
        path, text = folder / "script.toml", _toml(tree)
    path.write_text(changed_text(random, text) if random.random() < 0.3 else text, errors="surrogateescape")
    return ["run", NO_RECORDING, "--script", str(path)]


def baseline(random: Random, folder: Path) -> list[str]:
    """A baseline of `bfsim check`."""
    text = _toml(changed_tree(random, BASELINE))
    path = folder / "baseline.toml"
    path.write_text(changed_text(random, text) if random.random() < 0.3 else text, errors="surrogateescape")
    return ["check", NO_RECORDING, "--baseline", str(path), *(["--update"] if random.random() < 0.2 else [])]


def _toml(tree: object) -> str:
    try:
        return tomlkit.dumps(tree)  # type: ignore[arg-type]
    except (TypeError, ValueError):  # not everything has a name in TOML
        return str(tree)


def command_line(random: Random, folder: Path) -> list[str]:
    """Options and arguments of any command, in any order."""
    arguments = [*random.choice(COMMANDS)]
    for _ in range(random.randrange(5)):
        arguments.append(random.choice(OPTIONS) if random.random() < 0.6 else random.choice(WORDS))
        if random.random() < 0.7:
            values = (*WORDS, *map(str, NUMBERS), str(folder), str(folder / "new"), "320x240")
            arguments.append(random.choice(values))
    if arguments[:1] in (["run"], ["profile"], ["check"]):
        arguments.append(NO_RECORDING)
    return [each.replace("\0", "") for each in arguments]


def board(random: Random, _folder: Path) -> list[str]:
    """Names of boards, numbers of them, and what goes with them."""
    name = random.choice((*BOARDS, *WORDS, changed_text(random, random.choice(list(BOARDS)))))
    paths = [each.path for each in leaves(BOARDS["cm-bf561"])]
    path = random.choice((*paths, *WORDS, changed_text(random, random.choice(paths))))
    settings = (
        [f"--set={path}={random.choice((*WORDS, *map(str, NUMBERS)))}"] if random.random() < 0.7 else []
    )
    if random.random() < 0.5:
        return ["boards", *settings, "--", name]
    return [
        "run",
        NO_RECORDING,
        f"--board={name}",
        *settings,
        f"--profile={random.choice(('gcc-O2', *WORDS))}",
    ]


def ldf(random: Random, folder: Path) -> list[str]:
    """A linker description file, small or shipped, with macros."""
    sources = [SMALL_LDF] * 3 + [each.read_text() for each in sorted(shipped.LDF_FOLDER.glob("*.ldf*"))]
    path = folder / "fuzz.ldf"
    path.write_text(changed_text(random, random.choice(sources)), errors="surrogateescape")
    (folder / "self").write_text('#include "self"\n')
    macros = [f"-DSIZE={random.choice(WORDS)}"] if random.random() < 0.2 else []
    return ["ldf", str(path), "--json", *macros]


def mcap_structure(random: Random, folder: Path) -> list[str]:
    """A recording whose records say what is not so."""
    side = random.choice((2, 2, 4, 64))
    size = {
        "width": side,
        "height": side,
        "encoding": "uyvy",
        "step": 2 * side,
        "data": bytes(2 * side * side),
    }
    if random.random() < 0.5:
        size[random.choice(list(size))] = random.choice((0, 1, 2**31, "", b"", b"x", "rgb8"))
    try:
        image = attacks.RawImage(**size).SerializeToString()
    except (TypeError, ValueError):
        image = b"\xff"
    data = b"".join(
        attacks.message(
            random.choice((1, 2)) if random.random() < 0.2 else number % 2 + 1, number // 2, image
        )
        for number in range(random.choice((0, 1, 2, 4)))
    )
    compression = random.choice(("", "", "zstd", "zstd", "lz4", "x"))
    stored = zstandard.compress(data) if compression == "zstd" else data
    nbytes = random.choice((len(data), len(data), len(data), 0, 2**27, 2**63))
    chunks = [attacks.chunk(stored, nbytes=nbytes, compression=compression)] * random.choice((1, 1, 2))
    count = random.choice((0, 1, 2, 2**40))
    index = b""
    if random.random() < 0.3:
        offset = random.choice((0, 31, 2**31, 2**63 - 1, 2**63, 2**64 - 1))
        index = random.choice(
            (attacks.attachment_index("rectification_left.npy", offset), attacks.chunk_index(offset, 9))
        )
    path = attacks.write(folder / "fuzz.mcap", chunks, counts=(count, count), index=index)
    return ["record", "info", str(path)]


def mcap_bytes(random: Random, folder: Path) -> list[str]:
    """A sound recording with some of its bytes changed."""
    data = attacks.pair() + attacks.pair(1)
    path = attacks.write(folder / "fuzz.mcap", [attacks.chunk(data, nbytes=len(data))], counts=(2, 2))
    path.write_bytes(changed_bytes(random, path.read_bytes()))
    return ["record", "info", str(path), *(["--json"] if random.random() < 0.3 else [])]


def pictures(random: Random, folder: Path) -> list[str]:
    """What `bfsim record import` reads: images, raw frames, y4m, tables."""
    name = random.choice(("a.png", "a.jpg", "a.bmp", "a.uyvy", "a.i420", "a.y4m", "a.npy"))
    path, stream = folder / name, io.BytesIO()
    options: list[str] = []
    if name.endswith(("png", "jpg", "bmp")):
        Image.new("RGB", (8, 4)).save(stream, {"jpg": "JPEG"}.get(name[-3:], name[-3:].upper()))
    elif name.endswith("y4m"):
        header = f"YUV4MPEG2 W{random.choice((8, 0, *NUMBERS))} H4 F30:1 C{random.choice(('420', '444', 'mono', 'x'))}\n"
        stream.write(header.encode() + b"FRAME\n" + bytes(96))
    elif name.endswith("npy"):
        np.save(stream, np.zeros((2, 4, 8), random.choice(("<i4", "<u8", "<f4", "U3"))))
        Image.new("RGB", (8, 4)).save(folder / "b.png")
        options = ["--rectification", str(path), str(path)]
    else:
        stream.write(bytes(random.choice((64, 48, 0, 63))))
        options = ["--size", random.choice(("8x4", "7x4", "0x0", "99999999x99999999", *WORDS))]
    data = stream.getvalue()
    path.write_bytes(changed_bytes(random, data) if random.random() < 0.7 else data)
    source = str(folder / "b.png") if name.endswith("npy") else str(path)
    if random.random() < 0.3:
        options += [
            random.choice(("--fps", "--resize", "--description", "--format")),
            str(any_value(random)).replace("\0", ""),
        ]
    return ["record", "import", str(folder / "out.mcap"), source, "--mono", "--force", *options]


def object_file(random: Random, folder: Path) -> list[str]:
    """A kernel in object code, some of whose bytes are others: of the code, the tables, or what a debugger reads."""
    name, function, parameters = random.choice(OBJECT_FILES)
    (folder / name).write_bytes(changed_bytes(random, (DATA / name).read_bytes()))
    (folder / "objects.py").write_text(
        f"from bfsim.api import i32, kernel_from, u8\nfound = kernel_from({name!r}, {function!r}, {parameters})\n"
    )
    return ["explain", f"{folder}/objects.py:found", *(["--asm"] if random.random() < 0.3 else [])]


KINDS: tuple[Callable[[Random, Path], list[str]], ...] = (
    script, baseline, command_line, board, ldf, mcap_structure, mcap_bytes, pictures, object_file,
)  # fmt: skip
