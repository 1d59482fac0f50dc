# Law: motion of a few hundred spheres and plane walls under the contact laws of loads.py, event by event.
# Covers: Haervig et al. 2017 eqs 3-4, by pieces that are smooth (segment.py).
# Assumes: no sphere moves by more than a quarter of the smallest radius in one step of the integrator.
"""Adaptive integration of spheres with exact events.

Between two events (make, break, start or end of sliding, rolling, twisting at the limit) the equations are smooth but
for kinks where the cap of a sliding force sets in, which the error control passes, and an eighth-order method follows
them. Each event is located on the dense output, its step taken again, and the integration restarted. Displacements
since the last event are the state, and overlaps are updated by differences, so that contact overlaps keep their digits
whatever the coordinates. Only pairs nearer than two of the smallest radii are looked at; they are gathered anew before
any body can have moved by one of them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

from .bodies import Assembly, pair_table
from .loads import History, Pairs, no_history
from .normal import equilibrium_contact_radius, pull_off_force
from .segment import Event, Segment


@dataclass(frozen=True)
class Trajectory:
    """Samples of a run, its events and its last state. Arrays run over time first: time (K,) [s], the others (K, N,
    3)."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray
    events: list[Event]
    final: Assembly


def _scales(assembly: Assembly, table: Pairs) -> tuple[float, float, float]:
    """Length [m], speed [m/s] and radius [m] against which absolute errors count: those of the gentlest contact at
    the present speeds."""
    c, radius = table.contact, float(np.min(assembly.radius))
    speed = max(np.max(np.abs(assembly.velocity)), float(np.max(np.abs(assembly.spin))) * radius)
    if len(table.i) == 0:
        return radius, max(speed, 1e-300), radius
    zero_load = equilibrium_contact_radius(c)
    speed = max(
        speed, float(np.max(np.sqrt(pull_off_force(c) * zero_load**2 / (c.effective_radius * table.effective_mass))))
    )
    hertz = (3 * c.effective_radius**2 * table.effective_mass * speed**2 / c.effective_modulus) ** 0.2
    return float(np.min(np.maximum(zero_load, hertz) ** 2 / c.effective_radius)), max(speed, 1e-300), radius


def follow(
    assembly: Assembly,
    duration: float,
    *,
    samples: int | Sequence[float] = 200,
    relative_tolerance: float = 1e-10,
    stop: Callable[[Event], bool] | None = None,
) -> Trajectory:
    """Follow an assembly for a duration.

    Parameters
    ----------
    assembly : the start. Pairs that overlap and are not in `touching` make contact at once, at the overlap they have.
    duration : [s].
    samples : number of equally spaced samples, or their times [s] since the start.
    relative_tolerance : [-], of the integrator, relative to the scale of the contacts.
    stop : called with each Event; true ends the run there.

    Returns
    -------
    Trajectory

    Raises
    ------
    RuntimeError : if the integrator fails, or events no longer let time pass.
    """
    everything = pair_table(assembly)
    start, sample_times = (
        assembly.time,
        np.linspace(0, duration, samples) if np.ndim(samples) == 0 else np.asarray(samples, dtype=float),
    )
    length, speed, radius = _scales(assembly, everything)
    n, taken, stopped, idle = len(assembly.radius), [], False, 0
    assembly, fresh = _with_contacts(assembly, _overlaps(assembly, everything))
    events = [Event(start, "make", int(everything.i[row]), int(everything.j[row])) for row in fresh]
    while assembly.time - start < duration and not stopped:
        overlap = _overlaps(assembly, everything)
        near = np.union1d(np.flatnonzero(overlap > -2 * radius), assembly.touching)
        apart = ~np.isin(near, assembly.touching)
        # Just after a break the coordinates may still say overlap, by a rounding.
        overlap[near[apart]] = np.minimum(overlap[near[apart]], -np.spacing(radius))
        table, overlap, reference = everything.rows(near), overlap[near], assembly
        assembly = replace(assembly, touching=np.searchsorted(near, assembly.touching))
        while assembly.time - start < duration and not stopped and _travel(reference, assembly) < 0.75 * radius:
            segment = Segment(assembly, table, overlap)
            c = segment.contacts
            units = np.concatenate(
                [
                    np.full(3 * n, length),
                    np.full(3 * n, speed),
                    np.full(3 * n, speed / radius),
                    np.full(6 * c, length),
                    np.full(c, length / radius),
                ]
            )
            reached = 0.75 * radius - _travel(reference, assembly)
            elapsed, state, event = _run(
                segment,
                start + duration - assembly.time,
                reached,
                units,
                radius,
                relative_tolerance,
                sample_times - (assembly.time - start),
                taken,
            )
            assembly, overlap, happened = segment.ended(elapsed, state, event)
            if happened is None:
                break
            events.append(happened)
            stopped = bool(stop and stop(happened))
            idle = 0 if elapsed > 1e-6 * length / speed else idle + 1
            if idle > 100 + 10 * c:
                raise RuntimeError(
                    f"{idle} events at {assembly.time} s almost without time passing; the last: {happened}"
                )
        assembly = replace(assembly, touching=near[assembly.touching])
    if not stopped and len(taken) < len(sample_times):
        taken.append((assembly.position, assembly.velocity, assembly.spin))
    samples_taken = [np.array([sample[k] for sample in taken]).reshape(-1, n, 3) for k in range(3)]
    return Trajectory(start + sample_times[: len(taken)], *samples_taken, events, assembly)


