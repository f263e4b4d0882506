"""A joint that is not convex bears the same with the corners of its hull as with all of its own."""

import numpy as np
import pytest
import shapely

import churchpipe as cp
from churchpipe.geometry.prism import prism_of
from churchpipe.model.assemblage import Assemblage, Polyhedron

RING = (shapely.box(-0.5, -0.5, 0.5, 0.5), shapely.box(-0.3, -0.3, 0.3, 0.3))
RING_IN_FOUR = [(-0.5, -0.5, 0.5, -0.3), (-0.5, 0.3, 0.5, 0.5), (-0.5, -0.3, -0.3, 0.3), (0.3, -0.3, 0.5, 0.3)]
ELL = (shapely.box(0, 0, 1, 1), shapely.box(0.4, 0.4, 1, 1))
ELL_IN_TWO = [(0.0, 0.0, 1.0, 0.4), (0.0, 0.4, 0.4, 1.0)]


@pytest.mark.parametrize(("plan", "parts"), [(RING, RING_IN_FOUR), (ELL, ELL_IN_TWO)], ids=["ring", "L"])
def test_any_load_is_borne_as_by_the_same_joint_cut_into_convex_ones(plan, parts):
    # Without tension and crushing a force at any point of the joint is one of forces at the corners of the hull.
    whole = plan[0].difference(plan[1])
    models = [_on([whole], whole), _on([shapely.box(*part) for part in parts], whole)]
    joints = [cp.find_contacts(stones) for stones in models]
    assert len(joints[0].point) < len(joints[1].point)
    assert joints[0].area.sum() == pytest.approx(whole.area)
    wrenches = 1e3 * np.random.default_rng(1).normal(size=(6, 6))
    for wrench in wrenches:
        found = [
            cp.limit_analysis(stones, contacts, cp.LoadCase(live=np.vstack([np.zeros((stones.count - 1, 6)), wrench])), 0.6)
            for stones, contacts in zip(models, joints, strict=True)
        ]
        assert found[0].load_factor == pytest.approx(found[1].load_factor, rel=1e-6)


def _on(lower: list[shapely.Polygon], upper: shapely.Polygon) -> Assemblage:
    """A stone of some plan, 1 m high, on fixed ones."""
    solids = [*(_solid(plan, -1.0) for plan in lower), _solid(upper, 0.0)]
    return Assemblage.from_polyhedra(solids, 18e3, fixed=list(range(len(lower))))


def _solid(plan: shapely.Polygon, bottom: float) -> Polyhedron:
    points, faces = prism_of(plan)
    return points + np.array([0.0, 0.0, bottom]), [list(face) for face in faces]
