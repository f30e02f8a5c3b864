"""The motion that a run has written, followed anew: place, velocity and energy of every block at every output time. SI units."""

import math
from dataclasses import dataclass

from geometry import Body, Placed, Point, turned
from outcome import Outcome
from scene import POINT_MARK, Scene, densities

STORED = "contact_springs_j", "support_springs_j"
DONE_BY_OTHERS = "loads_j", "base_motion_j"  # minus their work


@dataclass(frozen=True)
class State:
    centroid: Point
    velocity: Point  # of the centroid
    spin: float
    vertices: list[Point]


class Block:
    def __init__(self, name: str, initial: list[Point], start: list[Point], density: float, fixed: bool):
        self.name, self.fixed = name, fixed
        self.initial, self.start = initial, start
        self.body = Body(start)
        self.mass = density * self.body.integrals.area
        self.inertia = density * self.body.integrals.polar

    @property
    def centroid(self) -> Point:
        return self.body.integrals.centroid

    def start_of(self, point: Point) -> Point:
        """Where the corner that was drawn at the point is at the start."""
        return self.start[min(range(len(self.initial)), key=lambda i: math.dist(self.initial[i], point))]

    def placed(self, vertices: list[Point]) -> Placed:
        return self.body.at(vertices)


class Motion:
    """`blocks` by name; `times`; `states[k][name]` of the free blocks at times[k]."""

    def __init__(self, scene: Scene, outcome: Outcome):
        self._document = scene.document
        self._floor = scene.floor_m
        outlines = outlines_of(outcome)
        density = densities(scene.document)
        start = outlines.get("start", outlines["initial"])
        self.blocks = {b["name"]: Block(b["name"], outlines["initial"][b["name"]], start[b["name"]], density[b["material"]], b.get("fixed", False))
                       for b in scene.document["block"]}
        self.final = outlines["final"]
        self.sideways, upwards = scene.document.get("gravity_m_per_s2", [0.0, -9.81])
        self.gravity = -upwards
        self._energy_rows = outcome.table("energy.csv")
        self.times, self.states = self._follow(outcome.table("history.csv"))

    @property
    def free(self) -> list[Block]:
        return [b for b in self.blocks.values() if not b.fixed]

    def _follow(self, rows: list[dict[str, str]]) -> tuple[list[float], list[dict[str, State]]]:
        drawn = {p["name"]: tuple(p["point_m"]) for p in self._document["measured_point"]}
        by_time: dict[float, dict[str, dict[str, str]]] = {}
        for row in rows:
            by_time.setdefault(float(row["time_s"]), {})[row["point"]] = row
        states = []
        for points in by_time.values():
            states.append({b.name: _state(b, *((points[f"{b.name}{POINT_MARK}{k}"], drawn[f"{b.name}{POINT_MARK}{k}"]) for k in (0, 1)))
                           for b in self.free})
        return list(by_time), states

    def kinetic(self, k: int) -> float:
        return sum(self._kinetic_of(b, self.states[k][b.name]) for b in self.free)

    @staticmethod
    def _kinetic_of(b: Block, s: State) -> float:
        return (b.mass * (s.velocity[0] ** 2 + s.velocity[1] ** 2) + b.inertia * s.spin**2) / 2

    def potential(self, k: int) -> float:
        """Above the floor; where gravity is inclined, also sideways from the start."""
        places = [(b, self.states[k][b.name].centroid) for b in self.free]
        return sum(b.mass * (self.gravity * (y - self._floor) - self.sideways * (x - b.centroid[0])) for b, (x, y) in places)

    def stored(self, k: int) -> float:
        """In springs, since time 0, as the program says."""
        return sum(float(self._energy_rows[k][column]) for column in STORED)

    def kinetic_in_ledger(self, k: int) -> float:
        """As the program says: velocities in history.csv may be those of half a step before, when what a contact now stores was still kinetic."""
        return self.kinetic(0) + float(self._energy_rows[k]["kinetic_j"])

    def energy(self, k: int) -> float:
        """Kinetic and potential from places and velocities, with what the springs hold where that is not counted twice."""
        kinetic = self.kinetic(k)
        return self.potential(k) + max(kinetic, min(kinetic, self.kinetic_in_ledger(k)) + self.stored(k))

    def work_done(self, k: int) -> float:
        """By loads and the base, since time 0."""
        return -sum(float(self._energy_rows[k][column]) for column in DONE_BY_OTHERS)

    def fastest(self, k: int) -> float:
        """[m/s] Of any point of a block."""
        return max(math.hypot(*s.velocity) + abs(s.spin) * self.blocks[name].body.reach for name, s in self.states[k].items())

    def placed(self, k: int) -> list[tuple[Block, Placed]]:
        return [(b, b.placed(b.start if b.fixed else self.states[k][b.name].vertices)) for b in self.blocks.values()]


def outlines_of(outcome: Outcome) -> dict[str, dict[str, list[Point]]]:
    """Vertices by state and block."""
    states: dict[str, dict[str, list[Point]]] = {}
    for row in outcome.table("blocks.csv"):
        states.setdefault(row["state"], {}).setdefault(row["block"], []).append((float(row["x_m"]), float(row["y_m"])))
    return states


def _state(block: Block, first: tuple[dict, Point], second: tuple[dict, Point]) -> State:
    """Of a rigid block, from two of its corners."""
    start = [block.start_of(drawn) for _, drawn in (first, second)]
    shift = (float(first[0]["displacement_x_m"]), float(first[0]["displacement_y_m"]))
    rotation = float(first[0]["rotation_rad"])
    places = [turned(p, shift, rotation, start[0]) for p in start]
    velocities = [(float(row["velocity_x_m_per_s"]), float(row["velocity_y_m_per_s"])) for row, _ in (first, second)]
    arm = (places[1][0] - places[0][0], places[1][1] - places[0][1])
    relative = (velocities[1][0] - velocities[0][0], velocities[1][1] - velocities[0][1])
    spin = (arm[0] * relative[1] - arm[1] * relative[0]) / (arm[0] ** 2 + arm[1] ** 2)
    centroid = turned(block.centroid, shift, rotation, start[0])
    velocity = (velocities[0][0] - spin * (centroid[1] - places[0][1]), velocities[0][1] + spin * (centroid[0] - places[0][0]))
    return State(centroid, velocity, spin, [turned(p, shift, rotation, start[0]) for p in block.start])
