"""`Case` -> LIGGGHTS input text, through the templates.

The templates hold all of LIGGGHTS' syntax and the comments; here are only the numbers that neither scene nor case
carries: the box, the bins, the list of styles and the plate of a mesh wall.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from pyjkr import templating
from pyjkr.case import Case
from pyjkr.scene import Scene

DECK_NAME = "in.deck"
DUMP_NAME = "impact.dump"
MESH_NAME = "wall.stl"

# Half width of a mesh wall [m]: LIGGGHTS 3.8 refuses meshes that span less than 1e-4 length units.
PLATE_HALF_WIDTH = 1e-4
# Room around the spheres, in radii of the largest.
MARGIN_IN_RADII = 4
# Bins per side at most: a wide plate under a small sphere would ask for millions of bins.
BINS_PER_SIDE = 200
THERMO_LINES = 20


def render(case: Case, scene: Scene) -> str:
    """Text of the LIGGGHTS deck of a case.

    Parameters
    ----------
    case : Case
        What to simulate.
    scene : Scene
        Where it comes from.
    """
    name = "impact_wall.in.j2" if scene.impact.target == "wall" else "impact_pair.in.j2"
    return render_template(name, case, scene, box=box(case, scene))


def render_template(name: str, case: Case, scene: Scene, *, box: tuple[float, ...], **more: Any) -> str:
    """Text of a template of impacts.

    Parameters
    ----------
    name : str
        Of the template.
    case, scene
        As for `render`.
    box : tuple of float
        xlo xhi ylo yhi zlo zhi [m].
    more
        What the template asks for besides.
    """
    names = list(dict.fromkeys((scene.impact.material, scene.impact.struck_material)))
    environment = templating.environment()
    environment.filters["pairs"] = lambda value: " ".join([str(len(names)), *[templating.exact(value)] * len(names) ** 2])
    return environment.get_template(name).render(
        scene=scene,
        case=case,
        contact=scene.meeting,
        names=names,
        types=len(names),
        styles=contact_styles(scene),
        keywords=contact_keywords(scene),
        box=box,
        bin_size=_bin_size(case, box),
        thermo_interval=math.ceil(case.steps / THERMO_LINES),
        **more,
    )


def write(case: Case, scene: Scene, directory: Path) -> Path:
    """Write the deck, and the plate of a mesh wall, into a directory; return the deck's path.

    Parameters
    ----------
    case, scene
        As for `render`.
    directory : Path
        Made where it is missing.
    """
    directory.mkdir(parents=True, exist_ok=True)
    if scene.impact.target == "wall" and scene.impact.wall == "mesh":
        (directory / MESH_NAME).write_text(plate(plate_half_width(case)), encoding="ascii")
    deck = directory / DECK_NAME
    deck.write_text(render(case, scene), encoding="utf-8")
    return deck


def contact_styles(scene: Scene) -> str:
    """Styles that follow `gran` in pair_style and fix wall/gran."""
    model = scene.model
    words = ["model", model.normal]
    if model.tangential != "off":
        words += ["tangential", model.tangential]
    if model.rolling_friction != "off":
        words += ["rolling_friction", model.rolling_friction]
    return " ".join(words)


def contact_keywords(scene: Scene) -> str:
    """Keywords of the styles; LIGGGHTS wants them behind the styles, and in fix wall/gran behind the wall's shape."""
    model = scene.model
    words = ["eventCorrection", _switch(model.event_correction)]
    if model.tangential != "off":
        words += ["tangential_damping", _switch(model.tangential_damping)]
    if model.rolling_friction == "krijt":
        words += ["twisting", _switch(model.twisting), "rollingDamping", repr(model.rolling_damping)]
    return " ".join(words)


def _switch(value: bool) -> str:
    return "on" if value else "off"


def plate_half_width(case: Case, span: float = 0.0) -> float:
    """Half width of a mesh wall [m], under spheres that stand side by side over `span` along y."""
    return max(PLATE_HALF_WIDTH, 2 * case.tangential_speed * case.duration, 4 * span)


def box(case: Case, scene: Scene, span: float = 0.0) -> tuple[float, ...]:
    """xlo xhi ylo yhi zlo zhi [m]: room for the whole flight at no more than the speed of approach.

    Parameters
    ----------
    case, scene
        As for `render`.
    span : float
        Length along y over which spheres stand side by side [m].
    """
    margin = MARGIN_IN_RADII * max(case.radii)
    flight = case.normal_speed * case.duration
    if scene.impact.target == "sphere":
        length = sum(case.radii) + flight + margin
        return (-margin, margin, -margin, span + margin, -length, length)
    top = 2 * case.radii[0] + flight + margin
    if scene.impact.wall == "mesh":
        half = plate_half_width(case, span)
        return (-half - margin, half + margin, -0.5 * half - margin, 1.5 * half + margin, -case.radii[0], top)
    return (-margin, margin + case.tangential_speed * case.duration, -margin, span + margin, -case.radii[0], top)


def _bin_size(case: Case, box: tuple[float, ...]) -> float:
    """Half the search distance, as LIGGGHTS chooses it, but never so small that the box holds too many bins."""
    longest = max(box[1] - box[0], box[3] - box[2], box[5] - box[4])
    return max(0.5 * (2 * max(case.radii) + case.skin), longest / BINS_PER_SIDE)


def plate(half_width: float) -> str:
    """Two triangles in z = 0; paths along x from x = 0 at y < half_width/2 do not cross their common edge y = x + half_width/2."""
    h = half_width
    corners = [(-h, -0.5 * h), (h, -0.5 * h), (h, 1.5 * h), (-h, 1.5 * h)]
    lines = ["solid wall"]
    for triangle in ((0, 1, 2), (0, 2, 3)):
        lines += ["  facet normal 0 0 1", "    outer loop"]
        lines += [f"      vertex {corners[i][0]!r} {corners[i][1]!r} 0.0" for i in triangle]
        lines += ["    endloop", "  endfacet"]
    return "\n".join([*lines, "endsolid wall", ""])
