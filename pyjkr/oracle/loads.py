# Law: all loads of all contacts of an assembly at one instant, and the rates of their history vectors.
# Covers: Haervig et al. 2017 eqs 5-6, 8-22; Chen et al. 2019 eqs 1-3, 11-12 (which terms take original values:
#   sections 2.3 and 3.2 of the papers).
# Assumes: a wall is a body of infinite radius, mass and inertia that does not turn; history turns with n and with
#   the pair's mean spin about it.
"""From positions, motion and history of the touching pairs to forces, moments and history rates."""

from dataclasses import dataclass, replace

import numpy as np

from . import rolling, tangential
from .normal import (
    Model,
    NormalContact,
    contact_radius,
    damping_coefficient,
    elastic_force,
    equilibrium_contact_radius,
    indentation,
    pull_off_force,
)
from .twisting import twisting, twisting_rate
from .vectors import cross, dot


@dataclass(frozen=True)
class PairLaw:
    """Properties of one pair of materials.

    Parameters
    ----------
    effective_modulus, effective_shear_modulus : [Pa], as used in the contact law (reduced, where stiffness is reduced).
    surface_energy : [J/m2], of the normal law.
    restitution_coefficient, friction_coefficient : [-].
    adhesion_hysteresis : [-], dgamma/gamma of Krijt; or critical_rolling_angle : [rad]. With rolling exactly one of
        the two.
    surface_energy_original : [J/m2], for sliding, twisting and rolling; default surface_energy.
    effective_modulus_original : [Pa], for a_0 in the rolling and twisting limits; default effective_modulus.
    """

    effective_modulus: float
    effective_shear_modulus: float
    surface_energy: float
    restitution_coefficient: float
    friction_coefficient: float
    adhesion_hysteresis: float | None = None
    critical_rolling_angle: float | None = None
    surface_energy_original: float | None = None
    effective_modulus_original: float | None = None


@dataclass(frozen=True)
class Options:
    """What takes part: `lever_arm` is "contact" (r - overlap/2, as LIGGGHTS has it) or "radius" (r)."""

    model: Model | str = Model.SIMPLIFIED
    sliding: bool = True
    tangential_damping: bool = True
    rolling: bool = True
    rolling_damping: float = 0.0
    twisting: bool = False
    lever_arm: str = "contact"


@dataclass(frozen=True)
class Pairs:
    """Properties of pairs, one row each; `j` counts walls after the spheres. Units as in PairLaw; radius_j is
    infinite at a wall."""

    i: np.ndarray
    j: np.ndarray
    radius_i: np.ndarray
    radius_j: np.ndarray
    effective_mass: np.ndarray
    reduced_inertia: np.ndarray
    contact: NormalContact
    effective_shear_modulus: np.ndarray
    friction_coefficient: np.ndarray
    original_pull_off_force: np.ndarray
    original_radius_ratio: np.ndarray
    critical_displacement: np.ndarray

    def rows(self, rows: np.ndarray) -> "Pairs":
        """The chosen pairs."""
        names = ("effective_radius", "effective_modulus", "surface_energy", "restitution_coefficient")
        contact = replace(self.contact, **{name: getattr(self.contact, name)[rows] for name in names})
        arrays = {name: value[rows] for name, value in vars(self).items() if name != "contact"}
        return Pairs(contact=contact, **arrays)


def pairs(i, j, radius, mass, inertia, laws: list[PairLaw], options: Options) -> Pairs:
    """Gather the properties of pairs of bodies i, j (indices) from the bodies' radius [m], mass [kg], inertia [kg m2]
    and one law per pair.

    Raises
    ------
    ValueError : if rolling has no or two critical displacements.
    """

    def column(name: str, default: str | None = None) -> np.ndarray:
        values = [getattr(law, name) for law in laws]
        return np.array(
            [
                getattr(law, default) if value is None and default else value
                for law, value in zip(laws, values, strict=True)
            ],
            dtype=float,
        )

    r_i, r_j = radius[i], radius[j]
    effective_radius = 1 / (1 / r_i + 1 / r_j)
    contact = NormalContact(
        effective_radius,
        column("effective_modulus"),
        column("surface_energy"),
        options.model,
        column("restitution_coefficient"),
    )
    original = replace(
        contact,
        effective_modulus=column("effective_modulus_original", "effective_modulus"),
        surface_energy=column("surface_energy_original", "surface_energy"),
    )
    zero_load, original_zero_load = equilibrium_contact_radius(contact), equilibrium_contact_radius(original)
    hysteresis, angle = column("adhesion_hysteresis"), column("critical_rolling_angle")
    if options.rolling and np.any(np.isnan(hysteresis) == np.isnan(angle)):
        raise ValueError("rolling needs exactly one of adhesion_hysteresis and critical_rolling_angle in every law")
    krijt, chen = (
        rolling.critical_displacement_krijt(original_zero_load, hysteresis),
        rolling.critical_displacement_angle(effective_radius, angle),
    )
    return Pairs(
        i=i,
        j=j,
        radius_i=r_i,
        radius_j=r_j,
        effective_mass=1 / (1 / mass[i] + 1 / mass[j]),
        reduced_inertia=1 / (1 / inertia[i] + 1 / inertia[j]),
        contact=contact,
        effective_shear_modulus=column("effective_shear_modulus"),
        friction_coefficient=column("friction_coefficient"),
        original_pull_off_force=pull_off_force(original),
        original_radius_ratio=np.where(
            zero_load > 0, original_zero_load / np.where(zero_load > 0, zero_load, 1.0), 1.0
        ),
        critical_displacement=np.where(np.isnan(hysteresis), chen, krijt),
    )


