"""Sweep files: TOML -> a validated `Sweep`: title, study, the study's own settings.

Every fault ends in one `SceneError` line that names the file, the table, the key, the rule and what to do instead.
A study may name files relative to the sweep file: its validators find the directory in `info.context["directory"]`.
"""

from __future__ import annotations

import difflib
import importlib
import json
import math
import pkgutil
import tomllib
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError, create_model

import pyjkr.studies
from pyjkr import resources
from pyjkr.errors import PyjkrError, SceneError
from pyjkr.scene_errors import explain

SWEEP_NAME = "sweep.toml"
# What a module must have to be a study.
PARTS = ("VERSION", "Settings", "points", "evaluate", "checks", "figures")


@dataclass(frozen=True)
class Sweep:
    """A validated sweep file.

    Attributes
    ----------
    title : str
        One line for figures and reports.
    study : str
        As the file names it.
    settings : BaseModel
        Of the study's own class.
    source : Path
        The file.
    """

    title: str
    study: str
    settings: BaseModel
    source: Path

    @property
    def module(self) -> ModuleType:
        """The study."""
        return importlib.import_module(module_name(self.study))

    @property
    def points(self) -> list[dict[str, Any]]:
        """What is to be evaluated, as it comes back from JSON; a point that is listed twice is evaluated once.

        Raises
        ------
        SceneError
            Where there are none.
        PyjkrError
            Where the study finds fault with its settings taken together.
        """
        try:
            texts = [json.dumps(point, sort_keys=True, allow_nan=False) for point in self.module.points(self.settings)]
        except PyjkrError as error:
            raise type(error)(f"{self.source}: {error}") from error
        if not texts:
            raise SceneError(f"{self.source}: settings: they leave no point to evaluate. Give every list an entry.")
        return [json.loads(text) for text in dict.fromkeys(texts)]


def sweep_file(name: str) -> Path:
    """A sweep given as a path, or as the name of a shipped case.

    Raises
    ------
    SceneError
        Where there is neither.
    """
    path = Path(name)
    if path.is_file() or path.suffix == ".toml":
        return path
    shipped = resources.shipped_sweeps()
    if name not in shipped:
        near = difflib.get_close_matches(name, shipped, n=1)
        hint = f"Did you mean '{near[0]}'?" if near else f"Shipped: {', '.join(shipped) or 'none'}."
        hint = f"Did you mean {path / SWEEP_NAME}?" if (path / SWEEP_NAME).is_file() else hint
        raise SceneError(f"{name}: neither a sweep file nor a shipped case with one. {hint}")
    return shipped[name]


def module_name(study: str) -> str:
    """Full name of a study's module: one of `pyjkr.studies`, or with a dot any module on the Python path."""
    return study if "." in study else f"pyjkr.studies.{study}"


def load(path: str | Path) -> Sweep:
    """Read and validate a sweep file.

    Parameters
    ----------
    path : str or Path
        TOML file.

    Raises
    ------
    SceneError
        One line: file, table, key, rule, remedy.
    """
    path = Path(path)
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}. Name a sweep file or a shipped case.") from error
    except UnicodeDecodeError as error:
        raise SceneError(f"{path}: is not a text file in UTF-8. TOML needs that encoding.") from error
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"{path}: is not valid TOML: {error}") from error
    study = content.get("study")
    if not isinstance(study, str) or not study:
        raise SceneError(f"{path}: study is missing. Name one of {', '.join(_known_studies())}.")
    module = _study(study, path)
    whole = create_model(
        "Sweep",
        __config__=ConfigDict(extra="forbid", frozen=True),
        title=(str, ...),
        study=(str, ...),
        settings=(module.Settings, ...),
    )
    content.setdefault("settings", {})
    if (place := _not_finite(content)) is not None:
        raise SceneError(f"{path}: {place} is not a finite number. Correct it.")
    try:
        # As JSON, so that lists pass for tuples even where a study is strict about types.
        text = json.dumps(content, default=str)
        read = whole.model_validate_json(text, context={"directory": path.absolute().parent})
    except ValidationError as error:
        raise SceneError(f"{path}: {_explain(error, content, whole)}") from error
    return Sweep(read.title, study, read.settings, path)


def _not_finite(value: Any, place: str = "") -> str | None:
    """Where a value of the file is inf or nan, which no point can hold, and which of them; None where it holds neither."""
    if isinstance(value, float):
        return None if math.isfinite(value) else f"{place} = {value}"
    if isinstance(value, dict):
        inner = [(f"{place}.{key}" if place else key, item) for key, item in value.items()]
    else:
        inner = [(f"{place}[{index}]", item) for index, item in enumerate(value)] if isinstance(value, list) else []
    return next((found for name, item in inner if (found := _not_finite(item, name))), None)


def _explain(error: ValidationError, content: dict[str, Any], model: type[BaseModel]) -> str:
    """One line for the first fault; unknown keys come first, as for scenes."""
    fault = min(error.errors(), key=lambda item: item["type"] != "extra_forbidden")
    if fault["type"] in ("value_error", "assertion_error"):
        # Raised by a study's own validator, whose text says it all.
        where = ".".join(str(part) for part in fault["loc"])
        return f"{where}: {fault['ctx']['error']}"
    return explain(error, content, model)


def _study(name: str, path: Path) -> ModuleType:
    wanted = module_name(name)
    try:
        module = importlib.import_module(wanted)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{wanted}.".startswith(f"{error.name}."):
            raise SceneError(f"{path}: study '{name}' needs the package '{error.name}'. Install it.") from error
        known = _known_studies()
        near = difflib.get_close_matches(name, known, n=1)
        hint = f"Did you mean '{near[0]}'?" if near else f"Known: {', '.join(known)}; with a dot, any module of yours."
        raise SceneError(f"{path}: unknown study '{name}'. {hint}") from None
    missing = [part for part in PARTS if not hasattr(module, part)]
    if missing:
        raise SceneError(f"{path}: {wanted} is no study: it has no {', '.join(missing)}. Known: {', '.join(_known_studies())}.")
    return module


def _known_studies() -> list[str]:
    found = []
    for item in pkgutil.iter_modules(pyjkr.studies.__path__):
        try:
            module = importlib.import_module(f"pyjkr.studies.{item.name}")
        except ImportError:
            continue
        if all(hasattr(module, part) for part in PARTS):
            found.append(item.name)
    return found
