"""A bed -> the flat rows that a study keeps of it. Chen, Liu and Li 2019, figs 8 to 12.

Covers the numbers of the middle of the bed, the distributions as counts in bins, and the spheres of a snapshot.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from pyjkr.packing.bed import Bed
from pyjkr.packing.scene import PackingScene

# Bins of the distributions: lowest edge, highest edge, number. Overlaps in delta_e, forces in their mean magnitude.
BINS = {
    "local_packing_fraction": (0.0, 0.8, 40),
    "coordination_number": (-0.5, 12.5, 13),
    "overlap": (-1.0, 3.0, 200),
    "normal_force": (-8.0, 8.0, 64),
}


def summary(scene: PackingScene, bed: Bed) -> dict[str, Any]:
    """What one packing comes to, middle of the bed.

    Lengths named after overlaps and the radius in m, heights in r, energy in that of the inlet, forces in F_C.
    """
    middle, held = bed.middle, bed.middle_contacts
    forces = bed.normal_forces[held]
    return {
        "radius": scene.radius,
        "packing_fraction": bed.packing_fraction,
        "slab_packing_fraction": bed.slab_packing_fraction,
        "coordination_number": float(np.mean(bed.coordination_numbers[middle])),
        "spheres": len(bed.positions),
        "middle_spheres": int(np.sum(middle)),
        "middle_contacts": int(np.sum(held)),
        "flying_spheres": int(np.sum(~bed.settled)),
        "bed_height": bed.height / bed.radius,
        "lowest_centre": float(np.min(bed.positions[:, 2])) / bed.radius,
        "smallest_distance": 1 - float(np.max(bed.overlaps)) / (2 * bed.radius),
        "kinetic_energy_left": bed.kinetic_energy / scene.inlet_energy,
        "equilibrium_overlap": scene.equilibrium_overlap,
        "mean_overlap": float(np.mean(bed.overlaps[held])),
        "mean_normal_force": float(np.mean(forces)) / scene.pair.pull_off_force,
        "mean_normal_force_magnitude": float(np.mean(np.abs(forces))) / scene.pair.pull_off_force,
        "attractive_share": float(np.mean(forces < 0)),
        "neck_share": float(np.mean(bed.overlaps[held] < 0)),
        "time_step": scene.time_step,
        "limiting_mode": scene.limiting_mode,
    }


def distributions(scene: PackingScene, bed: Bed) -> Iterator[dict[str, Any]]:
    """Counts in the bins of `BINS`; `total` counts values outside of them too."""
    middle, held = bed.middle, bed.middle_contacts
    forces = bed.normal_forces[held]
    samples = {
        "local_packing_fraction": bed.local_packing_fractions[middle],
        "coordination_number": bed.coordination_numbers[middle],
        "overlap": bed.overlaps[held] / scene.equilibrium_overlap,
        "normal_force": forces / np.mean(np.abs(forces)),
    }
    for quantity, values in samples.items():
        low, high, bins = BINS[quantity]
        counts, edges = np.histogram(values, bins=bins, range=(low, high))
        for start, end, count in zip(edges[:-1].tolist(), edges[1:].tolist(), counts.tolist(), strict=True):
            yield {"quantity": quantity, "low": start, "high": end, "count": count, "total": len(values)}


def spheres(bed: Bed) -> Iterator[dict[str, Any]]:
    """Places [r] and contacts of all spheres."""
    contacts = bed.coordination_numbers
    for place, count, settled in zip((bed.positions / bed.radius).tolist(), contacts.tolist(), bed.settled.tolist(), strict=True):
        yield {**dict(zip("xyz", place, strict=True)), "contacts": count, "settled": settled, "box": bed.box / bed.radius}
