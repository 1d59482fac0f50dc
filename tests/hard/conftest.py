"""The fixture `figure`: a measured number, its tolerance, and the page that shows both (docs/hard-cases.md)."""

from __future__ import annotations

import inspect
import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

Figure = Callable[..., None]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--figures", default=None, help="file to which measured figures are appended, one JSON object a line"
    )


def _sentence(request: pytest.FixtureRequest) -> str:
    name = request.node.originalname.removeprefix("test_").replace("_", " ")
    callspec = getattr(request.node, "callspec", None)
    return name + (f" [{callspec.id}]" if callspec else "")


@pytest.fixture
def figure(request: pytest.FixtureRequest) -> Figure:
    """Check `value <= tolerance` and keep both for the page; why the case is hard is the test's docstring."""

    def record(what: str, value: float, tolerance: float) -> None:
        value = float(value)
        holds = math.isfinite(value) and value <= tolerance
        if target := request.config.getoption("figures", default=None):
            row = {
                "group": inspect.getdoc(request.module),
                "case": _sentence(request),
                "why": inspect.getdoc(request.function),
                "what": what,
                "value": value,
                "tolerance": float(tolerance),
                "holds": holds,
            }
            with Path(target).open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
        assert holds, f"{what}: {value:.3g} where at most {tolerance:.3g} is allowed"

    return record