@dataclass(frozen=True)
class Geometry:
    """Where the touching pairs are: unit vector n from i to j, overlap [m], distance of the centres [m] (infinite at
    a wall)."""

    normal: np.ndarray
    overlap: np.ndarray
    distance: np.ndarray


@dataclass(frozen=True)
class History:
    """Sliding and rolling displacement [m], twisting angle [rad] (vectors on the last axis) and which of the three
    are at their limit."""

    slip: np.ndarray
    roll: np.ndarray
    twist: np.ndarray
    slipping: np.ndarray
    yielding: np.ndarray
    spinning: np.ndarray

    def rows(self, rows: np.ndarray) -> "History":
        """The chosen contacts."""
        return History(**{name: value[rows] for name, value in vars(self).items()})


def no_history(count: int) -> History:
    """History of fresh contacts."""
    flags = (np.zeros(count, dtype=bool) for _ in range(3))
    return History(np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 1)), *flags)


@dataclass(frozen=True)
class Loads:
    """Force and torque on every body [N], [N m]; d/dt of the history; and, per contact and slider, how far beyond its
    limit (> 0 is beyond).

    `sliding_excess`, `twisting_excess`, `rolling_excess` are spring/limit - 1 where a spring holds, and -lambda where
    it yields.
    """

    force: np.ndarray
    torque: np.ndarray
    slip_rate: np.ndarray
    roll_rate: np.ndarray
    twist_rate: np.ndarray
    sliding_excess: np.ndarray
    rolling_excess: np.ndarray
    twisting_excess: np.ndarray
    normal_force: np.ndarray
    tangential_force: np.ndarray
    history: History


