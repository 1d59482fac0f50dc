"""Markdown under `docs/` -> standalone HTML pages: `python docs/build.py [-o DIR]`.

Equations become MathML, pictures are put into the page: a page needs neither network nor other files. A link to a file
or heading that does not exist and an equation that does not parse are errors; all of them are listed before it stops.
"""

from __future__ import annotations

import argparse
import base64
import mimetypes
import os
import re
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from urllib.parse import unquote, urlsplit
from xml.etree import ElementTree

import jinja2
from latex2mathml.converter import convert
from markdown_it import MarkdownIt
from markdown_it.token import Token
from mdit_py_plugins.anchors import anchors_plugin
from mdit_py_plugins.dollarmath import dollarmath_plugin

SOURCE = Path(__file__).resolve().parent

_MATHML = "http://www.w3.org/1998/Math/MathML"
# How many parts an element of MathML must have: latex2mathml leaves out what it did not find.
_PARTS = {"mfrac": 2, "msub": 2, "msup": 2, "mover": 2, "munder": 2, "mroot": 2, "msubsup": 3, "munderover": 3}
# Browsers take no other variant than "normal": bold letters are characters of their own.
_BOLD = {
    "bold": (0x1D400, 0x1D41A, 0x1D6C2),
    "bold-italic": (0x1D468, 0x1D482, 0x1D736),
}

_FRAME = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined).from_string("""\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{{ title }}</title>
<style>
:root { color-scheme: light dark; --edge: #8884; --shade: #8881; --link: #1a5fb4; }
@media (prefers-color-scheme: dark) { :root { --link: #8ab4f8; } }
body { margin: 0; font: 16px/1.55 system-ui, sans-serif; }
nav { padding: .6rem 1rem; border-bottom: 1px solid var(--edge); background: var(--shade); }
nav a, nav b { display: inline-block; margin-right: 1.1rem; }
main { max-width: 52rem; margin: 0 auto; padding: 0 1rem 4rem; }
a { color: var(--link); text-decoration: none; }
a:hover { text-decoration: underline; }
h1, h2, h3 { line-height: 1.25; margin: 2em 0 .6em; }
h1 { margin-top: 1.2em; }
h2 { border-bottom: 1px solid var(--edge); padding-bottom: .2em; }
code, pre { font: .875em/1.45 ui-monospace, "DejaVu Sans Mono", monospace; }
code { background: var(--shade); padding: .1em .25em; border-radius: 3px; }
pre { background: var(--shade); border: 1px solid var(--edge); border-radius: 4px;
  padding: .7rem .9rem; overflow-x: auto; }
pre code { background: none; padding: 0; font-size: 1em; }
.table { overflow-x: auto; margin: 1em 0; }
table { border-collapse: collapse; font-size: .94em; }
th, td { border: 1px solid var(--edge); padding: .3em .6em; text-align: left; vertical-align: top; }
th { background: var(--shade); }
math { font-family: "Latin Modern Math", "STIX Two Math", "Cambria Math", math; }
.equation { overflow-x: auto; margin: 1em 0; padding: .2em 0; }
img { max-width: 100%; }
</style>
</head>
<body>
<nav>
{% for page in pages -%}
{% if page.here %}<b>{{ page.title }}</b>{% else %}<a href="{{ page.href }}">{{ page.title }}</a>{% endif %}
{% endfor -%}
</nav>
<main>
{{ body | safe }}</main>
</body>
</html>
""")


class BuildError(Exception):
    """The pages cannot be built; one line for each mistake: file, line, what to change."""


class EquationError(ValueError):
    """An equation that does not parse."""


@dataclass
class Page:
    """One Markdown file."""

    source: Path
    output: Path                # relative to the output directory
    tokens: list[Token]
    title: str
    anchors: set[str] = field(default_factory=set)


