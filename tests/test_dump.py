"""Reading dumps: what was written comes back to the last bit, and no damaged file comes back at all."""

from __future__ import annotations

import gzip
import struct
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pyjkr.dump import DEFAULT_KEYWORDS, PAIR_COLUMNS, WALL_COLUMNS, jkr_history, read, read_contacts
from pyjkr.errors import DumpError, RunError
from pyjkr.run import Simulator, run_deck

# The contact computes run after the second half step of the velocities, the force of the step before it: their damping
# parts differ by the velocity gained in half a step, about 1 % of the force in this deck.
HALF_STEP_OF_DAMPING = 0.03
# Numbers written with 16 digits, differences of positions 1e4 times an overlap.
CANCELLATION = 1e-9
# Least speed of reading [bytes/s]: 120 MB a minute, an eighth of what an idle machine does.
SLOWEST = 2e6

Write = Callable[..., Path]

BOX = ((-0.5, 0.25), (-0.75, 0.125), (0.0, 3.0))


def snapshot(step: int, columns: str, rows: list[str], kind: str = "ATOMS", count: int | None = None) -> str:
    """The text of one snapshot as LIGGGHTS writes it, blanks at line ends included."""
    bounds = "".join(f"{low!r} {high!r}\n" for low, high in BOX)
    return (
        f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF {kind}\n{len(rows) if count is None else count}\n"
        f"ITEM: BOX BOUNDS ff pp mm\n{bounds}ITEM: {kind} {columns} \n" + "".join(f"{row} \n" for row in rows)
    )


TWO = snapshot(0, "id type x", ["7 2 0.125", "3 2 -1e-9"]) + snapshot(50, "id type x", ["3 2 0.5", "7 2 0.75"])


@pytest.fixture
def dump(tmp_path: Path) -> Write:
    def write(content: str | bytes, name: str = "dump.atoms") -> Path:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write


finite = st.floats(allow_nan=False, allow_infinity=False)


@given(
    snapshots=st.dictionaries(
        st.integers(0, 10**12),
        st.dictionaries(st.integers(1, 2**40), st.tuples(st.integers(1, 9), finite, finite), max_size=5),
        min_size=1,
        max_size=5,
    ),
    compress=st.booleans(),
)
def test_dump_custom_comes_back_as_it_was_written(
    tmp_path_factory: pytest.TempPathFactory, snapshots: dict[int, dict[int, tuple[int, float, float]]], compress: bool
) -> None:
    text = "".join(
        snapshot(step, "id type x c_energy[2]", [f"{i} {t} {x!r} {e!r}" for i, (t, x, e) in atoms.items()])
        for step, atoms in snapshots.items()
    ).encode()
    path = tmp_path_factory.mktemp("dump") / "dump"
    path.write_bytes(gzip.compress(text) if compress else text)
    frame = read(path)
    expected = [(step, i, *values) for step in sorted(snapshots) for i, values in snapshots[step].items()]
    assert list(frame.columns) == ["step", "id", "type", "x", "c_energy[2]"]
    assert [str(dtype) for dtype in frame.dtypes] == ["int64"] * 3 + ["float64"] * 2
    assert list(frame.itertuples(index=False, name=None)) == expected
    assert frame.attrs["box"] == dict.fromkeys(snapshots, BOX)


def test_dump_local_without_entries_keeps_its_columns_and_its_steps(dump: Write) -> None:
    frame = read(dump(snapshot(0, "index c_p[1]", [], "ENTRIES") + snapshot(20, "index c_p[1]", ["1 0.5"], "ENTRIES")))
    assert frame.to_dict("list") == {"step": [20], "index": [1], "c_p[1]": [0.5]}
    assert list(frame.attrs["box"]) == [0, 20]


def test_dump_of_empty_snapshots_alone_is_an_empty_frame(dump: Write) -> None:
    frame = read(dump(snapshot(0, "id x", [])))
    assert len(frame) == 0
    assert [str(dtype) for dtype in frame.dtypes] == ["int64", "int64", "float64"]


def test_files_of_one_step_each_are_read_by_pattern_or_list_in_order_of_time(dump: Write) -> None:
    paths = [dump(snapshot(step, "id x", [f"4 {step / 8}"]), f"dump.{step}") for step in (1000, 200, 30)]
    by_pattern = read(paths[0].parent / "dump.*")
    assert by_pattern["step"].tolist() == [30, 200, 1000]
    pd.testing.assert_frame_equal(by_pattern, read(paths))


def test_name_with_brackets_of_an_existing_file_is_no_pattern(dump: Write) -> None:
    assert len(read(dump(TWO, "dump[1].atoms"))) == 4


