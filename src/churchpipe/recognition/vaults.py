"""Barrels and domes recognised in drawn stones: the courses that these were swept along."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.geometry.clusters import clusters
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.polyhedra import face_normals
from churchpipe.model.vault import Run, Section, Side, Vault
from churchpipe.recognition.swept_stones import ONE, SAME, Piece, across, pieces_of
from churchpipe.stones.contacts import find_contacts

# A face is neither level nor upright where its normal's rise is further than this from 1 and from 0.
INCLINED = 1e-4
# The part of stones that name none.
VAULT = "vault"
_Way = tuple[Piece, ...]


@dataclass(frozen=True, slots=True)
class _Segment:
    """A piece of a stone with the middles of its beds (2, 2) m, the lower one first, the length m of the
    stone, and what it is part of."""

    stone: int
    piece: Piece
    beds: FloatArray
    length: float
    part: str
    material: str


def fit_vaults(stones: Assemblage) -> tuple[Vault, ...]:
    """Return the vaults, one a material, that all free stones make up, or none.

    Every stone is a union of pieces swept along level lines, and those with inclined beds have others of their course beside
    them, which tells a vault from an arch in a wall. Stones without a panel are of the part `VAULT`.

    Parameters
    ----------
    stones: as drawn, exact to some 1e-6 m.
    """
    free = np.flatnonzero(~stones.fixed)
    inclined = free[_has_inclined_faces(stones)[free]]
    ways = _ways(stones, inclined)
    if not ways:
        return ()
    joints = find_contacts(stones)
    touching = _joints_of(joints, stones.count)
    beside = (any(way[0].lower is not None or _heads(way, joints, touching[s]) for way in options) for s, options in ways.items())
    if not all(beside):
        return ()
    ways |= _ways(stones, np.setdiff1d(free, inclined))
    if len(ways) < len(free):
        return ()
    found: list[_Segment] = []
    chosen = _chosen(ways, joints, touching)
    widest = max((len(way) for way in chosen.values() if way[0].lower is None), default=1)
    for stone, way in chosen.items():
        beds = [pair for piece in way if (pair := _beds(piece, joints, touching[stone])) is not None]
        if len(beds) < len(way):
            return ()
        lengths = [_length(piece, pair) for piece, pair in zip(way, beds, strict=True)]
        part, material = str(stones.panel[stone]) or VAULT, str(stones.material[stone])
        for piece, pair, own in zip(way, beds, lengths, strict=True):
            # A stone that closes a dome has no head joints: it stands for stones of as many sides as the others have.
            found.append(_Segment(stone, piece, pair, sum(lengths) if piece.lower is None else widest * own, part, material))
    return () if _is_an_arch(found) else tuple(_vaults(found))


def _has_inclined_faces(stones: Assemblage) -> BoolArray:
    _, normal, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    rise = np.abs(normal[:, 2])
    inclined = (rise > INCLINED) & (rise < 1 - INCLINED)
    return np.logical_or.reduceat(inclined, stones.block_face_ptr[:-1])


def _length(piece: Piece, beds: FloatArray) -> float:
    return float((piece.ends[1] - piece.ends[0]) @ np.array([1.0, beds[:, 0].mean()]))


def _is_an_arch(found: Sequence[_Segment]) -> bool:
    """Return whether all runs along one direction, over less than a quarter of the width: a wall with an arch in it."""
    if np.ptp([segment.piece.angle for segment in found]) > SAME:
        return False
    ends = np.array([segment.piece.ends[:, 0] for segment in found])
    width = np.ptp(np.concatenate([segment.piece.corner[:, 0] for segment in found]))
    return bool(np.ptp(ends) < width / 4)


def _ways(stones: Assemblage, which: IntArray) -> dict[int, list[_Way]]:
    """Return all ways in which each of these stones is swept, nothing once a stone is not."""
    out: dict[int, list[_Way]] = {}
    for stone in which.tolist():
        out[stone] = pieces_of(stones, stone)
        if not out[stone]:
            return {}
    return out


def _joints_of(joints: Contacts, count: int) -> list[list[int]]:
    out: list[list[int]] = [[] for _ in range(count)]
    for number, pair in enumerate(joints.blocks.tolist()):
        for stone in pair:
            out[stone].append(number)
    return out


def _chosen(ways: dict[int, list[_Way]], joints: Contacts, touching: Sequence[Sequence[int]]) -> dict[int, _Way]:
    """Return one way for each stone: with neighbours at its ends, else along the direction that most others have."""
    common = Counter(round(piece.angle, 5) for options in ways.values() if len(options) == 1 for piece in options[0])

    def worth(stone: int, way: _Way) -> tuple[int, int]:
        return common[round(way[0].angle, 5)], _heads(way, joints, touching[stone])

    return {stone: max(options, key=lambda way: worth(stone, way)) for stone, options in ways.items()}


def _heads(way: _Way, joints: Contacts, touching: Sequence[int]) -> int:
    """Return the number of joints in the planes at the ends of the pieces of a stone."""
    found = 0
    for piece in way:
        normal, along = across(piece.angle)
        for a, c in piece.ends:
            plane = np.append(along - c * normal, 0.0) / np.hypot(1.0, c)
            found += sum(_lies_in(joints, joint, plane, a / np.hypot(1.0, c)) for joint in touching)
    return found


def _lies_in(joints: Contacts, joint: int, normal: FloatArray, offset: float) -> bool:
    point = joints.point[joints.point_ptr[joint]]
    return bool(abs(joints.frame[joint, 0] @ normal) > 1 - SAME and abs(point @ normal - offset) < 2 * ONE)


def _beds(piece: Piece, joints: Contacts, touching: Sequence[int]) -> FloatArray | None:
    """Return the middles of the two beds of a piece (2, 2) m; None if it has no bed, or more than two."""
    if piece.lower is not None and piece.upper is not None:
        return np.stack([piece.lower, piece.upper])
    after = np.roll(piece.corner, -1, axis=0)
    edge = after - piece.corner
    normal = np.stack([edge[:, 1], -edge[:, 0]], axis=1) / np.linalg.norm(edge, axis=1)[:, None]
    middle = (piece.corner + after) / 2
    plan, _ = across(piece.angle)
    joined = np.zeros(len(edge), dtype=np.bool_)
    for number, (d, z) in enumerate(normal):
        plane = np.append(d * plan, z)
        joined[number] = any(_lies_in(joints, joint, plane, float(normal[number] @ middle[number])) for joint in touching)
    beds = np.flatnonzero(joined)
    if len(beds) == 1:
        # The uppermost bed of a wall, of an oculus, of a lantern carries nothing.
        beds = np.array([beds[0], np.argmin(normal @ normal[beds[0]])])
    if len(beds) != 2 or beds[0] == beds[1]:
        return None
    pair = middle[beds]
    return pair[np.lexsort(np.round(pair, 6).T)]


def _vaults(found: Sequence[_Segment]) -> Iterator[Vault]:
    materials = sorted({segment.material for segment in found})
    for material in materials:
        own = [segment for segment in found if segment.material == material]
        number = {stone: index for index, stone in enumerate(sorted({segment.stone for segment in own}))}
        suffix = f"_{material}" if len(materials) > 1 else ""
        yield Vault(f"{VAULT}{suffix}", tuple(_runs(own, number, suffix)), material)


def _runs(found: Sequence[_Segment], number: dict[int, int], suffix: str) -> Iterator[Run]:
    """Return the courses: pieces of one section, one behind the other along one direction."""
    angle = np.array([segment.piece.angle for segment in found])
    place = np.array([np.append(segment.beds.ravel(), len(segment.piece.corner)) for segment in found])
    direction = clusters(angle[:, None], SAME).astype(np.float64)
    same = clusters(np.column_stack([10.0 * direction, place]), 2 * ONE)
    _, course = np.unique(np.round(place[:, [1, 3]].mean(axis=1), 5), return_inverse=True)
    groups: dict[tuple[int, str], list[int]] = defaultdict(list)
    for index, segment in enumerate(found):
        groups[int(same[index]), segment.part].append(index)
    for (_, part), members in groups.items():
        normal, along = across(float(angle[members].mean()))
        first = found[members[0]]
        section = Section(first.piece.corner, *first.beds)
        row = np.array([1.0, section.centroid[0]])
        ordered = sorted(members, key=lambda index: float(found[index].piece.ends[0] @ row))
        for stretch in _stretches([found[index] for index in ordered]):
            stations = np.array([stretch[0].piece.ends[0], *(segment.piece.ends[1] for segment in stretch)])
            length = float(np.median([segment.length for segment in stretch]))
            of = np.array([number[segment.stone] for segment in stretch])
            yield Run(section, Side(np.zeros(2), normal, along), stations, of, int(course[ordered[0]]), part + suffix, length)


def _stretches(ordered: Sequence[_Segment]) -> Iterator[list[_Segment]]:
    """Return the pieces that follow one on the other without a gap."""
    stretch = [ordered[0]]
    for segment in ordered[1:]:
        if np.abs(segment.piece.ends[0] - stretch[-1].piece.ends[1]).max() > 100 * ONE:
            yield stretch
            stretch = []
        stretch.append(segment)
    yield stretch
