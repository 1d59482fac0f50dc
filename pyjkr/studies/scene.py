"""A scene of the user's own at many values of its keys: every combination planned, run and set beside the oracle.

Covers what `pyjkr run` covers, for a full product of values. A point carries its whole scene, so that it can be evaluated
on a machine that has none of the files.
"""

from __future__ import annotations

import itertools
import json
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator
from pydantic import BaseModel, ConfigDict, Field, ValidationError, ValidationInfo, field_validator

from pyjkr import campaign, compare, plot, resources
from pyjkr.case import Plan
from pyjkr.errors import PyjkrError, SceneError
from pyjkr.plan import plan
from pyjkr.run import find_simulator
from pyjkr.scene import Scene
from pyjkr.scene_errors import explain
from pyjkr.studies.check import Check
from pyjkr.studies.impacts import Nobody

VERSION = 1

SPEEDS = "impact.speeds"
# What `compare` knows of a case and a row keeps.
COLUMNS = (
    "case", "speed", "modulus_ratio", "rule", "e_eff_liggghts", "e_eff_oracle", "difference", "stuck_liggghts", "stuck_oracle",
    "contact_time_liggghts", "contact_time_oracle", "time_step", "steps", "wall_time",
)  # fmt: skip
# More lines than these have no legend, only a colour scale.
LEGEND_LINES = 14
COLOURS = (plot.BLUE, plot.VERMILION, plot.GREEN, plot.PURPLE, plot.ORANGE, plot.SKY, "black")
MARKERS = "osD^vPX"


class Settings(BaseModel):
    """Which scene, and which of its keys take which values."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    # A TOML file, relative to the sweep file, or the name of a shipped case.
    scene: str
    engine: Literal["liggghts", "oracle"] = "liggghts"
    # Keys of the scene file, such as "contact.0.surface_energy", and the values that each takes.
    vary: dict[str, Annotated[list[Any], Field(min_length=1)]] = {}
    # Of e_eff between LIGGGHTS and the oracle.
    tolerance: Annotated[float, Field(gt=0)] = compare.RESTITUTION_TOLERANCE

    @field_validator("scene")
    @classmethod
    def _scene_is_there(cls, name: str, info: ValidationInfo) -> str:
        beside = Path((info.context or {}).get("directory", ".")) / name
        path = beside if beside.is_file() else resources.shipped_cases().get(name)
        if path is None:
            shipped = ", ".join(resources.shipped_cases())
            raise ValueError(f"{beside} is not there. Give a path relative to the sweep file, or a shipped case: {shipped}.")
        return str(path)

    @field_validator("vary", mode="before")
    @classmethod
    def _keys_are_dotted(cls, tables: Any) -> Any:
        """The same for a.b = [...] as for "a.b" = [...]: TOML makes nested tables of the former."""
        if not isinstance(tables, dict):
            return tables
        found = dict(_flat(tables))
        for key, values in found.items():
            if not isinstance(values, list):
                raise ValueError(f"'{key}' = {values!r} must be a list of values. Write [{values!r}].")
        return found


def _flat(table: dict[str, Any], above: tuple[str, ...] = ()) -> list[tuple[str, Any]]:
    found: list[tuple[str, Any]] = []
    for key, value in table.items():
        parts = above + _parts(key)
        found += _flat(value, parts) if isinstance(value, dict) else [(_dotted(parts), value)]
    return found


def _parts(key: str) -> tuple[str, ...]:
    """Parts of a dotted key, by TOML's own rules: names with blanks or dots stand in quotes."""
    try:
        table = tomllib.loads(f"{key} = 0")
    except tomllib.TOMLDecodeError:
        return (key,)
    parts: list[str] = []
    while isinstance(table, dict):
        ((part, table),) = table.items()
        parts.append(part)
    return tuple(parts)


def _dotted(parts: tuple[str, ...]) -> str:
    return ".".join(part if part.replace("_", "").replace("-", "").isalnum() else f'"{part}"' for part in parts)


def points(settings: Settings) -> list[dict[str, Any]]:
    """One point per combination of values.

    Raises
    ------
    SceneError, PlanError
        Where a combination is no valid scene, or cannot be planned.
    """
    base = _read(Path(settings.scene))
    names = _short_names([key for key, values in settings.vary.items() if len(values) > 1])
    made = []
    for values in itertools.product(*settings.vary.values()):
        chosen = dict(zip(settings.vary, values, strict=True))
        label = _label(chosen, names)
        content = json.loads(json.dumps(base))
        for key, value in chosen.items():
            _put(content, key, value)
        text = json.dumps(content, sort_keys=True)
        try:
            _plan(text)
        except PyjkrError as error:
            raise type(error)(f"{label or 'scene'}: {error}") from error
        made.append(
            {"label": label or base.get("title", "scene"), "engine": settings.engine, "scene": text}
            | {"series": _label({key: value for key, value in chosen.items() if key != SPEEDS}, names), "vary": json.dumps(chosen)}
        )
    return made


def _read(path: Path) -> dict[str, Any]:
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8")) | {"source": path.name}
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise SceneError(f"{path}: is not valid TOML in UTF-8: {error}") from error
    # It asks for a speed that may not be among those of the sweep, and for a figure that a sweep does not draw.
    content.pop("figures", None)
    return content