def test_label_and_tilt_and_windows_line_ends_and_element_are_read(dump: Write) -> None:
    text = snapshot(30, "id element x", ["5 Si 0.5"]).replace("ITEM: NUMBER", "ITEM: LABEL\nspheres\nITEM: NUMBER")
    text = text.replace("0.0 3.0", "0.0 3.0 0.25").replace("\n", "\r\n")
    frame = read(dump(text))
    assert frame["element"].tolist() == ["Si"]
    assert frame.attrs["box"] == {30: BOX}


def test_step_written_twice_alike_counts_once_and_unlike_is_refused(dump: Write) -> None:
    assert len(read(dump(TWO + TWO))) == 4
    with pytest.raises(DumpError, match=r"dump\.atoms:23: step 0 is here a second time"):
        read(dump(TWO + TWO.replace("0.125", "0.126")))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "the file is empty"),
        (" \n\n", "the file is empty"),
        (b"\x00\x01" + struct.pack("<4d", 2, 3, 4, 5), "a binary file"),
        ("id,x\n1,2\n", ":1: a dump starts with 'ITEM: TIMESTEP'"),
        (gzip.compress(TWO.encode())[:-30], "gzip data cut short or damaged"),
        (TWO[:-10], ":21: step 50: 1 rows of 2 promised"),
        (TWO[:-3], ":22: step 50: the file ends inside a row"),
        (TWO[: TWO.rindex("BOX")], "the file ends inside a snapshot"),
        (TWO[: TWO.index("3 2 0.5")], "step 50: 0 rows of 2 promised"),
        (TWO.replace("3 2 0.5", "3 2 0.5 6"), ":21: step 50: 4 values where the header names 3 columns"),
        (TWO.replace("3 2 0.5", "3 2"), ":21: step 50: 2 values where the header names 3 columns"),
        (TWO.replace("3 2 0.5", ""), ":21: step 50: 0 values where"),
        (TWO.replace("3 2 0.5", "3 2 0.5x"), ":21: step 50: column 'x': '0.5x' is not a number"),
        (TWO.replace("3 2 0.5", "3.5 2 0.5"), ":21: step 50: column 'id': '3.5' is not a whole number"),
        (TWO.replace("3 2 0.5", "3 nan 0.5"), ":21: step 50: column 'type': 'nan' is not a whole number"),
        (TWO.replace("3 2 0.5", "3 2 0.5\n8 2 0.25"), "3 rows where 2 were promised"),
        (TWO.replace("7 2 0.75", "3 2 0.75"), ":22: step 50: atom id 3 stands there twice"),
        (TWO.replace("\n50\n", "\nfifty\n"), ":13: expected a time step, found 'fifty'"),
        (
            TWO.replace("ITEM: NUMBER OF ATOMS\n2", "ITEM: NUMBER OF ATOMS\n-2", 1),
            ":4: expected the number of atoms, found '-2'",
        ),
        (TWO.replace("-0.5 0.25", "-0.5", 1), ":6: expected the bounds of the box along x, found '-0.5'"),
        (TWO.replace("-0.5 0.25", "nan nan", 1), ":6: expected the bounds of the box along x, found 'nan nan'"),
        (TWO.replace("ITEM: NUMBER OF ATOMS", "NUMBER OF ATOMS", 1), "expected a line 'ITEM: ...'"),
        (TWO.replace("ITEM: ATOMS id", "ITEM: ATMOS id", 1), "'ITEM: ATMOS id type x' does not belong here"),
        (TWO.replace("id type x", "id id x"), "column names missing or repeated"),
        (snapshot(0, "id x", ["1 2"]) + snapshot(9, "id y", ["1 2"]), "step 9 has columns 'id y', earlier ones 'id x'"),
    ],
)
def test_damaged_file_is_refused_with_place_and_reason(dump: Write, content: str | bytes, message: str) -> None:
    path = dump(content)
    with pytest.raises(DumpError) as caught:
        read(path)
    assert message in str(caught.value)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


@given(end=st.integers(1, len(TWO) - 1))
def test_file_cut_anywhere_but_between_snapshots_is_refused(tmp_path_factory: pytest.TempPathFactory, end: int) -> None:
    path = tmp_path_factory.mktemp("dump") / "dump"
    path.write_text(TWO[:end])
    if end == TWO.index("ITEM: TIMESTEP", 1):
        assert len(read(path)) == 2
    else:
        with pytest.raises(DumpError):
            read(path)