def _travel(before: Assembly, after: Assembly) -> float:
    """Longest way [m] of any body."""
    walls = [np.subtract(new.point, old.point) for old, new in zip(before.walls, after.walls, strict=True)]
    return float(
        np.max(np.linalg.norm(np.concatenate([after.position - before.position, np.reshape(walls, (-1, 3))]), axis=-1))
    )


def _overlaps(assembly: Assembly, table: Pairs) -> np.ndarray:
    """Overlaps of all pairs [m]; of the touching ones as they were, for they carry more digits than the coordinates."""
    count, position = len(assembly.radius), np.asarray(assembly.position, dtype=float)
    overlap, spheres = np.empty(len(table.i)), table.j < count
    i, j = table.i[spheres], table.j[spheres]
    overlap[spheres] = assembly.radius[i] + assembly.radius[j] - np.linalg.norm(position[j] - position[i], axis=-1)
    for row in np.flatnonzero(~spheres):
        wall, i = assembly.walls[table.j[row] - count], table.i[row]
        overlap[row] = assembly.radius[i] - np.dot(position[i] - wall.point, wall.normal) / np.linalg.norm(wall.normal)
    overlap[assembly.touching] = assembly.overlap
    return overlap


def _with_contacts(assembly: Assembly, overlap: np.ndarray) -> tuple[Assembly, np.ndarray]:
    """The assembly with every overlapping pair touching, and the rows of the new contacts."""
    fresh = np.setdiff1d(np.flatnonzero(overlap > 0), assembly.touching)
    history = History(
        **{
            name: np.concatenate([value, getattr(no_history(len(fresh)), name)])
            for name, value in vars(assembly.history).items()
        }
    )
    touching = np.append(assembly.touching, fresh)
    return replace(assembly, touching=touching, overlap=overlap[touching], history=history), fresh