def _put(content: Any, key: str, value: Any) -> None:
    """Set a dotted key; tables that the scene leaves out are made."""
    *above, last = _parts(key)
    for part in above:
        content = content.setdefault(part, {}) if isinstance(content, dict) else content[_index(content, part, key)]
    if isinstance(content, dict):
        content[last] = value
    else:
        content[_index(content, last, key)] = value


def _index(content: Any, part: str, key: str) -> int:
    if not isinstance(content, list):
        raise SceneError(f"vary: '{key}' goes into a value that is no table. Shorten it.")
    if not part.isdecimal() or int(part) >= len(content):
        raise SceneError(f"vary: '{key}' names entry '{part}' of a list of {len(content)}. They count from 0.")
    return int(part)


def _plan(text: str) -> Plan:
    content = json.loads(text)
    try:
        return plan(Scene.model_validate_json(text))
    except ValidationError as error:
        raise SceneError(f"{content['source']}: {explain(error, content, Scene)}") from error
    except (OverflowError, ZeroDivisionError) as error:
        raise SceneError(f"{content['source']}: its numbers lead beyond what can be computed ({error}).") from error


def _short_names(keys: list[str]) -> dict[str, str]:
    """Last parts of the keys where they differ, else the whole keys."""
    last = [_parts(key)[-1] for key in keys]
    return {key: name if last.count(name) == 1 else key for key, name in zip(keys, last, strict=True)}


def _label(chosen: dict[str, Any], names: dict[str, str]) -> str:
    return ", ".join(f"{names[key]} = {_text(value)}" for key, value in chosen.items() if key in names)


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else value if isinstance(value, str) else json.dumps(value)


def evaluate(point: dict[str, Any], directory: Path) -> list[dict[str, Any]]:
    """Every case of the point's scene: what was simulated, what the oracle says, what it took."""
    made = _plan(point["scene"])
    runs = campaign.execute(made, directory, find_simulator(), watcher=Nobody()) if point["engine"] == "liggghts" else None
    table = compare.compare(made, compare.oracle_outcomes(made), runs).table
    chosen = json.loads(point["vary"])
    shown = {key: value if isinstance(value, int | float | str) else json.dumps(value) for key, value in chosen.items()}
    return [
        {"label": point["label"], "series": point["series"], "engine": point["engine"]} | shown | {name: row[name] for name in COLUMNS}
        for row in table.to_dict("records")
    ]


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """LIGGGHTS against the oracle; the oracle alone has nothing to be held against."""
    if settings.engine == "oracle":
        return []
    worst = float(table["difference"].abs().max())
    unlike = int((table["stuck_liggghts"] != table["stuck_oracle"]).sum())
    return [
        Check(f"e_eff, LIGGGHTS against oracle: largest difference, {len(table)} cases", worst, f"<= {settings.tolerance:g}",
              worst <= settings.tolerance),
        Check("sticking decided differently, cases", unlike, "0", unlike == 0),
    ]  # fmt: skip


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """e_eff over the impact speed, one line per combination, stiffness and rule of the surface energy."""
    figure, (axes,) = plot.panels(1, (7.2, 4.8))
    lines = list(table.fillna({"series": ""}).groupby(["series", "modulus_ratio", "rule"], sort=False))
    few = len(lines) <= LEGEND_LINES
    scale = colormaps["viridis"]
    for index, ((series, ratio, rule), line) in enumerate(lines):
        line = line.sort_values("speed")
        colour = COLOURS[index % len(COLOURS)] if few else scale(index / (len(lines) - 1))
        one_stiffness = table["modulus_ratio"].nunique() == 1 and table["rule"].nunique() == 1
        stiffness = rf"$E_{{\rm mod}}/E$ = {ratio:g}" + ("" if rule == "scaled" else r", $\gamma$ not modified")
        label = series if series and one_stiffness else ", ".join(filter(None, [series, stiffness]))
        axes.plot(line["speed"], line["e_eff_oracle"], "-", color=colour, linewidth=1.2,
                  label=label if few and settings.engine == "oracle" else None)  # fmt: skip
        if settings.engine == "liggghts":
            axes.plot(line["speed"], line["e_eff_liggghts"], MARKERS[index % len(MARKERS)], color=colour, markerfacecolor="none",
                      markeredgewidth=1.4, markersize=7, label=label if few else None, clip_on=False)  # fmt: skip
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 3, 5, 7)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_ylim(-0.02, 1.02)
    axes.set_xlabel("impact speed $v$ [m/s]", fontsize=plot.STYLE["label"])
    axes.set_ylabel(r"effective restitution coefficient $e_{\rm eff}$", fontsize=plot.STYLE["label"])
    what = "lines: oracle; markers: LIGGGHTS" if settings.engine == "liggghts" else "oracle"
    axes.set_title(f"{what}; {len(lines)} combinations", fontsize=plot.STYLE["title"])
    if few:
        figure.legend(loc="outside lower center", ncols=1 if len(lines) < 4 else 2, fontsize=plot.STYLE["legend"], frameon=False)
    return {"restitution": figure}