@pytest.mark.parametrize("value", ["nan", "-nan", "inf", "-inf"])
def test_value_that_is_not_finite_is_refused_unless_allowed(dump: Write, value: str) -> None:
    path = dump(TWO.replace("-1e-9", value))
    shown = f"{float(value)}"
    with pytest.raises(DumpError, match=rf"dump\.atoms:11: step 0: atom id 3, column 'x' is {shown}"):
        read(path)
    np.testing.assert_equal(read(path, allow_nonfinite=True)["x"].tolist()[1], float(value))


@pytest.mark.parametrize(
    ("path", "message"), [("none", "none: no such file"), ("none.*", "no file matches"), (".", "cannot be read"), ([], "empty")]
)
def test_missing_file_is_refused(tmp_path: Path, path: str | list[str], message: str) -> None:
    with pytest.raises(DumpError, match=message):
        read(tmp_path / path if isinstance(path, str) else path)


@pytest.mark.parametrize(("snapshots", "atoms"), [(20_000, 2), (3, 30_000)])
def test_many_snapshots_and_many_atoms_are_read_fast(dump: Write, snapshots: int, atoms: int) -> None:
    rows = [f"{i} 2 {i / 7:.12g} {i / 3:.12g} {i / 11:.12g}" for i in range(1, atoms + 1)]
    path = dump("".join(snapshot(step, "id type x y z", rows) for step in range(snapshots)))
    started = time.perf_counter()
    assert len(read(path)) == snapshots * atoms
    assert path.stat().st_size / (time.perf_counter() - started) > SLOWEST


# --- contacts ---------------------------------------------------------------------------------------------------------


def contacts(values: int, rows: list[str]) -> str:
    return snapshot(20, " ".join(f"c_q[{n}]" for n in range(1, values + 1)), rows, "ENTRIES")


def test_columns_are_named_in_the_order_of_liggghts_whatever_that_of_the_keywords(dump: Write) -> None:
    frame = read_contacts(dump(contacts(6, ["4 9 0 0.25 0.5 1e-6"])), ["delta", "history", "id"], n_history=2)
    assert list(frame.columns) == ["step", "id1", "id2", "periodic", "history_1", "history_2", "overlap"]
    assert [str(dtype) for dtype in frame.dtypes] == ["int64"] * 4 + ["float64"] * 3


def test_history_values_can_be_named(dump: Write) -> None:
    path = dump(contacts(6, ["4 9 0 0.25 0.5 1e-6"]))
    frame = read_contacts(path, ["delta", "history", "id"], history_names=["fast", "slow"])
    assert list(frame.columns) == ["step", "id1", "id2", "periodic", "fast", "slow", "overlap"]
    assert len(read_contacts(path, ["delta", "history", "id"], n_history=2, history_names=["fast", "slow"])) == 1
    for names, message in (
        (["fast"], r"c_ID\[5\].*1 history values"),
        (["slow", "slow"], "two columns would be named 'slow'"),
        (["overlap", "slow"], "two columns would be named 'overlap'"),
    ):
        with pytest.raises(DumpError, match=message):
            read_contacts(path, ["delta", "history", "id"], history_names=names)
    with pytest.raises(DumpError, match="n_history = 3, but history_names holds 2"):
        read_contacts(path, ["delta", "history", "id"], n_history=3, history_names=["fast", "slow"])


def test_history_of_the_jkr_models_is_named_in_the_order_of_the_plugin() -> None:
    assert jkr_history("jkr/simplified", event_correction=False) == ()
    assert jkr_history("jkr", "no_history") == ("in_contact", "carried_speed")
    names = jkr_history("jkr", "jkr", "krijt", twisting=True)
    assert [name.removesuffix("_x") for name in names if not name.endswith(("_y", "_z"))] == [
        "sliding_displacement",
        "rolling_displacement",
        "in_contact",
        "carried_speed",
        "carried_slip",
        "twisting_angle",
    ]
    assert len(names) == 12
    assert jkr_history("jkr", "history", "epsd2", event_correction=False)[3] == "rolling_moment_x"


@pytest.mark.parametrize(
    ("styles", "options", "message"),
    [
        (("hertz",), {}, "model 'hertz' does not go with the jkr models. Known: jkr/simplified, jkr"),
        (("jkr", "luding"), {}, "tangential 'luding'"),
        (("jkr", "jkr", "cdt"), {}, "rolling_friction 'cdt'"),
        (("jkr", "jkr", "epsd2"), {"twisting": True}, "twisting needs rolling_friction 'krijt'"),
    ],
)
def test_history_of_styles_that_do_not_combine_is_refused(styles: tuple[str], options: dict[str, bool], message: str) -> None:
    with pytest.raises(DumpError, match=message):
        jkr_history(*styles, **options)


