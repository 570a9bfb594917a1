"""Templates of reports and exports."""

from __future__ import annotations

from functools import cache
from typing import Any

from .escapes import c_comment, markdown_text, script_json, tex_text, yaml_text

_TEX_MARKS: dict[str, Any] = {  # because LaTeX uses braces and per cent signs itself
    "block_start_string": "<%",
    "block_end_string": "%>",
    "variable_start_string": "<<",
    "variable_end_string": ">>",
    "comment_start_string": "<#",
    "comment_end_string": "#>",
}


def render(name: str, /, **values: Any) -> str:
    """The template `name`.jinja filled in. HTML is escaped automatically, other languages by their filters."""
    return str(_environment(name.endswith(".tex")).get_template(f"{name}.jinja").render(**values))


def undefined_error() -> type[Exception]:
    """The error for a missing value of a template."""
    from jinja2 import UndefinedError

    return UndefinedError


@cache
def _environment(tex: bool) -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

    environment = Environment(
        loader=PackageLoader("gaincert.reports"),
        autoescape=select_autoescape(("html.jinja",), default_for_string=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        **(_TEX_MARKS if tex else {}),
    )
    environment.filters.update(c=c_comment, yaml=yaml_text, tex=tex_text, md=markdown_text, script=script_json)
    return environment
