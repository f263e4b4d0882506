"""What the forces of an analysis say of a vault: the line of thrust in a section, hoop and meridian forces of a dome."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.geometry.clusters import clusters
from churchpipe.model.arguments import check_kind, listed, positive
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, floats, unit_vector
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts, check_contacts_of

# A joint that carries less than this share of the weight has no line of thrust through it.
_NOTHING = 1e-9
# Sine of the least slope at which a vault may stand on what carries it.
_LEVEL = 0.4
# Cosine of the angle to the section up to which a joint of a ring crosses it, and of that between two joints of one voussoir.
_ALONG, _NEXT = 0.5, 0.7
# Joints of rings whose middles in the section are closer than this share of the size of all are one.
_ONE = 1e-6
# A joint of which a smaller share than this lies in the strip ends beside it.
_SLIVER = 1e-6
# A macro-element in courses is a vault when its beds differ by more than this in slope: sine of 20 degrees.
_TURNS = 0.34


@dataclass(frozen=True, slots=True)
class ThrustLine:
    """The line of thrust in an upright section, joint after joint.

    course (n, 2): of the stones on both sides of each joint, -1 for what has none, such as voussoirs. place (n, 2) m: where the
    thrust passes, s along the section and z. force (n,) N: its component along the joint's normal. eccentricity (n,) m: distance
    of that place from the middle of the joint, outwards. half (n,) m: half the width of the joint there, within which it stays.
    """

    course: IntArray
    place: FloatArray
    force: FloatArray
    eccentricity: FloatArray
    half: FloatArray


@dataclass(frozen=True, slots=True)
class RingForces:
    """The forces of a dome or drum, ring after ring from below: course (n,); height (n,) m of the middle; meridian (n,) N, the
    sum of the normal forces in the bed below; vertical (n,) N, the vertical resultant there, the weight above less what other
    parts take; hoop (n,) N, the mean normal force in the ring's head joints: pressure positive, there is no tension.
    """

    course: IntArray
    height: FloatArray
    meridian: FloatArray
    vertical: FloatArray
    hoop: FloatArray


def vaulted(stones: Assemblage, contacts: Contacts) -> dict[str, FloatArray]:
    """Return the macro-elements in courses whose beds turn, as in a vault, each with the sums (2, 2) of the products of the
    beds' normals in plan, by area."""
    first, second = contacts.blocks.T
    same = (stones.panel[first] == stones.panel[second]) & stones.coursed[first] & stones.coursed[second]
    beds = np.flatnonzero(same & (stones.course[first] != stones.course[second]))
    found: dict[str, FloatArray] = {}
    for panel in np.unique(stones.panel[first[beds]]).tolist():
        mine = beds[stones.panel[first[beds]] == panel]
        level = np.abs(contacts.frame[mine, 0, 2])
        if np.ptp(level) > _TURNS:
            plan = contacts.frame[mine, 0, :2]
            found[str(panel)] = np.einsum("i,ia,ib->ab", contacts.area[mine], plan, plan)
    return found


def ringed(stones: Assemblage, contacts: Contacts) -> dict[str, FloatArray]:
    """Return the macro-elements of voussoirs alone, an arch or rings side by side, as `vaulted` those in courses.

    Their stones lie in no course and have two slanting joints each with others at the most, unlike those of rubble.
    """
    first, second = contacts.blocks.T
    slanting = (stones.panel[first] == stones.panel[second]) & ~stones.coursed[contacts.blocks].any(axis=1)
    slanting &= contacts.kind == "radial"
    number = np.bincount(contacts.blocks[slanting].ravel(), minlength=stones.count)
    found: dict[str, FloatArray] = {}
    for panel in np.unique(stones.panel[first[slanting]]).tolist():
        mine, own = slanting & (stones.panel[first] == panel), (stones.panel == panel) & ~stones.fixed
        if (
            stones.coursed[own].any()
            or number[own].max() > 2
            or not number[own].min()
            or np.ptp(contacts.frame[mine, 0, 2]) <= _TURNS
        ):
            continue
        plan = contacts.frame[mine, 0, :2]
        found[str(panel)] = np.einsum("i,ia,ib->ab", contacts.area[mine], plan, plan)
    return found


