"""Sweep files of the counting study, and the marks that its evaluations leave."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from argparse import Namespace
from collections import Counter
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent.parent


class Here:
    """A crew without processes."""

    width: int | None = 1

    def submit(self, task: Callable[..., Any], *arguments: Any) -> Future[Any]:
        future = Future()
        future.set_result(task(*arguments))
        return future

    def close(self) -> None:
        """Nothing."""

    abort = restart = close


def written(directory: Path, numbers: list[float], **settings: object) -> Path:
    """A sweep file over these numbers, and the directory of its marks."""
    (directory / "marks").mkdir(exist_ok=True)
    lines = ['title = "squares"', 'study = "sweep_fakes.counting"', "[settings]", f"numbers = {numbers}"]
    path = directory / "squares.toml"
    path.write_text("\n".join([*lines, *(f"{key} = {value!r}" for key, value in settings.items())]) + "\n", encoding="utf-8")
    return path


def evaluated(directory: Path) -> Counter[str]:
    """How often each number was evaluated."""
    return Counter(mark.name.split("-")[1] for mark in (directory / "marks").glob("evaluated-*"))


def options(path: Path, output: Path, **changes: object) -> Namespace:
    """What the command line hands to the verb."""
    return Namespace(**{"sweep": str(path), "output": output, "workers": 2, "scheduler": None, "no_progress": True} | changes)


def started(path: Path, output: Path, *arguments: str) -> subprocess.Popen[str]:
    """The verb in a process of its own."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests")])}
    words = [sys.executable, "-m", "pyjkr", "sweep", str(path), "-o", str(output), "--workers", "2", *arguments]
    return subprocess.Popen(
        words, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=path.parent, start_new_session=True,
        # what a shell starts with & has Ctrl-C ignored, and so would the sweep
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