def _run(
    segment: Segment,
    duration: float,
    reach: float,
    units: np.ndarray,
    radius: float,
    tolerance: float,
    sample_times: np.ndarray,
    taken: list,
):
    """(elapsed, state, event or None) at the first event, where a body has moved by `reach`, or at the end."""
    initial = segment.initial()
    before = segment.monitors(0.0, initial)
    solver = DOP853(segment.rates, 0.0, initial, duration, rtol=tolerance, atol=0.1 * tolerance * units)
    moment, n, tiny = 0.0, 3 * segment.count, 0
    while solver.status == "running":
        solver.max_step = _safe_step(solver, n, radius)
        solver.h_abs = min(solver.h_abs, solver.max_step)
        message = solver.step()
        if solver.status == "failed":
            raise RuntimeError(f"integrator failed at {segment.assembly.time + solver.t} s: {message}")
        tiny = tiny + 1 if solver.t - moment < 1e-5 * units[0] / units[n] else 0
        if tiny > 20_000:
            raise RuntimeError(f"no progress at {segment.assembly.time + solver.t} s")
        dense, event = solver.dense_output(), None
        for inner in np.linspace(moment, solver.t, 5)[1:-1]:  # a grazing contact may make and break within one step
            touched = np.flatnonzero(segment.overlaps(inner, dense(inner)) > 0)
            if len(np.setdiff1d(touched, segment.rows)) and inner > moment:
                end, state = inner, dense(inner)
                break
        else:
            end, state = solver.t, solver.y
        after = segment.monitors(end, state)
        due = np.flatnonzero(after > 0)
        if len(due):
            times = [_crossing(segment, dense, int(k), moment, end, before[k]) for k in due]
            event, end = int(due[np.argmin(times)]), float(np.min(times))
            state = _retaken(segment, solver, moment, end, tolerance, units)
        while len(taken) < len(sample_times) and sample_times[len(taken)] <= end:
            sample = dense(sample_times[len(taken)])
            taken.append(
                (
                    segment.assembly.position + sample[:n].reshape(-1, 3),
                    sample[n : 2 * n].reshape(-1, 3),
                    sample[2 * n : 3 * n].reshape(-1, 3),
                )
            )
        if event is not None:
            return end, state, event
        moment, before = solver.t, after if end == solver.t else segment.monitors(solver.t, solver.y)
        if _farthest(segment, moment, solver.y[:n]) > reach:
            break
    return solver.t, solver.y, None


def _farthest(segment: Segment, elapsed: float, displacement: np.ndarray) -> float:
    ways = np.concatenate([displacement.reshape(-1, 3), elapsed * segment.wall_velocity])
    return float(np.sqrt(np.max(np.sum(ways**2, axis=-1))))


def _safe_step(solver: DOP853, n: int, radius: float) -> float:
    """Step [s] in which no sphere moves by more than a quarter of the smallest radius."""
    speed, acceleration = np.max(np.abs(solver.y[n : 2 * n])), np.max(np.abs(solver.f[n : 2 * n]))
    return 0.25 * radius / (speed + np.sqrt(acceleration * radius) + 1e-300)


def _crossing(segment: Segment, dense, event: int, moment: float, end: float, before: float) -> float:
    """Time at which one monitor passes 0."""
    if (
        before >= 0.0
        # due since the start of the step (another event changed the loads), or born at 0: a fresh contact of the Hertz
        # law slips at once
    ):
        return moment if before > 0.0 else end
    pairs_count = len(segment.table.i)

    def monitor(time: float) -> float:
        if time == moment:
            return before
        if event < pairs_count:
            gap = segment.overlaps(time, dense(time))[event]
            return segment.break_overlap[event] - gap if event in segment.rows else gap
        return segment.monitors(time, dense(time))[event]

    return brentq(monitor, moment, end, xtol=1e-15 * end, rtol=1e-14)


def _retaken(
    segment: Segment, solver: DOP853, moment: float, end: float, tolerance: float, units: np.ndarray
) -> np.ndarray:
    """State at an event by a step that ends there: the dense output is one order less accurate."""
    state = solver.y_old
    if end <= moment:
        return state
    again = DOP853(
        segment.rates, moment, state, end, rtol=tolerance, atol=0.1 * tolerance * units, first_step=end - moment
    )
    while again.status == "running":
        again.step()
    return again.y
