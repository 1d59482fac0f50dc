"""The environment in which all decks are rendered: where templates are, how numbers and free text are written.

Covers no law. A name that a template asks for and nobody gives is an error.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jinja2

from pyjkr import resources


def environment(number: Callable[[Any], Any] | None = None) -> jinja2.Environment:
    """Jinja's environment with the templates of `templates/` and the filter `plain`.

    Parameters
    ----------
    number : callable, optional
        Value of an expression -> what is written; None writes floats so that they read back as the same double.
    """
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(resources.directory("templates")),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        finalize=number or exact,
    )
    made.filters["plain"] = plain
    return made


def exact(value: Any) -> Any:
    """Floats as text that reads back as the same double, without the sign of zero; anything else as it is."""
    return repr(float(value) + 0.0) if isinstance(value, float) else value


def plain(text: object) -> str:
    """Text fit for a LIGGGHTS comment: one line, without the sign `&` that would continue it on the next."""
    return "".join(letter if letter.isprintable() else "?" for letter in str(text)).replace("&", "+")
