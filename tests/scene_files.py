"""Scene files for the tests. No two numbers are equal and none of the physical ones is 1."""

from __future__ import annotations

from pathlib import Path

# Dahneke's sphere, Haervig 2017, fig. 5, at a few speeds and coarse steps.
DAHNEKE = """\
title = "Dahneke in short"

[model]
normal = "jkr/simplified"
tangential = "off"
rolling_friction = "off"

[material.polystyrene]
density = 1026.0
poissons_ratio = 0.33

[material.quartz]
poissons_ratio = 0.17

[[contact]]
between = ["polystyrene", "quartz"]
effective_modulus = 271e6
surface_energy = 0.11
restitution_coefficient = 0.86

[impact]
diameter = 1.27e-6
material = "polystyrene"
target = "wall"
wall_material = "quartz"
speeds = [2.0, 3.2, 5.0]
steps_per_collision = 200
phase = 0.37

[reduction]
modulus_ratios = [1.0, 0.1]
unmodified_ratios = [0.2]

[figures]
velocity_speed = 5.0
"""

# Two unlike spheres with every law switched on.
PAIR = """\
title = "Silica meets polystyrene"

[model]
normal = "jkr"
tangential = "jkr"
rolling_friction = "krijt"
twisting = true
rolling_damping = 0.3

[material."silica & co"]
density = 2200.0
youngs_modulus = 7.0e10
poissons_ratio = 0.17

[material.polystyrene]
density = 1050.0
youngs_modulus = 3.4e9
poissons_ratio = 0.34

[[contact]]
between = ["polystyrene", "silica & co"]
surface_energy = 0.04
restitution_coefficient = 0.8
friction_coefficient = 0.4
adhesion_hysteresis = 0.35

[impact]
radius = 0.7e-6
material = "silica & co"
target = "sphere"
target_radius = 1.9e-6
target_material = "polystyrene"
speeds = [0.3, 1.5]
steps_per_collision = 150
phase = 0.21

[reduction]
modulus_ratios = [0.5, 0.001]
use_original_surface_energy = true
"""

# A glass sphere that hits a mesh obliquely; one material on both sides.
MESH = """\
title = "Oblique impact on a mesh"

[model]
normal = "jkr/simplified"
tangential = "history"
rolling_friction = "epsd2"

[material.glass]
density = 2500.0
youngs_modulus = 6.0e10
poissons_ratio = 0.23

[[contact]]
between = ["glass", "glass"]
surface_energy = 0.03
restitution_coefficient = 0.9
friction_coefficient = 0.32
coefficient_rolling_friction = 0.06

[impact]
diameter = 3e-6
material = "glass"
target = "wall"
wall = "mesh"
wall_material = "glass"
speeds = [0.5]
angle = 40.0
steps_per_collision = 120

[reduction]
modulus_ratios = [1.0, 0.01]
"""


def edited(text: str, *changes: tuple[str, str]) -> str:
    """`text` with each first string replaced by the second; the first must be there."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return text


def written(directory: Path, text: str, name: str = "scene.toml") -> Path:
    """`text` in a file."""
    path = directory / name
    path.write_text(text, encoding="utf-8")
    return path
