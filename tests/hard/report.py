"""Run the hard cases and write docs/hard-cases.md from the figures they measured: `python tests/hard/report.py`."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGE = HERE.parent.parent / "docs" / "hard-cases.md"

HEAD = """\
# Hard cases

Each row was measured by running LIGGGHTS with the plug-in; the page is written by `python tests/hard/report.py`, the
cases are the tests in `tests/hard/`. A figure holds when it is at most its tolerance; the reason of each tolerance
stands beside its name in the test. Where a case was run for several models or parameters the worst figure is shown.
"""


def worst_rows(rows: list[dict]) -> list[dict]:
    """One row per case and figure: the one that comes closest to its tolerance, or passes it by most."""
    kept: dict[tuple[str, str], dict] = {}
    for row in rows:
        row["case"] = row["case"].split(" [")[0]
        key = row["case"], row["what"]

        def use(row):
            return row["value"] / row["tolerance"] if row["tolerance"] else row["value"]

        if key not in kept or use(row) > use(kept[key]):
            kept[key] = {**row, "runs": kept.get(key, {}).get("runs", 0)}
        kept[key]["runs"] += 1
    return list(kept.values())


def cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def page(rows: list[dict]) -> str:
    """The Markdown page."""
    lines, group, shown = [HEAD], None, None
    for row in sorted(worst_rows(rows), key=lambda row: row["group"]):
        if row["group"] != group:
            group, shown = row["group"], None
            lines += [
                f"\n## {group}\n",
                "| case | why it is hard | figure | runs | measured | tolerance | |",
                "|---|---|---|---|---|---|---|",
            ]
        repeated = row["case"] == shown
        shown = row["case"]
        case, why = ("", "") if repeated else (cell(row["case"]), cell(row["why"]))
        verdict = "holds" if row["holds"] else "**does not hold**"
        measured, tolerance = ("0" if not row[name] else f"{row[name]:.2g}" for name in ("value", "tolerance"))
        lines.append(f"| {case} | {why} | {cell(row['what'])} | {row['runs']} | {measured} | {tolerance} | {verdict} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--figures", type=Path, help="use figures written by an earlier `pytest tests/hard --figures FILE`"
    )
    parser.add_argument("-o", "--output", type=Path, default=PAGE, help="page to write (default: docs/hard-cases.md)")
    arguments = parser.parse_args()
    status = 0
    with tempfile.TemporaryDirectory() as directory:
        figures = arguments.figures or Path(directory) / "figures.jsonl"
        if not arguments.figures:
            command = [sys.executable, "-m", "pytest", "-q", str(HERE), "--figures", str(figures)]
            status = subprocess.run(command, cwd=HERE.parent.parent, check=False).returncode
        rows = [json.loads(line) for line in figures.read_text(encoding="utf-8").splitlines()]
    arguments.output.write_text(page(rows), encoding="utf-8")
    print(arguments.output, file=sys.stderr)
    return status


if __name__ == "__main__":
    sys.exit(main())
