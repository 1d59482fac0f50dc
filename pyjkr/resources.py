"""Where `templates/` and `cases/` are: in the installed package, or at the top of the repository beside it."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def directory(name: str) -> Path:
    """Directory `templates` or `cases`.

    Parameters
    ----------
    name : str
        Its name.

    Raises
    ------
    FileNotFoundError
        Where neither the package nor the repository holds it.
    """
    for parent in (_PACKAGE, _PACKAGE.parent):
        if (parent / name).is_dir():
            return parent / name
    raise FileNotFoundError(f"{name}/ is neither in {_PACKAGE} nor beside it; reinstall pyjkr")


def shipped_cases() -> dict[str, Path]:
    """Scene files of the shipped cases by name."""
    return {path.parent.name: path for path in sorted(directory("cases").glob("*/scene.toml"))}


def shipped_sweeps() -> dict[str, Path]:
    """Sweep files of the shipped cases by name."""
    return {path.parent.name: path for path in sorted(directory("cases").glob("*/sweep.toml"))}


def scene_file(name: str) -> Path:
    """A scene given as a path, or as the name of a shipped case. Paths that do not exist come back as they are."""
    path = Path(name)
    return path if path.is_file() else shipped_cases().get(name, path)
