"""Contact lists: `dump local` of `compute pair/gran/local` and `compute wall/gran/local` under full names.

The columns were read off real runs of LIGGGHTS 3.8; the history is that of the styles which the deck names.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import pandas as pd

from pyjkr.dump.frames import read
from pyjkr.dump.snapshots import Paths, expand
from pyjkr.errors import DumpError


def _vector(name: str) -> tuple[str, ...]:
    return tuple(f"{name}_{axis}" for axis in "xyz")


# Columns that each keyword of `compute pair/gran/local` makes, in the order in which LIGGGHTS 3.8 writes them whatever
# the order of the keywords. Forces and torques act on particle 1.
PAIR_COLUMNS: dict[str, tuple[str, ...]] = {
    "pos": ("x1", "y1", "z1", "x2", "y2", "z2"),
    "vel": ("vx1", "vy1", "vz1", "vx2", "vy2", "vz2"),
    "id": ("id1", "id2", "periodic"),
    "force": _vector("force"),
    "force_normal": _vector("force_normal"),
    "force_tangential": _vector("force_tangential"),
    "torque": _vector("torque"),
    "torque_normal": _vector("torque_normal"),
    "torque_tangential": _vector("torque_tangential"),
    "history": (),
    "contactArea": ("contact_area",),
    "delta": ("overlap",),
    "heatFlux": ("heat_flux",),
    "contactPoint": _vector("contact"),
}
# The same for `compute wall/gran/local`. Positions and velocities: first the wall at the contact, then the particle.
# Forces and torques act on the particle. It leaves the columns of `contactPoint` zero; `pos` holds that point.
WALL_COLUMNS: dict[str, tuple[str, ...]] = {
    **{keyword: columns for keyword, columns in PAIR_COLUMNS.items() if keyword != "contactPoint"},
    "pos": ("wall_x", "wall_y", "wall_z", "x", "y", "z"),
    "vel": ("wall_vx", "wall_vy", "wall_vz", "vx", "vy", "vz"),
    "id": ("mesh", "triangle", "id"),
}
# What the computes write when their command names no keyword.
DEFAULT_KEYWORDS = ("pos", "vel", "id", "force", "torque", "history", "contactArea")

_CONTACT_IDENTIFIERS = frozenset({"id1", "id2", "periodic", "mesh", "triangle", "id"})
# `dump local` writes six digits unless told otherwise, which rounds identifiers from here on.
_FIRST_ROUNDED_IDENTIFIER = 10**6

# What `add_history_value` of the styles asks for, in the order in which LIGGGHTS 3.8 and the plug-in call it: the
# constructors of the sliding and of the rolling model, then `postSettings` of the normal, the sliding and the rolling one.
_SLIDING_HISTORY = {
    "off": (),
    "no_history": (),
    "history": _vector("sliding_displacement"),
    "jkr": _vector("sliding_displacement"),
}
_ROLLING_HISTORY = {"off": (), "epsd2": _vector("rolling_moment"), "krijt": _vector("rolling_displacement")}
_NORMAL_HISTORY = {"jkr/simplified": (), "jkr": ("in_contact",)}


def jkr_history(
    normal: str = "jkr",
    tangential: str = "off",
    rolling_friction: str = "off",
    *,
    twisting: bool = False,
    event_correction: bool = True,
) -> tuple[str, ...]:
    """Names of the history values of a contact with a jkr model, in the order of the `history` columns.

    Parameters
    ----------
    normal, tangential, rolling_friction
        Styles as in the deck.
    twisting, event_correction
        The keywords `twisting` and `eventCorrection`, with the defaults of the plug-in.

    Returns
    -------
    tuple of str
        `sliding_displacement_*` [m], of particle 1 past particle 2; `rolling_displacement_*` [m] with `krijt`, or
        `rolling_moment_*` [N m] with `epsd2`; `in_contact`, 1 while the contact or its neck holds;
        `carried_speed` and `carried_slip_*` [m/s], internal to the event correction; `twisting_angle` [rad].

    Raises
    ------
    DumpError
        If there is no such combination of styles.
    """
    for slot, name, known in (
        ("model", normal, _NORMAL_HISTORY),
        ("tangential", tangential, _SLIDING_HISTORY),
        ("rolling_friction", rolling_friction, _ROLLING_HISTORY),
    ):
        if name not in known:
            raise DumpError(f"jkr_history: {slot} '{name}' does not go with the jkr models. Known: {', '.join(known)}.")
    if twisting and rolling_friction != "krijt":
        raise DumpError("jkr_history: twisting needs rolling_friction 'krijt'. Change one of the two.")
    return (
        *_SLIDING_HISTORY[tangential],
        *_ROLLING_HISTORY[rolling_friction],
        *_NORMAL_HISTORY[normal],
        *(("carried_speed",) if event_correction else ()),
        *(_vector("carried_slip") if event_correction and tangential == "jkr" else ()),
        *(("twisting_angle",) if twisting else ()),
    )


def read_contacts(
    path: Paths,
    keywords: Sequence[str] = (),
    *,
    n_history: int = 0,
    history_names: Sequence[str] = (),
    wall: bool = False,
    allow_nonfinite: bool = False,
) -> pd.DataFrame:
    """Read a `dump local` of `compute pair/gran/local` or `compute wall/gran/local` under full names.

    Parameters
    ----------
    path, allow_nonfinite
        As for `read`.
    keywords
        What the compute's command names, in any order; none means the compute's own default.
    n_history
        Number of history values per contact; the columns are `history_1`, `history_2`, ...
    history_names
        Names of the history values in order, in place of `n_history`; `jkr_history` gives those of the jkr models.
    wall
        True for `compute wall/gran/local`.

    Returns
    -------
    pandas.DataFrame
        One row per step and contact with the columns of `PAIR_COLUMNS` or `WALL_COLUMNS`, identifiers as int64.
        `overlap` [m] is positive in compression, negative in a neck. Columns that are not the compute's keep their name.

    Notes
    -----
    `contact_area` [m2] is LIGGGHTS' own: the lens in which two undeformed spheres would cut each other. It is not that
    of an adhesive contact, and negative or meaningless in a neck, where nothing is cut. The area of a jkr contact is
    pi a^2, from the column `overlap`:

        area = numpy.pi * pyjkr.contact.contact_radius(contacts["overlap"], pair) ** 2

    Raises
    ------
    DumpError
        As for `read`; also if the dump does not hold all columns of such a compute, or identifiers lost digits.
    """
    history = tuple(history_names) or tuple(f"history_{number}" for number in range(1, n_history + 1))
    if n_history not in (0, len(history)):
        raise DumpError(f"n_history = {n_history}, but history_names holds {len(history)} names. Leave n_history out.")
    names = _contact_names(tuple(keywords) or DEFAULT_KEYWORDS, history, wall)
    frame = read(path, allow_nonfinite=allow_nonfinite)
    numbered = {column: match for column in map(str, frame) if (match := re.fullmatch(r"c_(\w+)\[(\d+)\]", column))}
    computes = {match[1] for match in numbered.values()}
    indices = sorted(int(match[2]) for match in numbered.values())
    if len(computes) != 1 or indices != list(range(1, len(names) + 1)):
        first = expand(path)[0]
        raise DumpError(
            f"{first}: expected c_ID[1] ... c_ID[{len(names)}] of one compute, for the keywords "
            f"{' '.join(keywords) or '(default)'} and {len(history)} history values; found {' '.join(numbered) or 'none'}. "
            "Give the keywords and the number of history values of the deck, and dump all columns."
        )
    frame = frame.rename(columns={column: names[int(match[2]) - 1] for column, match in numbered.items()})
    for name in _CONTACT_IDENTIFIERS.intersection(frame.columns):
        values = frame[name].to_numpy()
        fractional = values[values != np.rint(values)]
        if fractional.size:
            raise DumpError(
                f"{expand(path)[0]}: '{name}' holds {fractional[0]:g}, not an identifier: the keywords are not those of "
                "the deck's compute. Give the deck's own."
            )
        large = values[values >= _FIRST_ROUNDED_IDENTIFIER]
        if large.size and all(float(f"{value:g}") == value for value in large):
            raise DumpError(
                f"{expand(path)[0]}: '{name}' up to {large.max():g} has been rounded to six digits by the dump. "
                "Add `dump_modify ID format` with %.16g for every column to the deck."
            )
        frame[name] = values.astype(np.int64)
    return frame


def _contact_names(keywords: Sequence[str], history: Sequence[str], wall: bool) -> list[str]:
    table = WALL_COLUMNS if wall else PAIR_COLUMNS
    style = "wall/gran/local" if wall else "pair/gran/local"
    for keyword in keywords:
        if keyword not in table:
            hint = " 'pos' holds that point." if keyword == "contactPoint" else ""
            raise DumpError(f"compute {style}: no columns known for keyword '{keyword}'.{hint} Known: {', '.join(table)}.")
    if {"heatFlux", "contactPoint"} <= set(keywords):
        raise DumpError(f"compute {style}: heatFlux and contactPoint overwrite each other in LIGGGHTS 3.8. Drop one.")
    if ("history" in keywords) != (len(history) > 0):
        raise DumpError(f"compute {style}: n_history = {len(history)} does not fit. Give it with 'history', and only then.")
    names = [name for keyword in table if keyword in keywords for name in (history if keyword == "history" else table[keyword])]
    repeated = next((name for index, name in enumerate(names) if name in names[:index]), None)
    if repeated is not None:
        raise DumpError(f"compute {style}: two columns would be named '{repeated}'. Change history_names.")
    return names
