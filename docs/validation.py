"""Results of the papers' figures -> docs/validation.md, its pictures in docs/figures/: `python docs/validation.py`.

Reads what `pyjkr sweep CASE -o results/validation/CASE` left for every case below. A case that is missing, unfinished or of
another sweep file is an error that names the command to type; all of them are listed before it stops.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shutil
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
RESULTS = Path("results") / "validation"
# In the order of the papers; those whose sweep file is there are shown.
CASES = (
    "haervig_fig3", "haervig_fig4", "haervig_fig5", "haervig_fig7", "haervig_fig8", "haervig_fig10", "haervig_fig11",
    "haervig_fig12", "haervig_fig13", "chen_fig2", "chen_fig4", "chen_fig5", "chen_fig7", "chen_packing",
)  # fmt: skip
PICTURES = "validation-"

HEAD = """\
# Validation

Every figure of Haervig et al. 2017 (Powder Technology 319:472) and of Chen, Liu and Li 2019 (Chem. Eng. Sci. 193:336) that the
models here can draw, and what each must show. The page is written by `python docs/validation.py` from the results of the commands
below it. **The figures show the model only**: no points of experiments and no curves of the papers are drawn, because there are
none at hand as numbers, and none were read off pictures. Where the parameters of a case come from, which misprints it steps
around and what its check means stands in its `README.md`. Times are those of the points added up, on one core each.
"""


class IncompleteError(Exception):
    """Results that cannot make a page."""


@dataclass(frozen=True)
class Case:
    """One figure of a paper: its name, where its result is, and the result."""

    name: str
    directory: Path
    result: dict[str, Any]

    @property
    def command(self) -> str:
        """What makes the result."""
        return f"pyjkr sweep {self.name} -o {RESULTS / self.name}"

    @property
    def pictures(self) -> dict[str, Path]:
        """Names beside the page, and where the pictures are."""
        return {f"{PICTURES}{self.name}-{name}": self.directory / name for name in self.result["figures"]}


def read(cases: Path, results: Path) -> list[Case]:
    """The results of all cases that have a sweep file.

    Parameters
    ----------
    cases : Path
        Directory of the cases.
    results : Path
        Directory with one result each.

    Raises
    ------
    IncompleteError
        One line for each case without a whole result of its present sweep file.
    """
    found, faults = [], []
    for name in CASES:
        file = cases / name / "sweep.toml"
        if file.is_file():
            try:
                found.append(_read(name, file, results / name))
            except IncompleteError as fault:
                faults.append(f"{name}: {fault}. Type `pyjkr sweep {name} -o {RESULTS / name}`.")
    if faults:
        raise IncompleteError("\n".join(faults))
    if not found:
        raise IncompleteError(f"{cases}: no case has a sweep.toml. Name the directory of the cases.")
    return found


def _read(name: str, file: Path, directory: Path) -> Case:
    try:
        result = json.loads((directory / "result.json").read_text(encoding="utf-8"))
        case = Case(name, directory, result)
        if result["sweep_sha256"] != hashlib.sha256(file.read_bytes()).hexdigest():
            raise IncompleteError(f"{directory} holds the result of another sweep file")
        missing = [path.name for path in case.pictures.values() if not path.is_file()]
    except (OSError, ValueError, KeyError, TypeError):
        raise IncompleteError(f"no whole result in {directory}") from None
    if missing:
        raise IncompleteError(f"{directory} has lost {missing[0]}")
    return case


def page(cases: Sequence[Case]) -> str:
    """The page in Markdown."""
    return "\n".join([HEAD, *_summary(cases), *(line for case in cases for line in _section(case))])


def _summary(cases: Sequence[Case]) -> Iterator[str]:
    yield "| case | figure | checks that hold | points | time |"
    yield "| --- | --- | --- | --- | --- |"
    for case in cases:
        checks = case.result["checks"]
        holding = sum(check["holds"] for check in checks)
        held = f"{holding} of {len(checks)}" if holding == len(checks) else f"**{holding} of {len(checks)}**"
        row = (case.name, cell(case.result["title"]), held, case.result["points"], clock(case.result["wall_time_of_points"]))
        yield "| " + " | ".join(map(str, row)) + " |"
    yield ""


def _section(case: Case) -> Iterator[str]:
    result = case.result
    yield f"## {result['title']}\n"
    yield f"    {case.command}\n"
    rows = "" if result["rows"] == result["points"] else f", {result['rows']} rows"
    took = clock(result["wall_time_of_points"])
    yield f"{result['points']} points{rows}, {took}. Parameters and sources: `cases/{case.name}/README.md`.\n"
    for name in case.pictures:
        yield f"![{cell(result['title'])}](figures/{name})\n"
    yield from _table(result.get("summary"))
    if result["checks"]:
        yield "| check | measured | wanted | |"
        yield "| --- | --- | --- | --- |"
    for check in result["checks"]:
        verdict = "holds" if check["holds"] else "**does not hold**"
        yield f"| {cell(check['name'])} | {cell(measured(check['measured']))} | {cell(check['wanted'])} | {verdict} |"
    yield ""


def _table(summary: dict[str, Any] | None) -> Iterator[str]:
    """The summary of a study that has one."""
    if summary:
        yield "| " + " | ".join(cell(str(name)) for name in summary["columns"]) + " |"
        yield "| --- " * len(summary["columns"]) + "|"
        for row in summary["data"]:
            yield "| " + " | ".join(cell(value if isinstance(value, str) else f"{value:g}") for value in row) + " |"
        yield ""


def measured(value: float | str | None) -> str:
    """A measured value for a reader."""
    return value if isinstance(value, str) else "nothing" if value is None else f"{value:.5g}"


def cell(text: str) -> str:
    """Text fit for a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def clock(seconds: float) -> str:
    """A time in the unit that suits it."""
    if seconds < 90:
        return f"{seconds:.1f} s" if seconds < 10 else f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def write(cases: Sequence[Case], file: Path) -> None:
    """Write the page, and the pictures into `figures/` beside it; pictures of an earlier page are removed."""
    figures = file.parent / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    for stale in figures.glob(f"{PICTURES}*.png"):
        stale.unlink()
    for case in cases:
        for name, path in case.pictures.items():
            shutil.copyfile(path, figures / name)
    file.write_text(page(cases), encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the page; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=ROOT / RESULTS, metavar="DIR", help=f"default: {RESULTS}")
    parser.add_argument("--cases", type=Path, default=ROOT / "cases", metavar="DIR", help="default: cases")
    default = ROOT / "docs" / "validation.md"
    parser.add_argument("-o", "--output", type=Path, default=default, metavar="FILE", help="default: docs/validation.md")
    parser.add_argument("--list", action="store_true", help="print the names of the cases and write nothing")
    options = parser.parse_args(arguments)
    if options.list:
        print(*(name for name in CASES if (options.cases / name / "sweep.toml").is_file()))
        return 0
    try:
        cases = read(options.cases, options.results)
    except IncompleteError as error:
        print(f"not complete, no page written:\n{error}", file=sys.stderr)
        return 1
    write(cases, options.output)
    print(options.output, file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
