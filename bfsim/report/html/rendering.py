"""From templates to pages: what all pages share. Nothing that a page shows can become markup or reach the network."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markdown_it import MarkdownIt
from markupsafe import Markup, escape

from bfsim.report.wording.units import counted, size


def rendered(template: str, content: Mapping[str, Any]) -> Iterator[str]:
    """Yield a page as HTML, piece by piece."""
    environment = Environment(
        loader=PackageLoader("bfsim.report.html"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "size": size,
        "counted": counted,
        "share": lambda part: f"{100 * part:.1f}",
        "with_code": with_code,
    }
    environment.globals["file"] = lambda name: _file(environment, name)
    return environment.get_template(template).generate(content)


def html_of(markdown: str) -> Markup:
    """Return Markdown as HTML without links, since the page stands by itself."""
    html: str = MarkdownIt("commonmark", {"html": False}).disable("link").render(markdown)
    return Markup(html)  # noqa: S704 - without HTML of its own


def with_code(sentence: str) -> Markup:
    """Return a sentence as HTML, with text between backticks, as in a terminal, as code."""
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(sentence))))  # noqa: S704 - escaped


def data_of(value: object) -> Markup:
    """Return data for a script element: no text in it can end the element."""
    return Markup(json.dumps(value, separators=(",", ":")).replace("<", "\\u003c"))  # noqa: S704 - escaped


def script_of(library: str) -> Markup:
    """Return a library's script for a script element."""
    return Markup(library.replace("</script", "<\\/script"))  # noqa: S704 - a library's


def _file(environment: Environment, name: str) -> Markup:
    """Return a file that lies beside the templates, unchanged."""
    assert environment.loader
    return Markup(environment.loader.get_source(environment, name)[0])  # noqa: S704 - ours