def build(source: Path, output: Path) -> list[Path]:
    """Render every Markdown file below a directory.

    Parameters
    ----------
    source
        Directory of the Markdown files.
    output
        Directory for the pages, in the same order of folders.

    Returns
    -------
    list of Path
        The pages.

    Raises
    ------
    BuildError
        A broken link or picture, or an equation that does not parse; nothing is written then.
    """
    source, output = source.resolve(), output.resolve()
    markdown = _markdown()
    files = sorted(path for path in source.rglob("*.md") if output not in path.parents)
    pages = {path: _read(path, source, markdown) for path in files}
    mistakes: list[str] = []
    attachments: set[Path] = set()
    for page in pages.values():
        mistakes += _settle(page, pages, source, output, attachments)
    if mistakes:
        raise BuildError("\n".join(mistakes))

    written = []
    for page in pages.values():
        folder = (output / page.output).parent
        links = [
            {"title": other.title, "href": os.path.relpath(output / other.output, folder), "here": other is page}
            for other in pages.values()
        ]
        folder.mkdir(parents=True, exist_ok=True)
        body = markdown.renderer.render(page.tokens, markdown.options, {})
        html = _FRAME.render(title=page.title, pages=links, body=body)
        (output / page.output).write_text(html, encoding="utf-8")
        written.append(output / page.output)
    for attachment in sorted(attachments):
        copy = output / attachment.relative_to(source)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(attachment, copy)
    return written


def mathml(latex: str, *, display: bool) -> str:
    """An equation as MathML.

    Parameters
    ----------
    latex
        The equation, without dollar signs.
    display
        On a line of its own.

    Raises
    ------
    EquationError
        It does not parse, with the reason.
    """
    depth = 0
    for brace in re.findall(r"(?<!\\)[{}]", latex):
        depth += 1 if brace == "{" else -1
        if depth < 0:
            break
    if depth:
        raise EquationError("braces { } do not pair")
    try:
        root = ElementTree.fromstring(convert(latex, display="block" if display else "inline"))
    except ElementTree.ParseError:
        raise EquationError("'&' or an environment that is not known") from None
    except Exception as error:  # latex2mathml has a dozen classes, and lets IndexError and KeyError through
        raise EquationError(str(error) or type(error).__name__) from None
    bars = 0
    for element in root.iter():
        name = element.tag.removeprefix(f"{{{_MATHML}}}")
        if "\\" in (element.text or ""):
            raise EquationError(f"command {element.text} is not known")
        if len(element) != _PARTS.get(name, len(element)):
            raise EquationError(f"an argument is missing ({name} has {len(element)} of {_PARTS[name]})")
        if starts := _BOLD.get(element.get("mathvariant", "")):
            element.text = "".join(_bold(letter, *starts) for letter in element.text or "")
            del element.attrib["mathvariant"]
        if name == "mo" and element.text == "|" and "form" not in element.attrib:
            # \lvert and \rvert come out alike, and an operator without a form is set apart from what it encloses
            element.set("form", "postfix" if bars % 2 else "prefix")
            element.set("stretchy", "false")
            bars += 1
    ElementTree.register_namespace("", _MATHML)
    return ElementTree.tostring(root, encoding="unicode")


def _bold(letter: str, upper: int, lower: int, greek: int) -> str:
    for first, last, start in (("A", "Z", upper), ("a", "z", lower), ("Α", "Ω", greek - 26), ("α", "ω", greek)):
        if first <= letter <= last:
            return chr(start + ord(letter) - ord(first))
    return letter


# --- one page ---------------------------------------------------------------------------------------------------------


def _markdown() -> MarkdownIt:
    markdown = MarkdownIt("commonmark", {"html": False}).enable("table")
    markdown.use(dollarmath_plugin, allow_space=False, double_inline=False)
    markdown.use(anchors_plugin, max_level=4)
    rules: dict[str, Callable[..., str]] = {
        "math_inline": lambda _, tokens, at, *rest: tokens[at].content,
        "math_block": lambda _, tokens, at, *rest: f'<div class="equation">{tokens[at].content}</div>\n',
        "table_open": lambda *rest: '<div class="table"><table>\n',
        "table_close": lambda *rest: "</table></div>\n",
    }
    for name, rule in rules.items():
        markdown.add_render_rule(name, rule)
    return markdown


