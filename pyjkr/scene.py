"""Scene files: TOML -> a frozen, validated `Scene` in SI units.

Covers what a user states about an impact: laws, materials, contacts, speeds and the stiffness reductions to compare.
Every fault ends in one `SceneError` line that names the file, the table, the key, the rule and what to do instead.
"""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from pyjkr.errors import SceneError
from pyjkr.scene_errors import explain


class _Table(BaseModel):
    """A TOML table: no unknown keys, no silent conversion, no NaN or infinity, no change after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


def _quantity(unit: str, remedy: str, **limits: Any) -> Any:
    """Field of a number, with the unit and the remedy that its error message prints."""
    return Field(json_schema_extra={"unit": unit, "remedy": remedy}, **limits)


def _fault(message: str) -> PydanticCustomError:
    """An error of two keys together; `message` is printed as it stands, behind file and table."""
    return PydanticCustomError("scene", "{text}", {"text": message})


def _refuse_repeats(key: str, values: tuple[float, ...]) -> None:
    for index, value in enumerate(values):
        if any(math.isclose(value, other, rel_tol=1e-12) for other in values[:index]):
            raise _fault(f"{key} holds {value!r} twice. Remove one.")


class Model(_Table):
    """Contact laws, named as in the deck."""

    normal: Literal["jkr/simplified", "jkr"]
    tangential: Literal["off", "no_history", "history", "jkr"]
    rolling_friction: Literal["off", "epsd2", "krijt"]
    tangential_damping: bool = True
    event_correction: bool = True
    twisting: bool = False
    rolling_damping: Annotated[float, _quantity("", "Set 0 for none.", ge=0)] = 0.0

    @model_validator(mode="after")
    def _krijt_keys_need_krijt(self) -> Model:
        if self.rolling_friction != "krijt":
            if self.twisting:
                raise _fault("twisting = true needs rolling_friction = 'krijt'. Change one of the two.")
            if self.rolling_damping > 0:
                raise _fault("rolling_damping > 0 needs rolling_friction = 'krijt'. Change one of the two.")
        return self


class Material(_Table):
    """Bulk properties of one material."""

    poissons_ratio: Annotated[float, _quantity("", "LIGGGHTS accepts 0 to 0.5.", ge=0, le=0.5)]
    density: Annotated[float, _quantity("kg/m3", "Give the density of the solid.", gt=0)] | None = None
    youngs_modulus: Annotated[float, _quantity("Pa", "Give the unreduced value.", gt=0)] | None = None


class Contact(_Table):
    """Properties of a pair of materials."""

    between: tuple[str, str]
    surface_energy: Annotated[float, _quantity("J/m2", "Set 0 for plain Hertz contact.", ge=0)]
    restitution_coefficient: Annotated[float, _quantity("", "LIGGGHTS accepts 0.05 < e <= 1.", gt=0.05, le=1)]
    friction_coefficient: Annotated[float, _quantity("", "Set 0 for a frictionless contact.", ge=0)] | None = None
    adhesion_hysteresis: Annotated[float, _quantity("", "Set 0 for free rolling.", ge=0)] | None = None
    critical_rolling_angle: Annotated[float, _quantity("rad", "Set 0 for free rolling.", ge=0)] | None = None
    coefficient_rolling_friction: Annotated[float, _quantity("", "Set 0 for free rolling.", ge=0)] | None = None
    effective_modulus: Annotated[float, _quantity("Pa", "Give the unreduced value.", gt=0)] | None = None

    @model_validator(mode="after")
    def _one_rolling_limit(self) -> Contact:
        if self.adhesion_hysteresis is not None and self.critical_rolling_angle is not None:
            raise _fault(
                "adhesion_hysteresis and critical_rolling_angle both set the limit of rolling and contradict each other."
                " Keep one: the first is Krijt's, the second Dominik and Tielens'."
            )
        return self


class Impact(_Table):
    """One sphere flying at a wall or at another sphere, at several speeds."""

    material: str
    target: Literal["wall", "sphere"]
    speeds: Annotated[tuple[Annotated[float, _quantity("m/s", "Give the speed of approach.", gt=0)], ...], Field(min_length=1)]
    steps_per_collision: Annotated[int, _quantity("", "Haervig 2017 sec. 6.2 suggests about 50; 2000 for verification.", ge=10)]
    radius: Annotated[float, _quantity("m", "Give the radius of the flying sphere.", gt=0)] | None = None
    diameter: Annotated[float, _quantity("m", "Give the diameter of the flying sphere.", gt=0)] | None = None
    wall: Literal["primitive", "mesh"] = "primitive"
    wall_material: str | None = None
    target_radius: Annotated[float, _quantity("m", "Give the radius of the sphere that is hit.", gt=0)] | None = None
    target_material: str | None = None
    angle: Annotated[float, _quantity("degrees", "It is measured from the surface normal.", ge=0, lt=90)] = 0.0
    phase: Annotated[float, _quantity("", "It is the fraction of a step at which contact begins.", ge=0, lt=1)] = 0.5

    @property
    def sphere_radius(self) -> float:
        """Radius of the flying sphere [m]."""
        return self.radius if self.radius is not None else 0.5 * self.diameter

    @property
    def struck_material(self) -> str:
        """Name of the material that is hit."""
        return self.wall_material if self.target == "wall" else self.target_material

    @model_validator(mode="after")
    def _target_is_complete(self) -> Impact:
        if (self.radius is None) == (self.diameter is None):
            raise _fault("the sphere needs either radius or diameter [m]. Give exactly one of them.")
        sphere_keys = ("target_radius", "target_material")
        if self.target == "wall":
            if self.wall_material is None:
                raise _fault("target = 'wall' needs wall_material. Name one of the [material.NAME] tables.")
            wanted = [key for key in sphere_keys if getattr(self, key) is not None]
            if wanted:
                raise _fault(f"{wanted[0]} belongs to target = 'sphere'. Remove it or change the target.")
            return self
        for key in sphere_keys:
            if getattr(self, key) is None:
                raise _fault(f"target = 'sphere' needs {key}. Add it, or set target = 'wall'.")
        for key in ("wall", "wall_material"):
            if key in self.model_fields_set:
                raise _fault(f"{key} belongs to target = 'wall'. Remove it or change the target.")
        if self.angle > 0:
            raise _fault(
                f"angle = {self.angle!r} degrees needs target = 'wall': between two spheres the line of centres turns"
                " during contact and the rebound has no fixed normal. Set angle = 0."
            )
        return self

    @model_validator(mode="after")
    def _speeds_differ(self) -> Impact:
        _refuse_repeats("speeds", self.speeds)
        return self


class Reduction(_Table):
    """Reduced stiffnesses to compare (Haervig 2017, eq. 24)."""

    modulus_ratios: Annotated[
        tuple[Annotated[float, _quantity("", "It is E_mod/E; 1 is the real stiffness.", gt=0, le=1)], ...], Field(min_length=1)
    ] = (1.0,)
    unmodified_ratios: tuple[Annotated[float, _quantity("", "It is E_mod/E; 1 is the real stiffness.", gt=0, le=1)], ...] = ()
    use_original_surface_energy: bool = False
    maximum_overlap: Annotated[float, _quantity("R", "It is a fraction of the effective radius.", gt=0, le=1)] = 0.5

    @model_validator(mode="after")
    def _ratios_differ(self) -> Reduction:
        _refuse_repeats("modulus_ratios", self.modulus_ratios)
        _refuse_repeats("unmodified_ratios", self.unmodified_ratios)
        if 1.0 in self.unmodified_ratios and 1.0 in self.modulus_ratios:
            raise _fault("unmodified_ratios = 1.0 repeats modulus_ratios = 1.0: the rules agree there. Remove it.")
        return self


class Environment(_Table):
    """What may pull at a contact in the real application: drag, weight, a shaken wall.

    A check only: the impacts are simulated without these forces. Reduced stiffness goes with a reduced pull-off force,
    q^(2/5) F_C, while outer forces stay as they are (Haervig 2017, eq. 24): the plan compares the two.
    """

    external_force: Annotated[float, _quantity("N", "Give the strongest force that may pull a contact apart.", ge=0)] = 0.0
    acceleration: Annotated[float, _quantity("m/s2", "It acts on the mass of a sphere; 9.81 for its weight.", ge=0)] = 0.0


class Numerics(_Table):
    """Settings of the neighbour search; the plan chooses what is left out."""

    skin: Annotated[float, _quantity("m", "Leave it out and the plan chooses one.", gt=0)] | None = None


class Figures(_Table):
    """What the figures show."""

    velocity_speed: Annotated[float, _quantity("m/s", "Name one of impact.speeds.", gt=0)] | None = None


class Scene(_Table):
    """A validated scene file. Quantities are in SI units."""

    title: str
    model: Model
    material: dict[str, Material]
    contact: Annotated[tuple[Contact, ...], Field(min_length=1)]
    impact: Impact
    reduction: Reduction = Reduction()
    environment: Environment = Environment()
    numerics: Numerics = Numerics()
    figures: Figures = Figures()
    source: Annotated[str, Field(init=False)] = "scene"

    @property
    def meeting(self) -> Contact:
        """The contact of the two materials that meet in the impact."""
        pair = {self.impact.material, self.impact.struck_material}
        return next(contact for contact in self.contact if set(contact.between) == pair)

    @model_validator(mode="after")
    def _names_and_pairs_match(self) -> Scene:
        if not self.title.isprintable():
            raise _fault("title must be one line of printable characters.")
        named = [("impact", self.impact.material), ("impact", self.impact.struck_material)]
        named += [("contact", name) for contact in self.contact for name in contact.between]
        for table, name in named:
            if name not in self.material:
                known = ", ".join(repr(key) for key in self.material)
                raise _fault(f"{table} names material '{name}', which has no table. Add [material.{name}] or use one of {known}.")
        pairs = [frozenset(contact.between) for contact in self.contact]
        for index, pair in enumerate(pairs):
            if pair in pairs[:index]:
                raise _fault(f"contact {_pair(self.contact[index])} is given twice. Keep one of them.")
        wanted = frozenset((self.impact.material, self.impact.struck_material))
        if wanted not in pairs:
            between = f'["{self.impact.material}", "{self.impact.struck_material}"]'
            raise _fault(f"the impact needs a [[contact]] with between = {between}. Add it.")
        if len(pairs) > 1:
            spare = self.contact[next(index for index, pair in enumerate(pairs) if pair != wanted)]
            raise _fault(f"contact {_pair(spare)} never happens in this impact. Remove it.")
        if self.material[self.impact.material].density is None:
            raise _fault(f"material '{self.impact.material}': density is missing. Give it in kg/m3.")
        if self.impact.target == "sphere" and self.material[self.impact.struck_material].density is None:
            raise _fault(f"material '{self.impact.struck_material}': density is missing. Give it in kg/m3.")
        return self

    @model_validator(mode="after")
    def _shown_speed_is_simulated(self) -> Scene:
        shown = self.figures.velocity_speed
        if shown is not None and shown not in self.impact.speeds:
            raise _fault(f"figures: velocity_speed = {shown!r} m/s is not in impact.speeds. Name one of them.")
        return self

    @model_validator(mode="after")
    def _stiffness_is_given_once(self) -> Scene:
        contact = self.meeting
        for name in contact.between:
            modulus = self.material[name].youngs_modulus
            if contact.effective_modulus is not None and modulus is not None:
                raise _fault(
                    f"contact {_pair(contact)}: effective_modulus contradicts youngs_modulus of material '{name}'."
                    " Keep the effective value (papers quote it) or those of both materials."
                )
            if contact.effective_modulus is None and modulus is None:
                raise _fault(
                    f"material '{name}': youngs_modulus is missing. Give it in Pa, or effective_modulus in"
                    f" contact {_pair(contact)}."
                )
        return self

    @model_validator(mode="after")
    def _laws_have_their_parameters(self) -> Scene:
        contact, where = self.meeting, f"contact {_pair(self.meeting)}"
        if (self.model.tangential != "off" or self.model.twisting) and contact.friction_coefficient is None:
            what = "twisting = true" if self.model.tangential == "off" else f"tangential = '{self.model.tangential}'"
            raise _fault(f"{where}: friction_coefficient is missing. model.{what} needs it.")
        if self.model.rolling_friction == "epsd2":
            if contact.coefficient_rolling_friction is None:
                raise _fault(f"{where}: coefficient_rolling_friction is missing. rolling_friction = 'epsd2' needs it.")
            if self.model.tangential == "off":
                raise _fault("model: rolling_friction = 'epsd2' limits its moment by friction. Set tangential too.")
        if self.model.rolling_friction == "krijt":
            if contact.adhesion_hysteresis is None and contact.critical_rolling_angle is None:
                raise _fault(
                    f"{where}: rolling_friction = 'krijt' needs adhesion_hysteresis or critical_rolling_angle. Give one of them."
                )
            if contact.surface_energy == 0:
                raise _fault(
                    f"{where}: surface_energy = 0 leaves rolling_friction = 'krijt' without any moment."
                    " Set rolling_friction = 'off', or a surface energy."
                )
        return self


_Scene = TypeVar("_Scene", bound=_Table)


def load(path: str | Path) -> Scene:
    """Read and validate a scene file.

    Parameters
    ----------
    path : str or Path
        TOML file.

    Returns
    -------
    Scene
        Frozen; all quantities in SI units.

    Raises
    ------
    SceneError
        One line: file, table, key, rule, remedy.
    """
    return validated(Scene, Path(path))


def validated(model: type[_Scene], path: Path) -> _Scene:
    """A scene file as `model`; raises as `load`."""
    content = read(path)
    if "source" in content:
        raise SceneError(f"{path}: unknown key 'source'. Remove it.")
    try:
        return model.model_validate(_tuples(content | {"source": path.name}))
    except ValidationError as error:
        raise SceneError(f"{path}: {explain(error, content, model)}") from error


def read(path: Path) -> dict[str, Any]:
    """Tables of a TOML file, a byte order mark at its start left aside; raises as `load`."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}. Name a scene file or a shipped case.") from error
    except UnicodeDecodeError as error:
        raise SceneError(f"{path}: is not a text file in UTF-8. TOML needs that encoding.") from error
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"{path}: is not valid TOML: {error}") from error


def _tuples(value: Any) -> Any:
    """TOML arrays as tuples, so that a frozen scene holds nothing that can change."""
    if isinstance(value, dict):
        return {key: _tuples(item) for key, item in value.items()}
    return tuple(_tuples(item) for item in value) if isinstance(value, list) else value


def _pair(contact: Contact) -> str:
    return f"'{contact.between[0]}'-'{contact.between[1]}'"
