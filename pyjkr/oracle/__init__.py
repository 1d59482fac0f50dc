"""Adhesive contact by other means than the plug-in: bracketed roots and adaptive integration, written from the papers
alone."""

from .assembly import Trajectory, follow
from .bodies import Assembly, Wall, pair_table
from .impact import Impact, impact, sticking_speed
from .loads import Options, PairLaw
from .normal import (
    Model,
    NormalContact,
    contact_radius,
    damping_coefficient,
    damping_ratio,
    effective_modulus,
    effective_radius,
    elastic_force,
    equilibrium_contact_radius,
    equilibrium_overlap,
    normal_stiffness,
    pull_off_force,
    rupture_overlap,
    stored_energy,
)
from .segment import Event
from .tangential import effective_shear_modulus

__all__ = [
    "Assembly",
    "Event",
    "Impact",
    "Model",
    "NormalContact",
    "Options",
    "PairLaw",
    "Trajectory",
    "Wall",
    "contact_radius",
    "damping_coefficient",
    "damping_ratio",
    "effective_modulus",
    "effective_radius",
    "effective_shear_modulus",
    "elastic_force",
    "equilibrium_contact_radius",
    "equilibrium_overlap",
    "follow",
    "impact",
    "normal_stiffness",
    "pair_table",
    "pull_off_force",
    "rupture_overlap",
    "sticking_speed",
    "stored_energy",
]
