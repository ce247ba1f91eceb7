"""The option `--json`, and printing or writing the JSON."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import click

from bfsim.errors import shown

STDOUT = Path("-")
"""The file that stands for standard output: it gets the JSON in place of the report."""
SUFFIX = ".json"
"""How other files must end, so that a recording after `--json` by mistake is never overwritten."""


class _JsonFile(click.ParamType[Path]):
    """A file *.json, or standard output."""

    name = "FILE.json"

    def convert(self, value: str | Path, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        path = Path(value)
        if path != STDOUT and path.suffix.lower() != SUFFIX:
            self.fail(
                f"must be followed by a FILE{SUFFIX} to write, not {shown(str(value))}; to print the JSON, put --json last",
                param,
                ctx,
            )
        return path


class _JsonOption(click.Option):
    """Gives a hint if it has taken the file that the command lacks."""

    def handle_parse_result(
        self, ctx: click.Context, opts: Mapping[str, Any], args: list[str]
    ) -> tuple[Any, list[str]]:
        done = super().handle_parse_result(ctx, opts, args)
        file = opts.get(self.name)
        missing = [
            each.human_readable_name
            for each in ctx.command.params
            if isinstance(each, click.Argument) and each.required and not isinstance(opts.get(each.name), str)
        ]
        if isinstance(file, str) and file != str(STDOUT) and missing:
            raise click.BadParameter(
                f"has taken {shown(file)} as the file to write, and {' and '.join(missing)} must be given, too; to print the "
                "JSON, put --json last",
                ctx=ctx,
                param=self,
            )
        return done


def json_option(what: str) -> Callable[[Any], Any]:
    """Return the option `--json [FILE.json]`, which is `json_path` to the command; `what` stands in its help.

    It is `STDOUT` without a file, and None if the option is not given.
    """
    return click.option(
        "--json",
        "json_path",
        cls=_JsonOption,
        metavar=f"[FILE{SUFFIX}]",
        is_flag=False,
        flag_value=str(STDOUT),
        type=_JsonFile(),
        help=f"Print {what} as JSON, and nothing else; with FILE{SUFFIX}, write it there and print the report as well.",
    )


def require_json_place(path: Path | None, others: Iterable[Path | None] = ()) -> None:
    """Raise ConfigError unless JSON can be written to `path`, if given, and `path` is none of the `others`."""
    from bfsim.files.outputs import JSON, require_own
    from bfsim.files.save import require_apart, require_place

    if path and path != STDOUT:
        require_place(path)
        require_apart(path, others)
        require_own(path, JSON)


def tell(
    path: Path | None,
    chunks: Callable[[], Iterable[str]],
    show: Callable[[], None],
    write: Callable[[], None] = lambda: None,
) -> None:
    """Print the `chunks` of the JSON, if `path` is `STDOUT`; or write them to `path`, if there is one, and `show` the report.

    `write` writes other files. If something cannot be written, the error comes after the report, which took longer to
    make.
    """
    from bfsim.files.save import write_text

    with ExitStack() as last:  # the reader may go away
        last.callback(show if path != STDOUT else lambda: _print(chunks()))
        write()
        if path and path != STDOUT:
            write_text(path, chunks())


def _print(chunks: Iterable[str]) -> None:
    for chunk in chunks:
        click.echo(chunk, nl=False)
