"""Pydantic's validation errors -> one line that a scene's author can act on.

Covers the wording only: which table, which key, which value with its unit, the rule it broke, the remedy.
Of several faults the unknown keys come first, because a slip in a name also makes the right name look missing.
"""

from __future__ import annotations

import difflib
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

RULES = {
    "greater_than": "must be > {gt:g}.",
    "greater_than_equal": "must be >= {ge:g}.",
    "less_than": "must be < {lt:g}.",
    "less_than_equal": "must be <= {le:g}.",
    "finite_number": "must be a finite number.",
    "too_short": "must not be empty.",
}
EXPECTED_TYPES = {
    "float": "a number",
    "int": "a whole number",
    "bool": "true or false",
    "string": "a text in quotes",
    "dict": "a table",
    "model": "a table",
    "tuple": "a list",
}


def explain(error: ValidationError, content: dict[str, Any], scene: type[BaseModel]) -> str:
    """One line for the first fault of `error`, with table, key, value, rule and remedy.

    Parameters
    ----------
    error : ValidationError
        What pydantic found.
    content : dict
        The TOML file as read, to name contacts by their materials.
    scene : type
        The model that was validated; its fields carry units and remedies.
    """
    fault = min(error.errors(), key=lambda item: item["type"] != "extra_forbidden")
    location, kind = list(fault["loc"]), fault["type"]
    if kind == "scene":
        table = _table_name(location, content)
        return f"{table}: {fault['msg']}" if table else fault["msg"]
    depth = next((i for i in range(len(location), 0, -1) if isinstance(location[i - 1], str)), 0)
    key = str(location[depth - 1])
    table = _table_name(location[: depth - 1], content)
    where = f"{table}: " if table else ""
    if kind == "extra_forbidden":
        known = [name for name in _model_at(location[:-1], scene).model_fields if name != "source"]
        nearest = difflib.get_close_matches(key, known, n=1, cutoff=0.5)
        return f"{where}unknown key '{key}'. " + (f"Did you mean '{nearest[0]}'?" if nearest else f"Known: {', '.join(known)}.")
    field = _model_at(location[: depth - 1], scene).model_fields.get(key)
    extra = _extra(field.annotation, field.json_schema_extra, field.metadata) if field else {}
    unit, remedy = extra.get("unit", ""), extra.get("remedy", "")
    if kind == "missing":
        if not location[:-1] and key != "title":
            return f"the table [{key}] is missing. Add it."
        return f"{where}{key} is missing. " + (f"Give it in {unit}." if unit else remedy or "Add it.")
    index = f"[{location[-1]}]" if isinstance(location[-1], int) and depth < len(location) else ""
    value = f"{fault['input']!r}{' ' + unit if unit else ''}"
    if kind == "literal_error":
        choices = fault["ctx"]["expected"]
        nearest = difflib.get_close_matches(str(fault["input"]), choices.replace("'", "").replace(" or ", ", ").split(", "), n=1)
        return f"{where}{key} = {value} must be {choices}." + (f" Did you mean '{nearest[0]}'?" if nearest else "")
    rule = RULES[kind].format(**fault.get("ctx", {})) if kind in RULES else _type_rule(kind, fault["msg"])
    return f"{where}{key}{index} = {value} {rule} {remedy}".rstrip()


def _type_rule(kind: str, message: str) -> str:
    wanted = EXPECTED_TYPES.get(kind.split("_")[0])
    return f"must be {wanted}." if wanted else f"is not valid: {message}."


def _table_name(location: list[Any], content: dict[str, Any]) -> str:
    """`material 'silica'`, `contact 'a'-'b'`, `impact`: the table as its author knows it."""
    if len(location) >= 2 and location[0] == "material":
        return f"material '{location[1]}'"
    if len(location) >= 2 and location[0] == "contact":
        between = content["contact"][location[1]].get("between")
        if isinstance(between, list) and len(between) == 2:
            return f"contact '{between[0]}'-'{between[1]}'"
        return f"contact number {location[1] + 1}"
    return str(location[0]) if location else ""


def _model_at(location: list[Any], model: type[BaseModel]) -> type[BaseModel]:
    """The model whose fields the keys below `location` are."""
    for part in location:
        field = model.model_fields.get(part) if isinstance(part, str) else None
        if field is not None:
            inner = _inner_model(field.annotation)
            model = inner or model
    return model


def _inner_model(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for item in get_args(annotation) if (found := _inner_model(item))), None)


def _extra(annotation: Any, extra: Any, metadata: Any) -> dict[str, str]:
    """Unit and remedy of a field, also when they sit inside `X | None` or a tuple of X."""
    if isinstance(extra, dict):
        return extra
    for item in (*metadata, *get_args(annotation)):
        found = _extra(item, getattr(item, "json_schema_extra", None), getattr(item, "__metadata__", ()))
        if found:
            return found
    return {}