@pytest.mark.parametrize(
    ("keywords", "n_history", "wall", "message"),
    [
        (["id", "delta"], 0, False, r"expected c_ID\[1\] ... c_ID\[4\]"),
        (["id", "history"], 0, False, "n_history = 0 does not fit"),
        (["id", "force"], 3, False, "n_history = 3 does not fit"),
        (["id", "ms_id"], 0, False, "no columns known for keyword 'ms_id'"),
        (["id", "contactPoint"], 0, True, "'pos' holds that point"),
        (["heatFlux", "contactPoint"], 0, False, "overwrite each other"),
        (["id", "force"], 0, False, "holds 0.5, not an identifier"),
    ],
)
def test_keywords_that_do_not_fit_the_dump_are_refused(
    dump: Write, keywords: list[str], n_history: int, wall: bool, message: str
) -> None:
    with pytest.raises(DumpError, match=message):
        read_contacts(dump(contacts(6, ["4 9 0.5 0.25 0.5 1e-6"])), keywords, n_history=n_history, wall=wall)


def test_identifiers_rounded_by_the_dump_are_refused_and_long_ones_are_not(dump: Write) -> None:
    with pytest.raises(DumpError, match="rounded to six digits"):
        read_contacts(dump(contacts(3, ["1.23457e+06 9 0", "1.23457e+06 8 0"])), ["id"])
    assert read_contacts(dump(contacts(3, ["1234567 9 0"])), ["id"])["id1"].tolist() == [1234567]


# Contact history of `hertz` with `tangential history`: the sliding displacement.
N_HISTORY = 3


def run_with_compute(
    spheres_deck: Write, liggghts: Simulator, style: str, keywords: list[str], columns: int, ranks: int = 1
) -> Path:
    numbered = [f"c_q[{n}]" for n in range(1, columns + 1)]
    deck = spheres_deck(
        f"compute q all {style} {' '.join(keywords)}",
        "dump atoms all custom 20 dump.atoms id type x y z vx vy vz radius fx fy fz tqx tqy tqz",
        'dump_modify atoms format "%d %d' + " %.16g" * 13 + '"',
        f"dump q all local 20 dump.q {' '.join(numbered)}",
        f'dump_modify q format "{" ".join(["%.16g"] * columns)}"',
        "run 20",
    )
    return run_deck(deck, simulator=liggghts, ranks=ranks).directory


@pytest.mark.liggghts
@pytest.mark.parametrize("style", ["pair/gran/local", "wall/gran/local"])
def test_each_keyword_makes_as_many_columns_as_the_table_says(spheres_deck: Write, liggghts: Simulator, style: str) -> None:
    table = WALL_COLUMNS if style.startswith("wall") else PAIR_COLUMNS
    count = {keyword: N_HISTORY if keyword == "history" else len(columns) for keyword, columns in table.items()}
    del count["heatFlux"]  # needs a fix heat/gran/conduction

    def columns_are_at_most(columns: int, keywords: list[str]) -> None:
        with pytest.raises(RunError, match="out-of-range"):
            run_with_compute(spheres_deck, liggghts, style, keywords, columns + 1)

    # No keyword makes more than its number, all together make the sum: each makes just its number.
    for keyword, columns in count.items():
        columns_are_at_most(columns, [keyword])
    run_with_compute(spheres_deck, liggghts, style, list(count), sum(count.values()))

    default = sum(count[keyword] for keyword in DEFAULT_KEYWORDS)
    columns_are_at_most(default, [])
    directory = run_with_compute(spheres_deck, liggghts, style, [], default)
    contacts = read_contacts(directory / "dump.q", n_history=N_HISTORY, wall=style.startswith("wall"))
    assert contacts["contact_area"].gt(0).all()


def vectors(frame: pd.DataFrame, *columns: str) -> np.ndarray:
    return frame[list(columns)].to_numpy()


def xyz(frame: pd.DataFrame, name: str) -> np.ndarray:
    return vectors(frame, f"{name}_x", f"{name}_y", f"{name}_z")


def total(frame: pd.DataFrame, name: str) -> np.ndarray:
    return np.asarray(xyz(frame, name).sum(axis=0))


