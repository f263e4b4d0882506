"""Exact strength of the running-bond cell in single directions, a 30, b 80, h 40 mm, friction .7.

Independent calculation made for this project from the kinematics of one rigid block; homogenised model: Malena, Portioli
et al. 2019, eqs. (5)-(7).
"""

import numpy as np
import pytest

from churchpipe.homogenised_shell.rigid_cell import rigid_cell
from churchpipe.homogenised_shell.strength import paper_planes
from hand_cell import running_limit

A, B, H, MU = 0.03, 0.08, 0.04, 0.7
N11, N22, N12, M11, M22, M12 = np.eye(6)
# As printed: no N11, the opposite sign on M22.
P = MU * B / (4 * H * (2 * A / B))
Q = MU / (2 * A / B) * np.hypot(1, B / (4 * H))


@pytest.mark.parametrize(
    ("direction", "base", "expected"),
    [
        (N11, -N22, 0.9333),
        (N12, -N22, 0.4590),
        (H * M11, -N22, 0.7551),
        (H * M22, -N22, 0.5000),
        (H * M12, -N22, 0.5107),
        (H * M11, -N11 - N22, 1.2551),
    ],
)
def test_strength_in_single_directions(direction: np.ndarray, base: np.ndarray, expected: float) -> None:
    for force in (1.0, 2e5):
        limit = running_limit(A, B, H, MU, direction, base=force * base)
        assert limit.outcome == "solved"
        assert limit.factor / force == pytest.approx(expected, abs=5e-5)
        opposite = running_limit(A, B, H, MU, -direction, base=force * base)
        if direction is N11:
            # Pressed along the courses, the stones cannot give way.
            assert opposite.outcome == "unbounded"
        else:
            assert opposite.factor == pytest.approx(limit.factor, rel=1e-6)


def test_closed_forms_of_the_single_directions() -> None:
    # A stone pulled along the courses slides on its beds; the wall rocks on the edge of a bed joint; f7.
    for direction, expected in [(N11, MU * B / (2 * A)), (H * M22, 1 / 2), (H * M11, (P + Q) / 2)]:
        assert running_limit(A, B, H, MU, direction, base=-N22).factor == pytest.approx(expected, rel=1e-6)


def test_printed_planes_7_and_8_lose_the_confinement_of_the_head_joints() -> None:
    base = -N11 - N22
    corrected = paper_planes(A, B, H, MU)
    assert (corrected.normal[6] @ -base) / (corrected.normal[6] @ (H * M11)) == pytest.approx(1.2551, abs=5e-5)
    printed = np.array([0, P + Q, 0, 2 / H, -2 / H * (Q - P), 0])
    assert (printed @ -base) / (printed @ (H * M11)) == pytest.approx(0.7551, abs=5e-5)


def test_the_mechanism_and_the_forces_prove_the_limit() -> None:
    base, direction = -1e5 * (N11 + N22), H * M12 + N12
    limit = running_limit(A, B, H, MU, direction, base=base)
    closing = rigid_cell("running", A, B, H).closing
    opening = -closing @ np.append(limit.strain, limit.rotation)
    assert limit.strain @ direction == pytest.approx(1, rel=1e-6)
    assert -limit.strain @ base == pytest.approx(limit.factor, rel=1e-6)
    assert (opening[:, 0] - MU * np.hypot(opening[:, 1], opening[:, 2])).min() > -1e-6 * np.abs(opening).max()
    stress = np.einsum("kc,kci->i", limit.forces, closing)
    np.testing.assert_allclose(stress[:6] / [1, 1, 1, H, H, H], (base + limit.factor * direction) / [1, 1, 1, H, H, H], atol=1e-2)
    np.testing.assert_allclose(stress[6:], 0, atol=1e-2)
    assert (MU * limit.forces[:, 0] - np.hypot(limit.forces[:, 1], limit.forces[:, 2])).min() > -1e-6 * np.abs(limit.forces).max()
