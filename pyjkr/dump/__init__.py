"""Dump files of LIGGGHTS -> tidy `pandas.DataFrame`: atoms with `read`, contact lists with `read_contacts`."""

from pyjkr.dump.contacts import DEFAULT_KEYWORDS, PAIR_COLUMNS, WALL_COLUMNS, jkr_history, read_contacts
from pyjkr.dump.frames import read
from pyjkr.dump.rows import INTEGER_COLUMNS, TEXT_COLUMNS

__all__ = [
    "DEFAULT_KEYWORDS",
    "INTEGER_COLUMNS",
    "PAIR_COLUMNS",
    "TEXT_COLUMNS",
    "WALL_COLUMNS",
    "jkr_history",
    "read",
    "read_contacts",
]