@pytest.mark.liggghts
@pytest.mark.parametrize("ranks", [1, 2])
def test_contact_columns_mean_what_their_names_say(spheres_deck: Write, liggghts: Simulator, ranks: int) -> None:
    def frames(style: str, table: dict[str, tuple[str, ...]]) -> tuple[pd.DataFrame, pd.DataFrame]:
        keywords = [keyword for keyword in table if keyword != "heatFlux"]
        columns = sum(map(len, table.values())) - 1 + N_HISTORY
        directory = run_with_compute(spheres_deck, liggghts, style, keywords, columns, ranks)
        contacts = read_contacts(directory / "dump.q", keywords, n_history=N_HISTORY, wall=style.startswith("wall"))
        atoms = read(directory / "dump.atoms")
        return contacts.query("step == 20"), atoms.query("step == 20").set_index("id")

    pairs, atoms = frames("pair/gran/local", PAIR_COLUMNS)
    walls, _ = frames("wall/gran/local", WALL_COLUMNS)
    assert {frozenset(pair) for pair in zip(pairs["id1"], pairs["id2"], strict=True)} == {frozenset({1, 2}), frozenset({2, 3})}
    assert sorted(walls["id"]) == [1, 2, 3]
    assert (pairs["periodic"] == 0).all()
    assert (walls["mesh"] == 0).all()
    assert set(walls["triangle"]) == {0, 1}

    for which in "12":
        own = atoms.loc[pairs[f"id{which}"]]
        np.testing.assert_array_equal(vectors(pairs, *(f"{a}{which}" for a in "xyz")), vectors(own, *"xyz"))
        np.testing.assert_array_equal(vectors(pairs, *(f"v{a}{which}" for a in "xyz")), vectors(own, "vx", "vy", "vz"))
    own = atoms.loc[walls["id"]]
    np.testing.assert_array_equal(vectors(walls, *"xyz"), vectors(own, *"xyz"))
    np.testing.assert_array_equal(vectors(walls, "vx", "vy", "vz"), vectors(own, "vx", "vy", "vz"))
    np.testing.assert_array_equal(vectors(walls, "wall_x", "wall_y"), vectors(own, "x", "y"))
    assert (vectors(walls, "wall_z", "wall_vx", "wall_vy", "wall_vz") == 0).all()

    apart = vectors(pairs, "x2", "y2", "z2") - vectors(pairs, "x1", "y1", "z1")
    distance = np.linalg.norm(apart, axis=1)
    radius = atoms["radius"].iloc[0]
    overlap = 2 * radius - distance
    assert (overlap > 0).all()
    np.testing.assert_allclose(pairs["overlap"], overlap, rtol=CANCELLATION)
    np.testing.assert_allclose(walls["overlap"], radius - own["z"], rtol=CANCELLATION)
    np.testing.assert_allclose(pairs["contact_area"], np.pi * (radius**2 - distance**2 / 4), rtol=CANCELLATION)
    np.testing.assert_allclose(walls["contact_area"], np.pi * (radius**2 - own["z"] ** 2), rtol=CANCELLATION)
    np.testing.assert_allclose(xyz(pairs, "contact"), vectors(pairs, "x1", "y1", "z1") + apart / 2, rtol=CANCELLATION)

    for contacts, normal in ((pairs, apart / distance[:, None]), (walls, np.array([[0.0, 0.0, -1.0]] * len(walls)))):
        for name in ("force", "torque"):
            whole, parts = xyz(contacts, name), (xyz(contacts, f"{name}_normal"), xyz(contacts, f"{name}_tangential"))
            scale = np.abs(whole).max()
            np.testing.assert_allclose(parts[0] + parts[1], whole, atol=CANCELLATION * scale)
            np.testing.assert_allclose((parts[1] * normal).sum(axis=1), 0, atol=CANCELLATION * scale)
        # Repulsive: the force on the first particle points away from its partner.
        assert ((xyz(contacts, "force_normal") * normal).sum(axis=1) < 0).all()

    # Forces act on the first particle of a pair and, turned round, on the second; torques turn both the same way,
    # because equal radii make equal arms.
    gravity = 9.81 * 2500 * 4 / 3 * np.pi * radius**3
    for number, atom in atoms.iterrows():
        first, second, floor = pairs[pairs["id1"] == number], pairs[pairs["id2"] == number], walls[walls["id"] == number]
        force = total(first, "force") - total(second, "force") + total(floor, "force") - [0, 0, gravity]
        torque = total(first, "torque") + total(second, "torque") + total(floor, "torque")
        for name, found, columns in (("force", force, ["fx", "fy", "fz"]), ("torque", torque, ["tqx", "tqy", "tqz"])):
            largest = np.abs(xyz(pairs, name)).max()
            np.testing.assert_allclose(found, atom[columns], atol=HALF_STEP_OF_DAMPING * largest)
