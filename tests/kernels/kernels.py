"""The C++ kernels from Python.

One function for each C wrapper of liggghts_src/kernels_capi.cpp, numpy arrays in and out.

Looks for the library in `build/` of the checkout, then in the installed package. SI units; vectors are xyz.
"""

from __future__ import annotations

import ctypes
import importlib.util
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

LIBRARY = "libpyjkr_kernels.so"

_DOUBLE = ctypes.c_double
_ARRAY = np.ctypeslib.ndpointer(dtype=np.float64, flags="C_CONTIGUOUS")


def library_path() -> Path:
    """Where the library lies; an error that says how to build it where it does not."""
    candidates = [Path(__file__).resolve().parents[2] / "build" / LIBRARY]
    package = importlib.util.find_spec("pyjkr")
    if package and package.origin:
        candidates.append(Path(package.origin).parent / "lib" / LIBRARY)
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    raise FileNotFoundError(
        f"{LIBRARY} is in none of {', '.join(map(str, candidates))}. Build it: cmake -B build && cmake --build build"
    )


@cache
def _library() -> ctypes.CDLL:
    library = ctypes.CDLL(str(library_path()))
    signatures = {
        "pyjkr_normal": (None, [ctypes.c_int, _ARRAY, ctypes.c_int, *[_DOUBLE] * 6, *[_ARRAY] * 4]),
        "pyjkr_contact_radius_root": (_DOUBLE, [_DOUBLE]),
        "pyjkr_rupture_overlap": (_DOUBLE, [_DOUBLE] * 3),
        "pyjkr_quarter_power_weight": (_DOUBLE, [_DOUBLE]),
        "pyjkr_square_root_weight": (_DOUBLE, [_DOUBLE]),
        "pyjkr_fraction_before_break": (_DOUBLE, [_DOUBLE] * 6),
        "pyjkr_turned": (None, [_ARRAY, _ARRAY, _ARRAY, _DOUBLE, _ARRAY]),
        "pyjkr_sliding_limit": (_DOUBLE, [_DOUBLE] * 3),
        "pyjkr_slide": (None, [_ARRAY, _ARRAY, *[_DOUBLE] * 3, _ARRAY, _ARRAY]),
        "pyjkr_rolling_velocity": (None, [_ARRAY, _ARRAY, _ARRAY, _DOUBLE, _DOUBLE, _ARRAY]),
        "pyjkr_rolling": (None, [_ARRAY, _ARRAY, _ARRAY, *[_DOUBLE] * 3, _ARRAY, _ARRAY]),
        "pyjkr_twist": (None, [*[_DOUBLE] * 5, _ARRAY, _ARRAY]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


def _vector(value: object) -> np.ndarray:
    return np.ascontiguousarray(value, dtype=np.float64)


@dataclass(frozen=True)
class Contact:
    """Effective values of one contact.

    Radius [m], modulus [Pa], surface energy [J/m2], mass [kg], shear modulus [Pa], |beta|.
    """

    radius: float
    modulus: float
    energy: float
    mass: float = 4.7e-15
    shear: float = 3.1e8
    damping_ratio: float = 0.13


@dataclass(frozen=True)
class Normal:
    """What the normal law says at each overlap, in SI."""

    contact_radius: np.ndarray
    force: np.ndarray
    damping: np.ndarray
    tangential_stiffness: np.ndarray


def normal(contact: Contact, overlap: object, full: bool = True) -> Normal:
    overlaps = np.atleast_1d(_vector(overlap))
    results = [np.empty_like(overlaps) for _ in range(4)]
    c = contact
    _library().pyjkr_normal(
        len(overlaps), overlaps, int(full), c.radius, c.mass, c.modulus, c.shear, c.energy, c.damping_ratio, *results
    )
    return Normal(*results)


def force(contact: Contact, overlap: float) -> float:
    return float(normal(contact, overlap).force[0])


def contact_radius_root(reduced_overlap: float) -> float:
    return _library().pyjkr_contact_radius_root(reduced_overlap)


def rupture_overlap(contact: Contact) -> float:
    return _library().pyjkr_rupture_overlap(contact.radius, contact.modulus, contact.energy)


def quarter_power_weight(theta: float) -> float:
    return _library().pyjkr_quarter_power_weight(theta)


def square_root_weight(theta: float) -> float:
    return _library().pyjkr_square_root_weight(theta)


def fraction_before_break(
    overlap: float,
    previous_overlap: float,
    time_step: float,
    breaking_overlap: float,
    breaking_force: float,
    mass: float,
) -> float:
    return _library().pyjkr_fraction_before_break(
        overlap, previous_overlap, time_step, breaking_overlap, breaking_force, mass
    )


def turned(stored: object, normal: object, normal_change: object, spin_angle: float) -> np.ndarray:
    result = np.empty(3)
    _library().pyjkr_turned(_vector(stored), _vector(normal), _vector(normal_change), spin_angle, result)
    return result


def sliding_limit(elastic_force: float, pull_off: float, friction: float) -> float:
    return _library().pyjkr_sliding_limit(elastic_force, pull_off, friction)


def slide(
    displacement: object, slip: object, stiffness: float, damping: float, limit: float
) -> tuple[np.ndarray, np.ndarray]:
    """(displacement, force) after one step."""
    new, result = np.empty(3), np.empty(3)
    _library().pyjkr_slide(_vector(displacement), _vector(slip), stiffness, damping, limit, new, result)
    return new, result


def rolling_velocity(
    relative_spin: object, normal: object, slip: object, radius: float, size_asymmetry: float
) -> np.ndarray:
    result = np.empty(3)
    _library().pyjkr_rolling_velocity(
        _vector(relative_spin), _vector(normal), _vector(slip), radius, size_asymmetry, result
    )
    return result


def rolling(
    displacement: object, velocity: object, normal: object, stiffness: float, damping: float, critical: float
) -> tuple[np.ndarray, np.ndarray]:
    """(displacement, moment on i) after one step."""
    new, result = np.empty(3), np.empty(3)
    _library().pyjkr_rolling(
        _vector(displacement), _vector(velocity), _vector(normal), stiffness, damping, critical, new, result
    )
    return new, result


def twist(angle: float, spin: float, stiffness: float, damping: float, limit: float) -> tuple[float, float]:
    """(angle, moment) after one step."""
    new, result = np.empty(1), np.empty(1)
    _library().pyjkr_twist(angle, spin, stiffness, damping, limit, new, result)
    return float(new[0]), float(result[0])