def loads(
    touching: Pairs,
    options: Options,
    geometry: Geometry,
    history: History,
    velocity,
    spin,
    external,
    torque,
    mass,
    inertia,
    reset=False,
) -> Loads:
    """Loads of all touching pairs on all bodies.

    Parameters
    ----------
    touching, options, geometry, history : the pairs in contact.
    velocity, spin, external, torque : of every body [m/s], [rad/s], [N], [N m]; the walls last.
    mass, inertia : of every body [kg], [kg m2], infinite for walls.
    reset : whether to work out the history with its springs cut back to their limits, for a contact that changes mode.

    Returns
    -------
    Loads; its `history` is the one given, or with `reset` the one cut back to the limits.
    """
    p, i, j, n, overlap = touching, touching.i, touching.j, geometry.normal, geometry.overlap
    v_i, v_j, w_i, w_j = velocity[i], velocity[j], spin[i], spin[j]
    shrink = 0.5 * overlap if options.lever_arm == "contact" else 0.0 * overlap
    wall = np.isinf(p.radius_j)
    arm_i, arm_j = (
        (p.radius_i - shrink)[:, None],
        np.where(wall, 0.0, np.where(wall, 0.0, p.radius_j) - shrink)[:, None],
    )

    overlap_rate = dot(v_i - v_j, n)[:, 0]
    normal_rate = ((v_j - v_i) + n * overlap_rate[:, None]) / geometry.distance[:, None]
    frame = cross(n, normal_rate) + 0.5 * n * dot(w_i + w_j, n)
    slip_velocity = tangential.slip_velocity(v_i, v_j, w_i, w_j, arm_i, arm_j, n)

    indented = indentation(p.contact, overlap)
    elastic = elastic_force(p.contact, indented)
    normal_force = elastic + damping_coefficient(p.contact, indented, p.effective_mass) * overlap_rate
    on_i, moment = -n * normal_force[:, None], np.zeros_like(n)
    flat = np.zeros(len(overlap))

    slip, resisting = (
        history.slip - n * dot(history.slip, n),
        np.zeros_like(n),
    )  # n . slip is 0 up to the integrator's error
    if (
        options.sliding or options.twisting
    ):  # twisting takes k_T, eta_T and F_S,crit from sliding, whether or not the contact resists sliding
        slider = tangential.sliding(
            p.contact,
            p.effective_shear_modulus,
            p.friction_coefficient,
            p.original_pull_off_force,
            p.effective_mass,
            indented,
            options.tangential_damping,
            slopes=bool(history.slipping.any() or history.spinning.any()),
        )
    if options.sliding:
        resisting = tangential.resistance(slider, slip, slip_velocity, history.slipping)
        on_i = on_i - resisting

    roll, roll_velocity, yield_rate, roll_length = history.roll - n * dot(history.roll, n), np.zeros_like(n), flat, flat
    if options.rolling:
        roll_velocity = rolling.rolling_velocity(p.radius_i, p.radius_j, w_i, w_j, n, slip_velocity)
        roll_length = np.linalg.norm(roll, axis=-1)
        outward = roll / np.where(roll_length > 0, roll_length, 1.0)[:, None]
        yield_rate = dot(outward, roll_velocity)[:, 0]
        held = np.where(history.yielding[:, None], p.critical_displacement[:, None] * outward, roll)
        zero_load = equilibrium_contact_radius(p.contact)
        ratio = contact_radius(p.contact, indented) / np.where(zero_load > 0, zero_load, np.inf)
        stiffness = rolling.rolling_stiffness(p.original_pull_off_force, ratio)
        dashpot = rolling.rolling_damping(
            options.rolling_damping, stiffness, p.reduced_inertia, p.contact.effective_radius
        )
        moment = moment + rolling.rolling_moment(stiffness, dashpot, held, roll_velocity, n)
        roll_velocity = roll_velocity - np.where(history.yielding[:, None], outward * yield_rate[:, None], 0.0)

    twist_velocity = np.zeros_like(history.twist)
    if options.twisting:
        slider_twist = twisting(p.contact, slider, indented, p.original_radius_ratio)
        twist_velocity = twisting_rate(w_i, w_j, n)
        moment = moment - n * tangential.resistance(slider_twist, history.twist, twist_velocity, history.spinning)

    force, total_torque = external.copy(), torque.copy()
    np.add.at(force, i, on_i)
    np.add.at(force, j, -on_i)
    np.add.at(total_torque, i, arm_i * cross(n, -resisting) + moment)
    np.add.at(total_torque, j, arm_j * cross(n, -resisting) - moment)

    sliding_excess, slip_rate = flat - 1, slip_velocity
    if options.sliding:
        slip_rate, sliding_excess = _flow(slider, slip, slip_velocity, overlap_rate, history.slipping)
    twisting_excess, twist_rate = flat - 1, twist_velocity
    if options.twisting:
        twist_rate, twisting_excess = _flow(slider_twist, history.twist, twist_velocity, overlap_rate, history.spinning)
    rolling_excess = flat - 1
    if options.rolling:
        critical = np.where(p.critical_displacement > 0, p.critical_displacement, np.inf)
        rolling_excess = np.where(history.yielding, -yield_rate, roll_length / critical - 1)
    limited = History(
        slip=tangential.returned_displacement(slider, slip) if reset and options.sliding else history.slip,
        roll=rolling.truncated_displacement(roll, p.critical_displacement)
        if reset and options.rolling
        else history.roll,
        twist=tangential.returned_displacement(slider_twist, history.twist)
        if reset and options.twisting
        else history.twist,
        slipping=history.slipping,
        yielding=history.yielding,
        spinning=history.spinning,
    )
    return Loads(
        force=force,
        torque=total_torque,
        slip_rate=slip_rate + cross(frame, history.slip),
        roll_rate=roll_velocity + cross(frame, history.roll),
        twist_rate=twist_rate,
        sliding_excess=sliding_excess,
        rolling_excess=rolling_excess,
        twisting_excess=twisting_excess,
        normal_force=normal_force,
        tangential_force=-resisting,
        history=limited,
    )


def _flow(slider: tangential.Slider, displacement, velocity, overlap_rate, yielding) -> tuple[np.ndarray, np.ndarray]:
    """Rate of a spring, and how far beyond its limit it is, or how far from holding again."""
    load = slider.stiffness * np.sqrt(dot(displacement, displacement))[:, 0]
    excess = np.where(
        slider.limit > 0, load / np.where(slider.limit > 0, slider.limit, 1.0) - 1, -1.0
    )  # no limit, no load
    if not yielding.any():
        return velocity, excess
    rate = np.where(yielding[:, None], tangential.plastic_rate(slider, displacement, velocity, overlap_rate), velocity)
    return rate, np.where(yielding, -tangential.slip_rate(slider, displacement, velocity, overlap_rate), excess)
