"""The manual pages: they build, they name everything that the C++ registers, and their examples run in LIGGGHTS."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType

import pytest

from pyjkr.errors import RunError
from pyjkr.run import Simulator, run_deck

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
STYLES = DOCS / "styles"
SOURCE = ROOT / "liggghts_src"

for package in ("markdown_it", "mdit_py_plugins", "latex2mathml"):
    pytest.importorskip(package, reason="the manual pages need: pip install '.[docs]'")

# Printed numbers against a run on another machine: the last digits of a number near zero are round-off.
PRINTED = 1e-3

EXAMPLE = re.compile(r"^```liggghts\n(.*?)^```", re.MULTILINE | re.DOTALL)
OUTPUT = re.compile(r"^```output\n(.*?)^```", re.MULTILINE | re.DOTALL)


def _load_builder() -> ModuleType:
    spec = importlib.util.spec_from_file_location("docs_build", DOCS / "build.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


docs_build = _load_builder()


# --- what the C++ knows -----------------------------------------------------------------------------------------------


def _sources() -> dict[str, str]:
    return {path.name: path.read_text() for path in sorted(SOURCE.rglob("*")) if path.suffix in (".h", ".cpp")}


def _all(pattern: str, text: str) -> list[str]:
    found = re.findall(pattern, text)
    assert found, f"nothing in the C++ looks like {pattern}: the source has changed, adapt this test"
    return found


def _pages_of_styles() -> list[str]:
    """Page names of all styles that register.cpp adds."""
    text = _sources()["register.cpp"]
    constants = dict(re.findall(r'(k\w+) = "([^"]+)"', text))
    structs = dict(re.findall(r'struct (\w+) \{[^}]*?name = "([^"]+)"', text))
    pages = []
    for slot, prefix in (("Normal", "model"), ("Tangential", "tangential"), ("Rolling", "rolling_friction")):
        for argument in _all(rf"\.add{slot}Model\((\w+)", text):
            name = structs.get(argument) or constants[argument]
            pages.append(f"gran_{prefix}_{name.replace('/', '_')}.md")
    return pages


def _pages_of_header(header: str) -> list[str]:
    models = ["gran_model_jkr.md", "gran_model_jkr_simplified.md"]
    return {
        "contact_model.h": models,
        "normal_model_jkr.h": models,
        "tangential_model_jkr.h": ["gran_tangential_jkr.md"],
        "rolling_model_krijt.h": ["gran_rolling_friction_krijt.md"],
    }[header]


def _keywords() -> list[tuple[str, str, str]]:
    """(header, keyword, default) of every setting."""
    keywords = []
    for header, text in _sources().items():
        for name, default in re.findall(r'registerOnOff\("(\w+)", \w+(?:, (true|false))?\)', text):
            keywords.append((header, name, "on" if default == "true" else "off"))
        for name, default in re.findall(r'registerDoubleSetting\("(\w+)", \w+, ([\d.e+-]+)\)', text):
            keywords.append((header, name, f"{float(default):g}"))
    assert len(keywords) >= 6
    return keywords


def _properties() -> set[str]:
    return set(_all(r'\b(?:require|find)\("(\w+)", Kind::', _sources()["material_table.cpp"]))


def _page(name: str) -> str:
    return (STYLES / name).read_text(encoding="utf-8")


def _rows(page: str) -> dict[str, str]:
    """Rows of the tables whose first cell is a single word of code."""
    return {m[1]: m[0] for m in re.finditer(r"^\| `(\w+)` \|.*$", page, re.MULTILINE)}


def test_every_style_has_a_page_that_the_index_links() -> None:
    for name in _pages_of_styles():
        assert (STYLES / name).is_file(), f"register.cpp adds a style without {name}"
        assert f"]({name})" in _page("index.md")


def test_every_keyword_stands_with_its_default_on_its_page_and_in_the_index() -> None:
    for header, keyword, default in _keywords():
        for name in [*_pages_of_header(header), "index.md"]:
            row = _rows(_page(name)).get(keyword)
            assert row, f"{name} has no table row for the keyword {keyword}"
            assert f"| `{default}` |" in row, f"{name}: {keyword} is {default} by default: {row}"


def test_every_property_stands_in_the_index_and_on_a_page_and_no_other_does() -> None:
    index = _rows(_page("index.md"))
    kinds = dict(re.findall(r'(?:require|find)\("(\w+)", Kind::(per_\w+)', _sources()["material_table.cpp"]))
    kind_words = {"per_pair": "peratomtypepair", "per_type": "peratomtype"}
    on_pages: set[str] = set()
    for path in STYLES.glob("*.md"):
        rows = {name: row for name, row in _rows(_page(path.name)).items() if "| peratomtype" in row}
        for name, row in rows.items():
            assert name in kinds, f"{path.name} names a property that the C++ does not read: {name}"
            assert f"| {kind_words[kinds[name]]} |" in row, f"{path.name}: wrong kind: {row}"
        if path.name != "index.md":
            on_pages |= rows.keys()
    assert _properties() <= index.keys()
    assert _properties() <= on_pages


def test_every_history_value_stands_on_its_page() -> None:
    for header, text in _sources().items():
        for value in re.findall(r'add_history_value\("(\w+)"', text):
            # the models share one list of values, in which only the full law has a neck
            pages = ["gran_model_jkr.md"] if value == "jkr_contact" else _pages_of_header(header)
            for name in pages:
                assert f"`{value}`" in _page(name)


def test_every_page_has_the_sections_of_a_liggghts_manual_page() -> None:
    for name in _pages_of_styles():
        headings = re.findall(r"^## (.*)$", _page(name), re.MULTILINE)
        assert headings == [
            "Syntax",
            "Example",
            "Description",
            "Properties",
            "Restrictions",
            "Numerics",
            "Related",
            "Literature",
        ], name


# --- pages ------------------------------------------------------------------------------------------------------------


class _Links(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.hrefs: list[str] = []
        self.loaded: list[str] = []
        self.equations = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        named = dict(attrs)
        self.equations += tag == "math"
        if named.get("id"):
            self.ids.add(named["id"] or "")
        if tag == "a":
            self.hrefs.append(named["href"] or "")
        elif tag in ("img", "script", "link", "iframe"):
            self.loaded.append(named.get("src") or named.get("href") or "")


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, _Links]:
    output = tmp_path_factory.mktemp("pages")
    pages = {}
    for path in docs_build.build(DOCS, output):
        pages[path] = _Links()
        pages[path].feed(path.read_text(encoding="utf-8"))
    return pages


def test_every_markdown_file_becomes_a_page_with_its_equations(built: dict[Path, _Links]) -> None:
    assert {path.stem for path in built} == {path.stem for path in DOCS.rglob("*.md")}
    for path, links in built.items():
        if path.name.startswith("gran_"):
            assert links.equations > 10, path.name
            assert "$" not in path.read_text(encoding="utf-8")


def test_built_pages_link_to_pages_and_headings_that_exist(built: dict[Path, _Links]) -> None:
    for path, links in built.items():
        for href in links.hrefs:
            if re.match(r"[a-z]+:", href):
                continue
            name, _, anchor = href.partition("#")
            target = (path.parent / name).resolve() if name else path
            assert target.exists(), f"{path.name}: {href}"
            assert not anchor or anchor in built[target].ids, f"{path.name}: {href}"


def test_built_pages_load_nothing_from_elsewhere(built: dict[Path, _Links]) -> None:
    for path, links in built.items():
        assert all(address.startswith("data:") for address in links.loaded), path.name


@pytest.mark.parametrize(
    ("markdown", "message"),
    [
        ("[x](nowhere.md)", r"a\.md:3: link nowhere\.md: no such file"),
        ("[x](#nothing)", r"a\.md:3: link #nothing: a\.md has no such heading. It has: title"),
        ("![x](no.png)", r"a\.md:3: picture no\.png: no such picture"),
        ("![x](https://example.org/x.png)", r"a\.md:3: picture .* needs a network"),
        (r"$\frac{1}{2$", r"a\.md:3: equation .*: braces"),
        (r"$\fraction{1}{2}$", r"a\.md:3: equation .*: command \\fraction is not known"),
        (r"$\frac{1}$", r"a\.md:3: equation .*: an argument is missing"),
        ("$x_$", r"a\.md:3: equation"),
        ("$a_b_c$", r"a\.md:3: equation"),
        ("$a & b$", r"a\.md:3: equation"),
        ("costs $x more", r"a\.md:3: a dollar sign without its partner"),
    ],
)
def test_broken_markdown_is_refused_with_file_and_line(tmp_path: Path, markdown: str, message: str) -> None:
    source = tmp_path / "docs"
    source.mkdir()
    (source / "a.md").write_text(f"# Title\n\n{markdown}\n")
    with pytest.raises(docs_build.BuildError, match=message):
        docs_build.build(source, tmp_path / "html")
    assert not (tmp_path / "html").exists()


def test_bold_letters_of_equations_become_characters_that_browsers_draw() -> None:
    assert "\N{MATHEMATICAL BOLD SMALL N}" in docs_build.mathml(r"\mathbf{n}", display=False)
    assert "\N{MATHEMATICAL BOLD ITALIC SMALL OMEGA}" in docs_build.mathml(r"\boldsymbol{\omega}", display=False)


def test_command_line_builds_into_the_directory_it_is_given(tmp_path: Path) -> None:
    command = [sys.executable, str(DOCS / "build.py"), "-o", str(tmp_path / "html")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert str(tmp_path / "html") in done.stdout
    assert (tmp_path / "html" / "styles" / "index.html").is_file()


# --- examples ---------------------------------------------------------------------------------------------------------


@pytest.mark.liggghts
@pytest.mark.parametrize("name", ["index.md", *_pages_of_styles()])
def test_example_runs_in_liggghts_and_prints_what_the_page_shows(name: str, plugin: Simulator, tmp_path: Path) -> None:
    page = _page(name)
    decks, outputs = EXAMPLE.findall(page), OUTPUT.findall(page)
    assert len(decks) == 1 and len(outputs) == 1, f"{name} must show one deck and its output"
    deck = tmp_path / "in.example"
    deck.write_text(decks[0])
    run = run_deck(deck, progress=False, simulator=plugin, timeout=60)

    header, *rows = [line.split() for line in outputs[0].splitlines()]
    log = [line.split() for line in run.log.read_text(errors="replace").splitlines()]
    printed = {words[0]: words for words in log if len(words) == len(header) and words[0].isdigit()}
    assert header[0] == "Step" and header in log
    for column in range(1, len(header)):
        scale = max(abs(float(row[column])) for row in rows)
        for row in rows:
            assert float(printed[row[0]][column]) == pytest.approx(float(row[column]), rel=0, abs=PRINTED * scale), row


@pytest.mark.liggghts
@pytest.mark.parametrize(
    ("style", "values"),
    [
        ("model jkr tangential jkr rolling_friction krijt twisting on", 3 + 3 + 1 + 1 + 3 + 1),
        ("model jkr tangential history rolling_friction epsd2 eventCorrection off", 3 + 3 + 1),
        ("model jkr/simplified tangential no_history rolling_friction krijt", 3 + 1),
        ("model jkr/simplified", 1),
    ],
)
def test_history_has_as_many_values_as_the_index_lists(
    style: str, values: int, plugin: Simulator, tmp_path: Path
) -> None:
    _run_with_history_column(style, values, plugin, tmp_path)
    with pytest.raises(RunError, match="accessed out-of-range"):
        _run_with_history_column(style, values + 1, plugin, tmp_path)


def _run_with_history_column(style: str, column: int, plugin: Simulator, directory: Path) -> None:
    example = EXAMPLE.findall(_page("index.md"))[0]
    before = example[: example.index("# columns")]
    before = re.sub(r"^pair_style .*$", f"pair_style gran {style}", before, flags=re.MULTILINE)
    before = re.sub(r"^fix floor .*&\n.*$", "", before, flags=re.MULTILINE)
    rolling = "fix rolling all property/global coefficientRollingFriction peratomtypepair 1 0.2"
    # force comes first, three columns
    contacts = f"compute c all pair/gran/local history force\ndump d all local 1 d.txt c_c[1] c_c[{3 + column}]"
    deck = directory / "in.history"
    deck.write_text(before.replace("pair_style", f"{rolling}\npair_style") + contacts + "\nrun 0\n")
    run_deck(deck, progress=False, simulator=plugin, timeout=60)
