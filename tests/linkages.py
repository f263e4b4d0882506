"""Statics of displaced linkages of rigid bodies in the x-z plane, independent of the program.

The bodies touch in hinges, where two of their points coincide, and in sliders, where a point of one stays on a line of the other
and slides against its full friction. With one hinge or slider less than would hold them, their place follows from how far they
have gone; with the load factor as one more unknown their 3 n equations of balance are then square.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import fsolve

from churchpipe.model.arrays import FloatArray

Point = tuple[float, float]


def area_and_centroid(outline: Sequence[Point]) -> tuple[float, FloatArray]:
    """Area, m2, and centroid (2,) m of a polygon of any orientation."""
    corner = np.asarray(outline, dtype=float)
    after = np.roll(corner, -1, axis=0)
    part = corner[:, 0] * after[:, 1] - after[:, 0] * corner[:, 1]
    return abs(part.sum()) / 2, ((corner + after) * part[:, None]).sum(axis=0) / (3 * part.sum())


@dataclass(frozen=True)
class Body:
    """A stone one metre wide: its outline in x and z, and its unit weight, N/m3."""

    outline: Sequence[Point]
    unit_weight: float = 18e3

    @property
    def weight(self) -> float:
        return area_and_centroid(self.outline)[0] * self.unit_weight

    @property
    def centre(self) -> FloatArray:
        return area_and_centroid(self.outline)[1]


@dataclass(frozen=True)
class Hinge:
    """Points of bodies one and other, as drawn, that stay together; None is the ground."""

    one: int | None
    point: Point
    other: int | None
    at: Point


@dataclass(frozen=True)
class Slider:
    """A point of a body that stays on a line of another, through `at` along the unit vector `along`.

    It is pressed along the normal (-along z, along x); friction, with its sign, acts on the body along `along`.
    """

    one: int | None
    point: Point
    other: int | None
    at: Point
    along: Point
    friction: float


@dataclass(frozen=True)
class Pull:
    """A tie from a point of a body to one of another: its tension, N, by its length, m."""

    one: int | None
    point: Point
    other: int | None
    at: Point
    tension: Callable[[float], float]


@dataclass(frozen=True)
class Linkage:
    """Bodies, what joins them, and forces (body, point, force (2,) N) that act always or grow with the load factor."""

    bodies: Sequence[Body]
    hinges: Sequence[Hinge]
    sliders: Sequence[Slider] = ()
    pulls: Sequence[Pull] = ()
    dead: Sequence[tuple[int, Point, Point]] = ()
    live: Sequence[tuple[int, Point, Point]] = ()
    direction: Point = (1.0, 0.0)
    pushed: FloatArray | None = field(default=None)

    def load_factors(self, displacement: FloatArray) -> FloatArray:
        """Load factor (n,) at mean displacements (n,) m, rising, of what is pushed."""
        place = np.concatenate([[*body.centre, 0.0] for body in self.bodies])
        out, last = [], 0.0
        for end in displacement:
            for part in np.linspace(last, end, max(2, int(abs(end - last) / 0.01) + 1))[1:]:
                place = self._placed(float(part), place)
            out.append(self._balanced(place))
            last = float(end)
        return np.array(out)

    def _at(self, place: FloatArray, body: int | None, point: Point) -> FloatArray:
        if body is None:
            return np.asarray(point, dtype=float)
        arm = np.asarray(point) - self.bodies[body].centre
        return place[3 * body : 3 * body + 2] + _turned(place[3 * body + 2], arm)

    def _axes(self, place: FloatArray, slider: Slider) -> tuple[FloatArray, FloatArray]:
        angle = 0.0 if slider.other is None else float(place[3 * slider.other + 2])
        along = _turned(angle, np.asarray(slider.along))
        return along, np.array([-along[1], along[0]])

    def _loads(self) -> FloatArray:
        own = np.array([body.weight for body in self.bodies])
        return own if self.pushed is None else self.pushed

    def _mean(self, place: FloatArray) -> float:
        gone = place.reshape(-1, 3)[:, :2] - [body.centre for body in self.bodies]
        done, total = float(self._loads() @ (gone @ self.direction)), float(self._loads().sum())
        for body, _, force in self.live:
            done, total = done + float(gone[body] @ force), total + float(np.linalg.norm(force))
        return done / total

    def _placed(self, displacement: float, near: FloatArray) -> FloatArray:
        def misses(place: FloatArray) -> FloatArray:
            out = [self._mean(place) - displacement]
            for h in self.hinges:
                out += (self._at(place, h.one, h.point) - self._at(place, h.other, h.at)).tolist()
            for s in self.sliders:
                _, normal = self._axes(place, s)
                out.append(float((self._at(place, s.one, s.point) - self._at(place, s.other, s.at)) @ normal))
            return np.array(out)

        found, *_ = fsolve(misses, near, xtol=1e-13, full_output=True)
        assert np.abs(misses(found)).max() < 1e-9
        return found

    def _balanced(self, place: FloatArray) -> float:
        size = 3 * len(self.bodies)

        def column(*forces: tuple[int | None, FloatArray, FloatArray]) -> FloatArray:
            out = np.zeros((len(self.bodies), 3))
            for body, point, force in forces:
                if body is not None:
                    arm = point - place[3 * body : 3 * body + 2]
                    out[body] += [*force, arm[0] * force[1] - arm[1] * force[0]]
            return out.ravel()

        columns: list[FloatArray] = []
        for h in self.hinges:
            point = self._at(place, h.one, h.point)
            columns += [column((h.one, point, force), (h.other, point, -force)) for force in np.eye(2)]
        for s in self.sliders:
            point = self._at(place, s.one, s.point)
            along, normal = self._axes(place, s)
            force = normal + s.friction * along
            columns.append(column((s.one, point, force), (s.other, point, -force)))
        load, dead = np.zeros((size // 3, 3)), np.zeros((size // 3, 3))
        load[:, :2] = self._loads()[:, None] * self.direction
        dead[:, 1] = [-body.weight for body in self.bodies]
        load, dead = load.ravel(), dead.ravel()
        for into, forces in ((dead, self.dead), (load, self.live)):
            for body, point, force in forces:
                into += column((body, self._at(place, body, point), np.asarray(force)))
        for p in self.pulls:
            start, end = self._at(place, p.one, p.point), self._at(place, p.other, p.at)
            length = float(np.linalg.norm(end - start))
            force = p.tension(length) * (end - start) / length
            dead += column((p.one, start, force), (p.other, end, -force))
        return float(np.linalg.solve(np.column_stack([*columns, load]), -dead)[-1])


def _turned(angle: float, arm: FloatArray) -> FloatArray:
    return np.array([arm[0] * np.cos(angle) - arm[1] * np.sin(angle), arm[0] * np.sin(angle) + arm[1] * np.cos(angle)])
