"""Where the files are that come with bfsim. An installed package has all of them in it; a checkout keeps LDFs and firmware beside it."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).parent
_IS_INSTALLED = (_PACKAGE / "ldf").is_dir()

RECORDING = _PACKAGE / "recording" / "builtin" / "soccer.mcap"
LDF_FOLDER = _PACKAGE / "ldf" if _IS_INSTALLED else _PACKAGE.parent / "ldf"
FIRMWARE_FOLDER = _PACKAGE.parent if _IS_INSTALLED else _PACKAGE.parent / "firmware"
"""The folder that holds the package FIRMWARE_PACKAGE."""

FIRMWARE_PACKAGE = "tinyphoon"
FIRMWARE = ("tinyphoon", "fast", "thesis", "rectified_features", "one_eye")
"""Names in that package that `--firmware` takes alone. The first one is the default."""

ACCURACY = (_PACKAGE if _IS_INSTALLED else _PACKAGE.parent) / "docs" / "accuracy.md"
"""How far to trust the numbers: the page of the documentation."""

DEFAULT_LDFS = {"ADSP-BF561": LDF_FOLDER / "thesis.ldf", "ADSP-BF533": LDF_FOLDER / "cm-bf533.ldf"}
"""The placement of each chip."""

LDFS = tuple(sorted(each.stem for each in LDF_FOLDER.glob("*.ldf")))
"""Names that `--ldf` takes alone."""

SCENES_MODULE = "tinyphoon.scenes"
SCENES = (
    "soccer", "field-of-circles", "ball-beside-goal", "camera-initialised", "robot-marker",
    "ball-beside-robot", "hidden-ball", "ball-with-seam", "ball-too-close", "goal-sharp-angle", "thesis",
    "box-distances", "ball-distances",
)  # fmt: skip
"""Names in that module that `bfsim record render` takes alone. The first one is the scene of RECORDING."""


def accuracy_on(section: str) -> str:
    """Return a section of ACCURACY, without its heading."""
    _, _, rest = ACCURACY.read_text(encoding="utf-8").partition(f"\n## {section}\n")
    return rest.partition("\n## ")[0].strip()


def ldf_at(path: Path, folder: Path = Path()) -> Path | None:
    """Return the LDF that is meant by `path`: a file in `folder`, or by a name alone a shipped one, with or without `.ldf`.

    None where there is neither.
    """
    shipped = (LDF_FOLDER / path.name, LDF_FOLDER / f"{path.name}.ldf") if len(path.parts) == 1 else ()
    return next((each for each in (folder / path, *shipped) if _is_file(each)), None)


def _is_file(path: Path) -> bool:
    try:
        return path.exists() and not path.is_dir()
    except OSError:  # a name that is too long
        return False
