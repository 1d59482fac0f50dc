# Law: the equations of motion of an assembly while its contacts and their modes stay as they are.
# Covers: Haervig et al. 2017 eqs 3-4; contacts made at overlap 0, broken at overlap 0 (simplified) or -delta_C
#   (full; Chen et al. 2019 section 2.1).
# Assumes: constant external forces and torques.
"""One smooth piece of a run: rates for the integrator, monitors that pass 0 where the piece must end, and what comes
after."""

from dataclasses import dataclass, replace

import numpy as np

from .bodies import Assembly, bodies
from .loads import Geometry, History, Loads, Pairs, loads, no_history
from .normal import rupture_overlap

LIMIT_MARGIN = (
    1e-11  # a slider slips this fraction beyond its limit: keeps round-off at the limit from restarting the integrator
)


@dataclass(frozen=True)
class Event:
    """What happened to bodies i and j (walls after the spheres) at a time [s]: make, break, slip, stick, roll, hold,
    spin, grip."""

    time: float
    kind: str
    i: int
    j: int


class Segment:
    """The smooth equations between two events: fixed contacts, fixed modes; state = displacements, velocities, spins,
    history."""

    def __init__(self, assembly: Assembly, table: Pairs, overlap: np.ndarray):
        self.assembly, self.table, self.overlap_start = assembly, table, overlap
        self.count, self.rows = len(assembly.radius), assembly.touching
        self.contacts, self.pairs = len(self.rows), table.rows(assembly.touching)
        self.radius, self.mass, self.inertia = bodies(assembly)
        walls = np.zeros((len(assembly.walls), 3))
        extra = [
            np.zeros((self.count, 3)) if value is None else np.asarray(value)
            for value in (assembly.external_force, assembly.external_torque)
        ]
        self.external, self.torque = (np.concatenate([value, walls]) for value in extra)
        self.wall_velocity = np.array([wall.velocity for wall in assembly.walls], dtype=float).reshape(-1, 3)
        outward = np.array([np.asarray(wall.normal) / np.linalg.norm(wall.normal) for wall in assembly.walls]).reshape(
            -1, 3
        )
        position = np.concatenate([assembly.position, walls])
        self.wall = table.j >= self.count
        self.branch = position[table.j] - position[table.i]
        self.branch[self.wall] = -outward[table.j[self.wall] - self.count]
        self.length = np.linalg.norm(self.branch, axis=-1)
        self.break_overlap = rupture_overlap(table.contact)

    def initial(self) -> np.ndarray:
        a, h = self.assembly, self.assembly.history
        return np.concatenate(
            [value.ravel() for value in (np.zeros((self.count, 3)), a.velocity, a.spin, h.slip, h.roll, h.twist)]
        )

    def unpack(self, state: np.ndarray):
        n, c = 3 * self.count, self.contacts
        motion = [block.reshape(-1, 3) for block in np.split(state[: 3 * n], 3)]
        slip, roll, twist = np.split(state[3 * n :], [3 * c, 6 * c])
        history = replace(
            self.assembly.history, slip=slip.reshape(-1, 3), roll=roll.reshape(-1, 3), twist=twist.reshape(-1, 1)
        )
        return motion, history

    def geometry(self, elapsed: float, displacement: np.ndarray, rows=slice(None)) -> Geometry:
        shift = np.concatenate([displacement, elapsed * self.wall_velocity])
        relative, branch, wall = (
            shift[self.table.j[rows]] - shift[self.table.i[rows]],
            self.branch[rows],
            self.wall[rows],
        )
        moved = branch + np.where(wall[:, None], 0.0, relative)
        distance, start = np.linalg.norm(moved, axis=-1), self.length[rows]
        # |X + D| - |X| without the cancellation; along a fixed normal at a wall.
        growth = np.sum(relative * (2 * branch + np.where(wall[:, None], 0.0, relative)), axis=-1) / np.where(
            wall, 2.0, distance + start
        )
        return Geometry(moved / distance[:, None], self.overlap_start[rows] - growth, np.where(wall, np.inf, distance))

    def loads(self, elapsed: float, state: np.ndarray, reset: bool = False) -> Loads:
        (displacement, velocity, spin), history = self.unpack(state)
        velocity, spin = np.concatenate([velocity, self.wall_velocity]), np.concatenate([spin, 0 * self.wall_velocity])
        geometry = self.geometry(elapsed, displacement, self.rows)
        return loads(
            self.pairs,
            self.assembly.options,
            geometry,
            history,
            velocity,
            spin,
            self.external,
            self.torque,
            self.mass,
            self.inertia,
            reset,
        )

    def rates(self, elapsed: float, state: np.ndarray) -> np.ndarray:
        n, result = self.count, self.loads(elapsed, state)
        acceleration, angular = (result.force / self.mass[:, None])[:n], (result.torque / self.inertia[:, None])[:n]
        history = (result.slip_rate.ravel(), result.roll_rate.ravel(), result.twist_rate.ravel())
        return np.concatenate([state[3 * n : 6 * n], acceleration.ravel(), angular.ravel(), *history])

    def overlaps(self, elapsed: float, state: np.ndarray) -> np.ndarray:
        return self.geometry(elapsed, state[: 3 * self.count].reshape(-1, 3)).overlap

    def monitors(self, elapsed: float, state: np.ndarray) -> np.ndarray:
        """One number per possible event, > 0 where it is due: make or break of every pair, then the three sliders of
        every contact."""
        gap = self.overlaps(elapsed, state)
        gap[self.rows] = (self.break_overlap - gap)[self.rows]
        if not self.contacts:
            return gap
        result, history = self.loads(elapsed, state), self.assembly.history
        sliders = (
            result.sliding_excess - np.where(history.slipping, 0.0, LIMIT_MARGIN),
            result.rolling_excess - np.where(history.yielding, 0.0, LIMIT_MARGIN),
            result.twisting_excess - np.where(history.spinning, 0.0, LIMIT_MARGIN),
        )
        return np.concatenate([gap, *sliders])

    def ended(self, elapsed: float, state: np.ndarray, event: int | None) -> tuple[Assembly, np.ndarray, Event | None]:
        """Assembly and overlaps after the segment and its event."""
        (displacement, velocity, spin), history = self.unpack(state)
        overlap = self.overlaps(elapsed, state)
        walls = [replace(w, point=np.asarray(w.point) + elapsed * np.asarray(w.velocity)) for w in self.assembly.walls]
        moved = dict(
            position=self.assembly.position + displacement,
            velocity=velocity,
            spin=spin,
            walls=walls,
            time=self.assembly.time + elapsed,
        )
        rows, happened = self.rows, None
        if event is not None and event < len(overlap):
            if event in rows:
                keep = rows != event
                overlap[event] = self.break_overlap[event]
                rows, history, kind = rows[keep], history.rows(keep), "break"
            else:
                overlap[event] = 0.0
                fresh = no_history(1)
                history = History(
                    **{name: np.concatenate([value, getattr(fresh, name)]) for name, value in vars(history).items()}
                )
                rows, kind = np.append(rows, event), "make"
            happened = Event(moved["time"], kind, int(self.table.i[event]), int(self.table.j[event]))
        elif event is not None:
            which, contact = divmod(event - len(overlap), self.contacts)
            value, flag, begins, ends = (
                ("slip", "slipping", "slip", "stick"),
                ("roll", "yielding", "roll", "hold"),
                ("twist", "spinning", "spin", "grip"),
            )[which]
            flags, values = getattr(history, flag).copy(), getattr(history, value).copy()
            values[contact] = getattr(self.loads(elapsed, state, reset=True).history, value)[contact]
            flags[contact] = not flags[contact]
            history = replace(history, **{flag: flags, value: values})
            pair = rows[contact]
            happened = Event(
                moved["time"], begins if flags[contact] else ends, int(self.table.i[pair]), int(self.table.j[pair])
            )
        after = replace(self.assembly, **moved, touching=rows, overlap=overlap[rows], history=history)
        return after, overlap, happened
