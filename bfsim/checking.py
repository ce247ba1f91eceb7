"""The runs of a baseline file as arguments of `simulate`, and whether they are still what was measured."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bfsim import shipped
from bfsim.errors import BfsimError, ConfigError, cut, shown
from bfsim.loading.firmware import load_firmware
from bfsim.planning import identified
from bfsim.report.check.baseline import Case, Configuration, MeasuredOn, measured_on
from bfsim.report.check.baseline_file import update_command
from bfsim.report.check.judge import require_stages
from bfsim.run import Feed, Fidelity
from bfsim.running.digested_frames import recording_digest


def arguments_of(configuration: Configuration, folder: Path) -> dict[str, Any]:
    """Return the arguments of `simulate`; paths are relative to the `folder` of the baseline file."""
    given = configuration.model_dump(exclude_defaults=True)
    arguments: dict[str, Any] = {
        "firmware": shipped.FIRMWARE[0],
        "feed": Feed(configuration.feed),
        "fidelity": Fidelity(configuration.fidelity),
        "settings": configuration.set,
        "defines": configuration.define,
        "include_dirs": [folder / each for each in configuration.include],
        "frames": configuration.frames,
    }
    arguments |= {key: folder / given[key] for key in ("recording", "script") if key in given}
    arguments |= {key: _moved(given[key], folder) for key in ("firmware", "board", "profile") if key in given}
    if configuration.ldf:
        arguments["ldf"] = shipped.ldf_at(Path(configuration.ldf), folder) or folder / configuration.ldf
    return arguments


def configuration_given(given: Mapping[str, Any], folder: Path) -> Configuration:
    """Return the options as a baseline file in `folder` has them; `given` are those that are not their defaults."""
    plain = dict(given)
    for key in ("recording", "script"):
        if key in plain:
            plain[key] = _from(plain[key], folder)
    for key in ("firmware", "board", "profile"):
        place, colon, name = str(plain.get(key, "")).partition(".py")
        if colon:
            plain[key] = f"{_from(place, folder)}.py{name}"
    if "ldf" in plain:
        found = shipped.ldf_at(plain["ldf"])
        is_shipped = found is not None and found.parent == shipped.LDF_FOLDER
        plain["ldf"] = str(plain["ldf"]) if is_shipped else _from(plain["ldf"], folder)
    names = {"settings": "set", "defines": "define", "include_dirs": "include"}
    plain = {names.get(key, key): value for key, value in plain.items()}
    if "include" in plain:
        plain["include"] = [_from(each, folder) for each in plain["include"]]
    for key, value in plain.items():
        if not str(value).isascii() and str(value) != str(value).encode(errors="replace").decode():
            raise ConfigError(
                f"{key} must have a name that can be written into a baseline file, not {shown(value)}"
            )
    return Configuration.model_validate(plain)


def name_of(configuration: Configuration) -> str:
    """Return a name for a run without one: its recording, and the options that are not their defaults."""
    words = [Path(configuration.recording or shipped.RECORDING).stem]
    for key, value in configuration.model_dump(exclude_defaults=True, exclude={"recording"}).items():
        match value:
            case dict():
                words += [f"--{key} {name}={each}" for name, each in value.items()]
            case list():
                words += [f"--{key} {each}" for each in value]
            case _:
                words.append(f"--{key} {value}")
    return " ".join(words)


def require_comparable(case: Case, path: Path) -> None:
    """Read and check everything that a run needs.

    Raises ConfigError if the run differs from what its limits were measured on, lacks a stage that a limit is about, or
    is not possible.
    """
    arguments = arguments_of(case.configuration, path.parent)
    try:
        identity, frames = identified(**arguments)
    except BfsimError as error:
        raise type(error)(f"{path}: run {shown(case.name)}: {error}") from error
    if case.measured_on:
        names = {"board": identity.board, "compiler": identity.compiler, "script": case.script}
        _require_alike(case, path, case.measured_on, measured_on(identity, frames), names)
    firmware = load_firmware(arguments["firmware"]).firmware
    require_stages(case, path, [each.stage for each in firmware.rows], tuple(firmware.mains))


def require_held(case: Case, path: Path) -> None:
    """Raise ConfigError if a run has no limits: it would pass, whatever it costs."""
    if not (case.limits or case.require):
        raise ConfigError(
            f"{path}: run {shown(case.name)} must have limits or a require, but has neither; "
            f"`{update_command(path, case.name)}` measures its limits"
        )


def _require_alike(
    case: Case, path: Path, then: MeasuredOn, now: MeasuredOn, names: Mapping[str, str]
) -> None:
    """Raise ConfigError with every difference between a run and what its limits were measured on.

    `names` are those of its hardware and script.
    """
    recording = arguments_of(case.configuration, path.parent).get("recording")
    differences = [*_recording_differences(then, now, recording)]
    for key, name in names.items():
        if then.differs_in(key, now):
            differences.append(f"{key} {name} {_difference(key, then, now)}")
    if then.differs_in("code", now):
        differences.append(
            f"code was {shown(then.code)} when the limits were measured, and is now {shown(now.code)} (it comes from the "
            "compiler on the PATH or, without one, from the cache; limits of --profile gcc-O2, an estimate, need neither)"
        )
    if then.differs_in("file_compiler", now):
        differences.append(
            f"kernels in C were compiled by {shown(then.file_compiler)} when the limits were measured, and are by "
            f"{shown(now.file_compiler)} (the compiler on the PATH, or else the one whose code is kept)"
        )
    if differences:
        raise ConfigError(
            f"{path}: run {shown(case.name)}: {'; '.join(differences)}: so its limits do not apply; "
            f"`{update_command(path, case.name)}` measures them again"
        )


def _difference(key: str, then: MeasuredOn, now: MeasuredOn) -> str:
    """Say what has changed in a board, compiler or script."""
    old, new = (list(getattr(each, f"{key}_numbers", [])) for each in (then, now))
    if old == new:
        return "has changed since the limits were measured"
    had, has = (
        [each for each in one if each not in other]
        or [f"that of {one[0].removeprefix('like ')}" if one else "none of its own"]
        for one, other in ((old, new), (new, old))
    )
    return f"had {cut(', '.join(had))} when the limits were measured, and has {cut(', '.join(has))}"


def _recording_differences(then: MeasuredOn, now: MeasuredOn, recording: Path | None) -> list[str]:
    name = (recording or shipped.RECORDING).name
    if now.recording == then.recording:
        return []
    size = then.width_px, then.height_px
    if all(size) and size != (now.width_px, now.height_px):
        was, has = (f"{each.width_px}x{each.height_px} px" for each in (then, now))
        return [
            f"recording {name} must have pictures of {was}, as when the limits were measured, not of {has}"
        ]
    if now.frames != then.frames:
        has = f"recording {name} must have {then.frames} frames to run, as when the limits were measured, not {now.frames}"
        is_longer = now.frames > then.frames and recording_digest(recording, then.frames) == then.recording
        return [
            f"{has} (the first {then.frames} are the same: frames = {then.frames} runs those)"
            if is_longer
            else has
        ]
    return [f"recording {name} has other pictures or time stamps than when the limits were measured"]


def _moved(name: str, folder: Path) -> str:
    """Return FILE.py:NAME with a path from here; names of packages and shipped ones stay as they are."""
    return str(folder / name) if ".py" in name else name


def _from(path: str | Path, folder: Path) -> str:
    """Return a path relative to `folder`."""
    return Path(os.path.relpath(path, folder)).as_posix()