def _read(path: Path, source: Path, markdown: MarkdownIt) -> Page:
    tokens = markdown.parse(path.read_text(encoding="utf-8"))
    title = path.stem
    anchors = set()
    for token, content in pairwise(tokens):
        if token.type != "heading_open":
            continue
        anchors.add(str(token.attrs.get("id", "")))
        if token.tag == "h1" and title == path.stem:
            title = "".join(child.content for child in content.children or [])
    return Page(path, path.relative_to(source).with_suffix(".html"), tokens, title, anchors)


def _settle(
    page: Page, pages: dict[Path, Page], source: Path, output: Path, attachments: set[Path]
) -> Iterator[str]:
    """Turn a page's links, pictures and equations into what the browser needs; yields the mistakes."""
    for token, line in _all_tokens(page.tokens):
        where = f"{page.source}:{line}"
        if token.type in ("math_inline", "math_block"):
            try:
                token.content = mathml(token.content.strip(), display=token.type == "math_block")
            except EquationError as error:
                yield f"{where}: equation {token.content.strip()}: {error}"
        elif token.type == "text" and "$" in token.content:
            yield f"{where}: a dollar sign without its partner in: {token.content.strip()}"
        elif token.type == "link_open":
            yield from _settle_link(token, where, page, pages, source, output, attachments)
        elif token.type == "image":
            address = str(token.attrs["src"])
            if urlsplit(address).scheme:
                yield f"{where}: picture {address} needs a network. Store it under {source.name}/ and name the file"
                continue
            picture = page.source.parent / unquote(address)
            kind = mimetypes.guess_type(picture.name)[0]
            if not picture.is_file() or kind is None:
                yield f"{where}: picture {address}: no such picture. Correct the path; it is relative to the page"
                continue
            token.attrs["src"] = f"data:{kind};base64,{base64.b64encode(picture.read_bytes()).decode()}"


def _settle_link(
    token: Token, where: str, page: Page, pages: dict[Path, Page], source: Path, output: Path, attachments: set[Path]
) -> Iterator[str]:
    address = str(token.attrs["href"])
    parts = urlsplit(address)
    if parts.scheme or parts.netloc:
        return
    target = (page.source.parent / unquote(parts.path)).resolve() if parts.path else page.source
    if not target.exists():
        yield f"{where}: link {address}: no such file. Correct the path; it is relative to the page"
        return
    if other := pages.get(target):
        if parts.fragment and unquote(parts.fragment) not in other.anchors:
            headings = ", ".join(sorted(other.anchors))
            yield f"{where}: link {address}: {other.source.name} has no such heading. It has: {headings}"
            return
        destination = output / other.output
    elif target.is_file() and source in target.parents:
        attachments.add(target)
        destination = output / target.relative_to(source)
    else:
        destination = target  # a file of the source tree: found as long as the pages stay where they were built
    href = os.path.relpath(destination, (output / page.output).parent) if parts.path else ""
    token.attrs["href"] = href + (f"#{parts.fragment}" if parts.fragment else "")


def _all_tokens(tokens: Sequence[Token]) -> Iterator[tuple[Token, int]]:
    """Tokens with the line on which their block begins; children follow their parents."""
    line = 1
    for token in tokens:
        if token.map:
            line = token.map[0] + 1
        yield token, line
        within = line
        for child in token.children or []:
            yield child, within
            within += child.type in ("softbreak", "hardbreak")


# --- command line -----------------------------------------------------------------------------------------------------


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description="Render the Markdown pages under docs/ to HTML that needs no network.",
        epilog="example: python docs/build.py -o build/docs",
    )
    parser.add_argument(
        "-o", "--output", type=Path, default=SOURCE.parent / "build" / "docs", metavar="DIR", help="default: build/docs"
    )
    output = parser.parse_args(arguments).output
    try:
        pages = build(SOURCE, output)
    except BuildError as error:
        print(error, file=sys.stderr)
        return 2
    print(f"{len(pages)} pages in {output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
