"""The page of the papers' figures: made of whole results only, each of the present sweep file."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parent.parent


def _load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"docs_{name}", ROOT / "docs" / f"{name}.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


validation = _load("validation")


def add(directory: Path, name: str, *checks: dict) -> Path:
    """A case and its result, as `pyjkr sweep` leaves it."""
    sweep = directory / "cases" / name / "sweep.toml"
    result = directory / "results" / name
    for path in (sweep.parent, result):
        path.mkdir(parents=True)
    sweep.write_text(f'title = "{name}"\n')
    (result / "curve.png").write_bytes(b"a picture")
    content = {
        "title": f"The figure | of {name}",
        "sweep_sha256": hashlib.sha256(sweep.read_bytes()).hexdigest(),
        "points": 7,
        "rows": 7,
        "wall_time_of_points": 125.0,
        "checks": list(checks),
        "summary": {"columns": ["series", "phi | mean"], "data": [["S", 0.25]]},
        "figures": ["curve.png"],
    }
    (result / "result.json").write_text(json.dumps(content))
    return result


def build(directory: Path) -> int:
    places = ["--cases", directory / "cases", "--results", directory / "results", "-o", directory / "docs" / "page.md"]
    (directory / "docs").mkdir(exist_ok=True)
    return validation.main([str(word) for word in places])


HOLDS = {"name": "slope", "measured": 2.4999876, "wanted": "2.5 +- 0.002", "holds": True}
FAILS = {"name": "spread | worst", "measured": None, "wanted": "<= 1e-6", "holds": False}


def test_the_page_shows_every_case_with_command_figure_and_checks(tmp_path):
    # chen before haervig by name; the papers' order is the other one.
    add(tmp_path, "chen_fig4", HOLDS, FAILS)
    add(tmp_path, "haervig_fig11", HOLDS)
    stale = tmp_path / "docs" / "figures" / "validation-gone-curve.png"
    kept = stale.with_name("cost-steps.png")
    stale.parent.mkdir(parents=True)
    for picture in (stale, kept):
        picture.touch()
    assert build(tmp_path) == 0
    text = (tmp_path / "docs" / "page.md").read_text()
    assert text.index("haervig_fig11") < text.index("chen_fig4")
    assert "    pyjkr sweep chen_fig4 -o results/validation/chen_fig4\n" in text
    assert "![The figure \\| of chen_fig4](figures/validation-chen_fig4-curve.png)" in text
    assert "| slope | 2.5 | 2.5 +- 0.002 | holds |" in text
    assert "| spread \\| worst | nothing | <= 1e-6 | **does not hold** |" in text
    assert "| chen_fig4 | The figure \\| of chen_fig4 | **1 of 2** | 7 | 2 min |" in text
    assert "| series | phi \\| mean |\n| --- | --- |\n| S | 0.25 |\n" in text
    pictures = sorted(path.name for path in stale.parent.iterdir())
    assert pictures == ["cost-steps.png", "validation-chen_fig4-curve.png", "validation-haervig_fig11-curve.png"]


@pytest.mark.parametrize("damage", ["no result", "cut result", "no picture", "other sweep file"])
def test_a_result_that_is_not_whole_makes_no_page(tmp_path, capsys, damage):
    add(tmp_path, "haervig_fig12", HOLDS)
    result = add(tmp_path, "haervig_fig11", HOLDS)
    if damage == "no result":
        (result / "result.json").unlink()
    elif damage == "cut result":
        (result / "result.json").write_text('{"title": "The')
    elif damage == "no picture":
        (result / "curve.png").unlink()
    else:
        (tmp_path / "cases" / "haervig_fig11" / "sweep.toml").write_text("title = 'changed since'\n")
    assert build(tmp_path) == 1
    error = capsys.readouterr().err
    assert "Type `pyjkr sweep haervig_fig11 -o results/validation/haervig_fig11`." in error
    assert "haervig_fig12" not in error
    assert not (tmp_path / "docs" / "page.md").exists()


def test_every_case_of_the_papers_is_on_the_page():
    there = {path.parent.name for path in (ROOT / "cases").glob("*/sweep.toml")}
    assert {"haervig_fig11", "haervig_fig12"} <= there
    # All of table 1 takes many times as long; the page shows the part that answers the question.
    assert there - set(validation.CASES) <= {"chen_packing_full"}


def test_the_page_becomes_html(tmp_path):
    for package in ("markdown_it", "mdit_py_plugins", "latex2mathml"):
        pytest.importorskip(package, reason="the manual pages need: pip install '.[docs]'")
    add(tmp_path, "haervig_fig11", HOLDS)
    assert build(tmp_path) == 0
    assert _load("build").build(tmp_path / "docs", tmp_path / "html") is not None