def thrust_line(
    stones: Assemblage,
    contacts: Contacts,
    forces: npt.ArrayLike,
    panels: str | tuple[str, ...],
    through: tuple[float, float] = (0.0, 0.0),
    direction: tuple[float, float] = (1.0, 0.0),
    width: float = 1.0,
) -> ThrustLine:
    """Return the line of thrust in an upright section of a vault, of the joints within a strip about it.

    Parameters
    ----------
    stones
        Of the whole structure.
    contacts
        Their interfaces.
    forces
        (nc, 3) N at the contact points: of a `LimitState` or a `SettlementState`.
    panels
        The macro-elements whose bed joints are meant, one name or several; of rings of voussoirs the joints between these, and
        those at both ends.
    through
        x and y of a point of the section, m.
    direction
        Of the section in plan: along x for a barrel that runs along y.
    width
        Of the strip, m: of a joint that reaches out of it the share counts that lies in it.

    Raises
    ------
    InputError
        Forces of other joints, names that no stone has, no direction, a strip without joints between courses.
    """
    force, inside = _checked(stones, contacts, forces, panels)
    positive("thrust_line: width", width)
    along = np.append(unit_vector("thrust_line: direction", direction, 2), 0.0)
    middle = _means(contacts, contacts.point)
    origin = np.append(floats("thrust_line: through", through, (2,)), 0.0)
    share = _share_within(contacts, (contacts.point - origin) @ np.cross([0.0, 0.0, 1.0], along), width)
    course = np.where(inside, stones.course, -1)[contacts.blocks]
    beds = inside[contacts.blocks].any(axis=1) & (course[:, 0] != course[:, 1]) & (share > 0)
    # With other masonry, those at the feet of the vault alone: what lies on its back is no bed.
    within = stones.course[inside & stones.coursed]
    ends = np.isin(course.max(axis=1), np.sort(within)[[0, -1]] if len(within) else [])
    ends &= np.abs(contacts.frame[:, 0, 2]) > _LEVEL
    beds &= (course >= 0).all(axis=1) | ends
    # Voussoirs lie in no course. Where they stand in a wall, its beds are meant.
    rings = _ring_joints(contacts, inside, along) & (share > 0) & (not len(within))
    drawn = beds | rings
    if not drawn.any():
        raise InputError("thrust_line", "no bed joint in the strip", found=f"{width:g} m about {through}", expected="a wider one")
    point = np.stack([(contacts.point - origin) @ along, contacts.point[:, 2]], axis=1)
    normal = force[:, 0] * share[contacts.interface_of_point]
    seen = np.stack([(middle - origin) @ along, middle[:, 2]], axis=1)
    close = _ONE * stones.size
    crown = float(seen[drawn & (seen[:, 1] >= seen[drawn, 1].max() - close), 0].mean())
    side = np.where(np.abs(seen[:, 0] - crown) > close, np.sign(seen[:, 0] - crown), 0.0)
    # Joints between the same courses on one side are one, and joints of rings in one place.
    key = np.column_stack([np.sort(course, axis=1), side, np.zeros(len(side))])
    key[rings] = -1.0
    key[rings, 3] = clusters(seen[rings], close)
    group, label = np.unique(key[drawn], axis=0, return_inverse=True)
    number = np.full(len(drawn), -1)
    number[drawn] = label.ravel()
    of_point = number[contacts.interface_of_point]
    rows: list[tuple[FloatArray, float, float, float]] = []
    kept: list[int] = []
    centres: list[FloatArray] = []
    for k in range(len(group)):
        mine = of_point == k
        total = float(normal[mine].sum())
        if total <= _NOTHING * float(stones.weight.sum()):
            continue
        own = point[mine]
        low, high = own[np.argmin(_spread(own))], own[np.argmax(_spread(own))]
        half, axis = 0.5 * float(np.linalg.norm(high - low)), (high - low) / max(float(np.linalg.norm(high - low)), 1e-12)
        centre = 0.5 * (low + high)
        # Outwards: away from the middle of the section, and up.
        axis = axis if axis @ [np.sign(centre[0] - crown), 1.0] >= 0 else -axis
        eccentricity = float((normal[mine] @ own / total - centre) @ axis)
        rows.append((centre + eccentricity * axis, total, eccentricity, half))
        kept.append(k)
        centres.append(centre)
    place = np.array([row[0] for row in rows]).reshape(-1, 2)
    # Up on one side, down on the other.
    joint = np.array(centres).reshape(-1, 2)
    left = joint[:, 0] < crown - close
    order = np.lexsort((np.where(left, -1.0, 1.0) * joint[:, 1], left))
    figures = np.array([row[1:] for row in rows]).reshape(-1, 3)[order]
    return ThrustLine(group[kept, :2].astype(np.int64)[order], place[order], figures[:, 0], figures[:, 1], figures[:, 2])


def _share_within(contacts: Contacts, across: FloatArray, width: float) -> FloatArray:
    """Return the share (ni,) of each joint that lies in a strip; across (np,) m: of its points from the strip's middle."""
    first = contacts.point_ptr[:-1]
    low, high = np.minimum.reduceat(across, first), np.maximum.reduceat(across, first)
    extent, inner = high - low, np.minimum(high, width / 2) - np.maximum(low, -width / 2)
    upright = extent <= _SLIVER * width
    share = np.where(upright, inner >= 0, inner / np.where(upright, 1.0, extent))
    return np.where(share > _SLIVER, share, 0.0)


