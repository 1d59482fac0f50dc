"""What the contact law of a deck is made of: styles, properties of every pair of materials, lengths of the contacts.

Covers Haervig 2017 eqs 2 and 24 for every pair of materials, at one ratio q = E_mod/E for all of them.
Assumes spheres; a wall is a sphere of infinite radius and mass.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

from pyjkr import contact as contact_laws
from pyjkr import scaling
from pyjkr.application.scene import Application
from pyjkr.contact import PairProperties
from pyjkr.errors import PlanError
from pyjkr.planning.styles import Styles
from pyjkr.planning.variants import Variant
from pyjkr.scene import Contact

# Range of youngsModulus that LIGGGHTS 3.8 accepts without `soft_particles` and `hard_particles` [Pa].
SOFTEST, HARDEST = 5e6, 1e9


@dataclass(frozen=True)
class Body:
    """A sphere, or a wall where `radius` is None."""

    material: str
    radius: float | None = None


@dataclass(frozen=True, kw_only=True)
class Law:
    """Contact law of a deck.

    Attributes
    ----------
    scene : Application
        Gives the real material.
    variant : Variant
        What is simulated, and how soft.
    """

    scene: Application
    variant: Variant

    @property
    def styles(self) -> Styles:
        """Names of the models."""
        return self.variant.styles

    @property
    def modulus_ratio(self) -> float:
        """q = E_mod/E."""
        return self.variant.modulus_ratio

    @property
    def adhesive(self) -> bool:
        """Whether a jkr model is used; stock `hertz` otherwise."""
        return self.styles.normal != "hertz"

    @property
    def originals(self) -> bool:
        """Whether the rolling, sliding and twisting limits keep the real surface energy and moduli."""
        return self.styles.original_limits and self.variant.modulus_ratio < 1

    @property
    def keywords(self) -> str:
        """Keywords behind the styles, only those that differ from the defaults of the plug-in."""
        words = [self.styles.keywords] if self.styles.keywords else []
        if self.styles.rolling_friction == "krijt" and self.scene.numerics.rolling_damping > 0:
            words += ["rollingDamping", repr(self.scene.numerics.rolling_damping)]
        return " ".join(words)

    def youngs_modulus(self, material: str) -> float:
        """Of the contact law [Pa], E_mod = q E."""
        return self.scene.material[material].youngs_modulus * self.modulus_ratio

    def surface_energy(self, contact: Contact) -> float:
        """gamma of the normal law [J/m2]; Haervig 2017, eq. 24; 0 where adhesion is off."""
        return scaling.surface_energy_mod(contact.surface_energy, self.modulus_ratio) if self.adhesive else 0.0

    def restitution_coefficient(self, contact: Contact) -> float:
        """e of the contact law; 1 where damping is off."""
        return contact.restitution_coefficient if self.styles.damping else 1.0

    def matrix(self, value: Callable[[Contact], float | None]) -> list[float]:
        """A property of all pairs of atom types, row by row; pairs that never meet take the value of the first contact."""
        given = {frozenset(contact.between): contact for contact in self.scene.contact}
        rows = itertools.product(self.scene.materials, repeat=2)
        return [value(given.get(frozenset(pair), self.scene.contact[0])) for pair in rows]

    @property
    def stiffness_commands(self) -> tuple[str, ...]:
        """`hard_particles`, `soft_particles`, both or none: what LIGGGHTS asks for outside its usual range of moduli."""
        moduli = [self.youngs_modulus(name) for name in self.scene.materials]
        hard, soft = any(value > HARDEST for value in moduli), any(value < SOFTEST for value in moduli)
        return (("hard_particles",) if hard else ()) + (("soft_particles",) if soft else ())

    def properties(self, first: Body, second: Body) -> PairProperties:
        """Effective properties of two bodies in this law."""
        properties = pair_properties(self.scene, first, second, self.modulus_ratio if self.adhesive else 1.0)
        if self.adhesive:
            return properties
        return pair_properties(self.scene, first, second, self.modulus_ratio, surface_energy=0.0)

    @property
    def neck(self) -> float:
        """Longest neck [m]: delta_C of the largest spheres at the wall or at each other; 0 where contacts end at zero overlap."""
        if self.styles.normal != "jkr":
            return 0.0
        return max(-contact_laws.rupture_overlap(self.properties(*bodies), "jkr") for bodies in extremes(self.scene))

    def equilibrium_overlap(self, first: Body, second: Body) -> float:
        """delta_0 = a_0^2/(3 R) [m]; Haervig 2017, eq. 7 in eq. A.9."""
        pair = self.properties(first, second)
        return pair.equilibrium_contact_radius**2 / (3 * pair.effective_radius)


def law(scene: Application, variant: Variant) -> Law:
    """The contact law of a scene in a variant.

    Raises
    ------
    PlanError
        Where an effect that is on lacks its property.
    """
    styles = variant.styles
    for contact in scene.contact:
        where = f"{scene.source}: contact '{contact.between[0]}'-'{contact.between[1]}'"
        if styles.needs_friction and contact.friction_coefficient is None:
            raise PlanError(
                f"{where}: friction_coefficient is missing; '{styles.text}' needs it. Give it, or set [effects] sliding = 'off'."
            )
        if styles.rolling_friction == "epsd2":
            if contact.coefficient_rolling_friction is None:
                raise PlanError(
                    f"{where}: coefficient_rolling_friction is missing; rolling without adhesion needs it."
                    " Give it, or set [effects] rolling = 'off'."
                )
            if styles.tangential == "off":
                raise PlanError(f"{scene.source}: rolling without adhesion is limited by friction. Set [effects] sliding = 'on'.")
        if styles.rolling_friction == "krijt" and contact.adhesion_hysteresis is None and contact.critical_rolling_angle is None:
            raise PlanError(
                f"{where}: rolling needs adhesion_hysteresis or critical_rolling_angle. Give one, or set [effects] rolling = 'off'."
            )
    kinds = {contact.adhesion_hysteresis is None for contact in scene.contact}
    if styles.rolling_friction == "krijt" and len(kinds) > 1:
        raise PlanError(f"{scene.source}: some contacts give adhesion_hysteresis, others critical_rolling_angle. Give the same for all.")
    return Law(scene=scene, variant=variant)


def extremes(scene: Application) -> list[tuple[Body, Body]]:
    """Every pair of materials that meets, with smallest and largest radii; the wall last."""
    sizes: dict[str, set[float]] = {}
    for entry in scene.particles:
        every = [radius for radius, _ in entry.classes]
        sizes.setdefault(entry.material, set()).update((min(every), max(every)))
    # Between the smallest and the largest class of a material in several entries nothing is extreme.
    spheres = [Body(name, radius) for name, radii in sizes.items() for radius in sorted({min(radii), max(radii)})]
    pairs = [] if scene.start == "single" else list(itertools.combinations_with_replacement(spheres, 2))
    if scene.start == "pair" and len(spheres) == 2:
        pairs = [(spheres[0], spheres[1])]
    walls = [(sphere, Body(scene.wall.material)) for sphere in spheres] if scene.wall else []
    return pairs + walls


def mass(scene: Application, body: Body) -> float:
    """Of a sphere [kg]; infinite for a wall."""
    if body.radius is None:
        return math.inf
    return 4 / 3 * math.pi * body.radius**3 * scene.material[body.material].density


def pair_properties(
    scene: Application, first: Body, second: Body, modulus_ratio: float = 1.0, surface_energy: float | None = None
) -> PairProperties:
    """Effective properties of two bodies, real ones at q = 1; Haervig 2017, eqs 2, 15 and 24.

    Parameters
    ----------
    scene : Application
        Gives the materials.
    first, second : Body
        Two spheres, or a sphere and a wall.
    modulus_ratio : float
        q = E_mod/E.
    surface_energy : float, optional
        gamma to use in place of the contact's [J/m2].
    """
    contact = scene.pair(first.material, second.material)
    materials = [scene.material[body.material] for body in (first, second)]
    moduli = tuple(material.youngs_modulus * modulus_ratio for material in materials)
    ratios = tuple(material.poissons_ratio for material in materials)
    spheres = [body for body in (first, second) if body.radius is not None]
    real = contact.surface_energy if surface_energy is None else surface_energy
    return PairProperties(
        effective_radius=1 / sum(1 / body.radius for body in spheres),
        effective_mass=1 / sum(1 / mass(scene, body) for body in spheres),
        effective_inertia=1 / sum(1 / (0.4 * mass(scene, body) * body.radius**2) for body in spheres),
        effective_modulus=contact_laws.effective_modulus(moduli, ratios),
        effective_shear_modulus=contact_laws.effective_shear_modulus(moduli, ratios),
        surface_energy=scaling.surface_energy_mod(real, modulus_ratio),
        surface_energy_of_rolling=real,
        restitution_coefficient=contact.restitution_coefficient,
    )