def _ring_joints(contacts: Contacts, voussoirs: BoolArray, along: FloatArray) -> BoolArray:
    """Return which joints (ni,) cross rings of voussoirs (nb,) that run in a section along (3,): those between two, and those at
    the ends of rings."""
    first, second = contacts.blocks.T
    normal = contacts.frame[:, 0]
    crossing = np.abs(normal @ np.cross([0.0, 0.0, 1.0], along)) < _ALONG
    between = voussoirs[first] & voussoirs[second] & crossing
    neighbours = np.bincount(contacts.blocks[between].ravel(), minlength=len(voussoirs))
    # The one joint of each last voussoir with the ring.
    only = np.full(len(voussoirs), -1)
    only[contacts.blocks[between]] = np.flatnonzero(between)[:, None]
    last = voussoirs & (neighbours == 1)
    end = contacts.blocks[np.arange(len(between)), np.where(last[first], 0, 1)]
    ends = (voussoirs[first] != voussoirs[second]) & last[end] & crossing
    return between | (ends & (np.abs((normal * normal[only[end]]).sum(axis=1)) > _NEXT))


def ring_forces(
    stones: Assemblage,
    contacts: Contacts,
    forces: npt.ArrayLike,
    panels: str | tuple[str, ...],
) -> RingForces:
    """Return hoop and meridian forces of a dome, of its drum or lantern, ring by ring.

    Parameters
    ----------
    stones
        Of the whole structure.
    contacts
        Their interfaces.
    forces
        (nc, 3) N at the contact points: of a `LimitState` or a `SettlementState`.
    panels
        The macro-elements meant, one name or several.

    Raises
    ------
    InputError
        Forces of other joints, names that no stone has, stones without courses.
    """
    force, inside = _checked(stones, contacts, forces, panels)
    rings = np.unique(stones.course[inside & stones.coursed])
    if not len(rings):
        raise InputError("ring_forces: panels", "no stones in courses", found=panels, expected="a dome, drum or lantern")
    # Normals point from the first stone of a joint to the second, and a force acts on the second.
    world = np.einsum("pa,pac->pc", force, contacts.frame[contacts.interface_of_point])
    normal = np.bincount(contacts.interface_of_point, force[:, 0], minlength=len(contacts.blocks))
    up = np.bincount(contacts.interface_of_point, world[:, 2], minlength=len(contacts.blocks))
    first, second = contacts.blocks.T
    rows: list[tuple[float, float, float, float]] = []
    for ring in rings.tolist():
        mine = inside & (stones.course == ring)
        below = inside & stones.coursed & (stones.course < ring)
        # The lowest ring rests on what is not part of it.
        below = below & (stones.course == ring - 1) if below.any() else ~inside
        from_below, onto_below = below[first] & mine[second], mine[first] & below[second]
        heads = mine[first] & mine[second]
        weight = stones.weight[mine]
        rows.append(
            (
                float(weight @ stones.centroid[mine, 2] / weight.sum()),
                float(normal[from_below | onto_below].sum()),
                float(up[from_below].sum() - up[onto_below].sum()),
                float(normal[heads].mean()) if heads.any() else 0.0,
            )
        )
    return RingForces(rings.astype(np.int64), *np.array(rows).T)


def _checked(
    stones: Assemblage, contacts: Contacts, forces: npt.ArrayLike, panels: str | tuple[str, ...]
) -> tuple[FloatArray, BoolArray]:
    check_kind("stones", stones, Assemblage)
    check_kind("contacts", contacts, Contacts)
    check_contacts_of(stones, contacts)
    force = floats("forces", forces, (len(contacts.point), 3))
    names = (panels,) if isinstance(panels, str) else tuple(listed("panels", panels, str))
    known = np.unique(stones.panel[~stones.fixed]).tolist()
    for name in names:
        if name not in known:
            raise InputError("panels", "no such panel", found=name, expected=", ".join(known))
    return force, np.isin(stones.panel, names)


def _means(contacts: Contacts, values: FloatArray) -> FloatArray:
    counts = np.maximum(contacts.points_per_interface, 1)[:, None]
    return np.add.reduceat(values, contacts.point_ptr[:-1], axis=0) / counts


def _spread(points: FloatArray) -> FloatArray:
    """Return the places (n,) of points (n, 2) along their longest extent."""
    local = points - points.mean(axis=0)
    return local @ np.linalg.svd(local, full_matrices=False)[2][0]
