"""The mid-surfaces of vaults as flat facets: between two stations of a side, from the middle of one bed to that of the next."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from churchpipe.bond.period import BondName
from churchpipe.errors import InputError
from churchpipe.model.arrays import BoolArray, FloatArray, NameArray
from churchpipe.model.vault import Run, Side, Vault
from churchpipe.shell_mesh.vault_bonds import vault_bonds
from churchpipe.vaults.stones import places

# Points closer than this are one, m.
_ONE = 1e-6
# Rows at a springing, as shares of the course. A hinge of the shell lies in the middle of a row, that of a vault in the joint.
FOOT = np.array([1 / 16, 1 / 4])
# Width of the strip that is the joint between two rings of voussoirs, as a share of theirs. Wider ones bear less shear: two rings
# of 0.5 m, pushed along the barrel, have .493, .434 and .352 with 1/20, 1/10 and 1/5, as stones .471.
BETWEEN = 1 / 10
_SideKey = tuple[float, ...]
_Bonds = dict[str, BondName]


@dataclass(frozen=True, slots=True)
class VaultFacets:
    """Triangles of the mid-surfaces of vaults: corner (nt, 3, 3) m, `corner_tkc`, corner k of triangle t; axes (nt, 3, 3) as in
    `ShellModel`; thickness (nt,) m; volume (nt,) m3 of stones that each carries; cell (nt, 2) m; bond, material, panel (nt,)
    names; yields (nt,)."""

    corner: FloatArray
    axes: FloatArray
    thickness: FloatArray
    volume: FloatArray
    cell: FloatArray
    bond: NameArray
    material: NameArray
    panel: NameArray
    yields: BoolArray


@dataclass(frozen=True, slots=True)
class _Strips:
    """The strips of a side: where they end, share (n + 1,) from 0 to 1, and whether each is the joint of two rings (n,)."""

    share: FloatArray
    between: BoolArray


@dataclass(frozen=True, slots=True)
class _Patch:
    """Flat triangles (k, 3, 3) m of one plane, the volume (k,) m3 that each carries, and what they have in common."""

    corner: FloatArray
    volume: FloatArray
    axes: FloatArray
    thickness: float
    cell: tuple[float, float]
    bond: BondName
    material: str
    part: str
    yields: bool


def vault_facets(vaults: Sequence[Vault], element_size: float) -> VaultFacets:
    """Return the mid-surfaces of vaults, with the walls and drums laid with them, as triangles that fit at their edges.

    All courses on one side of a path are divided at the same stations, whatever their head joints, so that facets fit.

    Raises
    ------
    InputError: masonry that has no mid-surface.
    """
    for vault in vaults:
        if vault.shell == "none":
            raise InputError(
                f"vault {vault.name}",
                "has no mid-surface of its own",
                found=", ".join(vault.parts),
                expected="vaults without backing, and without arches or ribs below them",
                remedy="Rigid blocks take it as it is.",
            )
    bonds = [vault_bonds(vault) for vault in vaults]
    across = _strips_along(vaults, bonds, element_size)
    patches = [patch for vault, own in zip(vaults, bonds, strict=True) for patch in _facets(vault, own, element_size, across)]
    counts = [len(patch.corner) for patch in patches]

    def each(value: Callable[[_Patch], object]) -> np.ndarray:
        return np.repeat(np.array([value(patch) for patch in patches]), counts, axis=0)

    return VaultFacets(
        np.concatenate([patch.corner for patch in patches]),
        each(lambda patch: patch.axes),
        each(lambda patch: patch.thickness),
        np.concatenate([patch.volume for patch in patches]),
        each(lambda patch: patch.cell),
        each(lambda patch: patch.bond),
        each(lambda patch: patch.material),
        each(lambda patch: patch.part),
        each(lambda patch: patch.yields),
    )


def _key(side: Side) -> _SideKey:
    return tuple(np.round(np.concatenate([side.origin, side.normal, side.along]), 9).tolist())


def _strips_along(vaults: Sequence[Vault], bonds: Sequence[_Bonds], element_size: float) -> dict[_SideKey, _Strips]:
    """Return the strips of each side, those of its rings where it has any, an even number where a stack stands."""
    found: dict[_SideKey, _Strips] = {}
    for vault, own in zip(vaults, bonds, strict=True):
        for run in vault.runs:
            key = _key(run.side)
            if key in found and found[key].between.any():
                continue
            if vault.beds == "section":
                found[key] = _strips_of_rings(run.stations[:, 0], element_size)
                continue
            ends = run.stations[[0, -1]]
            middle = np.array([run.section.lower[0], run.section.upper[0]])
            length = float((ends[1, 0] - ends[0, 0] + (ends[1, 1] - ends[0, 1]) * middle).max())
            halves = 2 if own[run.part] == "stack" else 1
            count = halves * math.ceil(length / (halves * element_size) - 1e-9)
            if key not in found or count > len(found[key].between):
                found[key] = _Strips(np.linspace(0, 1, count + 1), np.zeros(count, dtype=np.bool_))
    return found


def _strips_of_rings(cuts: FloatArray, element_size: float) -> _Strips:
    """Return the strips of rings between cuts (rings + 1,) m: two or more a ring, and one for the joint of each two."""
    width = np.diff(cuts)
    half = 0.5 * BETWEEN * np.minimum(width[1:], width[:-1])
    ends = np.stack([np.append(cuts[0], cuts[1:-1] + half), np.append(cuts[1:-1] - half, cuts[-1])], axis=1)
    counts = np.maximum(np.ceil((ends[:, 1] - ends[:, 0]) / element_size - 1e-9), 2).astype(np.int64)
    rings = [np.linspace(end[0], end[1], count + 1) for end, count in zip(ends, counts, strict=True)]
    between = np.concatenate([np.arange(len(ring)) == len(ring) - 1 for ring in rings])[:-1]
    return _Strips((np.concatenate(rings) - cuts[0]) / (cuts[-1] - cuts[0]), between)


def _facets(vault: Vault, bonds: _Bonds, element_size: float, across: dict[_SideKey, _Strips]) -> Iterator[_Patch]:
    # Webs that meet in a mitre have unequal sections where their spans are unequal, and the same number of rows.
    rows: dict[tuple[str, int], int] = {}
    for run in vault.runs:
        place = run.part, run.course
        rows[place] = max(rows.get(place, 1), math.ceil(run.section.height / element_size - 1e-9))
    ends = _springings(vault)
    for run in vault.runs:
        stations = _stations(run, across)
        share = _rows(rows[run.part, run.course], *(_place(run, end) in ends for end in (run.section.lower, run.section.upper)))
        line = (1 - share) * run.section.lower + share * run.section.upper
        place = places(run.side, line, stations)
        volume = run.section.area * (np.diff(stations, axis=0) @ np.array([1.0, run.section.centroid[0]]))
        height = run.section.height
        along = np.append(run.side.along, 0.0)
        rise = (run.section.upper - run.section.lower) / height
        up = np.append(rise[0] * run.side.normal, rise[1])
        # A ring is laid in halves of its voussoirs.
        cell = (height if vault.beds == "path" else 2 * height, run.length)
        axes = np.stack([along, up, np.cross(along, up)])
        thickness = run.section.area / height
        between = across[_key(run.side)].between if vault.beds == "section" else np.zeros(len(volume), dtype=np.bool_)
        for strip, carried in enumerate(volume.tolist()):
            bond: BondName = "stack" if between[strip] else bonds[run.part]
            quads = (
                np.stack([place[strip, k], place[strip + 1, k], place[strip + 1, k + 1], place[strip, k + 1]])
                for k in range(len(line) - 1)
            )
            divided = _crossed if bond != "stack" else _rising if 2 * strip < len(volume) else _falling
            corner = np.concatenate([divided(quad) for quad in quads])
            area = _areas(corner)
            yield _Patch(corner, carried * area / area.sum(), axes, thickness, cell, bond, vault.material, run.part, True)


def _place(run: Run, joint: FloatArray) -> _SideKey:
    return (*_key(run.side), *(np.round(joint / _ONE) * _ONE).tolist())


def _springings(vault: Vault) -> set[_SideKey]:
    """Return the middles of joints that no other course of the vault continues, at the lower end of a course."""
    sections = [(run, run.section) for run in vault.runs]
    low = [(run, s.lower if s.lower[1] < s.upper[1] else s.upper) for run, s in sections]
    high = {_place(run, s.upper if s.lower[1] < s.upper[1] else s.lower) for run, s in sections}
    return {_place(run, joint) for run, joint in low} - high


def _rows(count: int, first: bool, last: bool) -> FloatArray:
    """Return where a course is divided into rows, (n, 1) from 0 to 1; finely at a springing, where a hinge lies at its joint."""
    share = np.linspace(0, 1, count + 1)
    below = FOOT[count * FOOT < 1]
    parts = [share, below if first else below[:0], 1 - below if last else below[:0]]
    return np.unique(np.concatenate(parts))[:, None]


def _stations(run: Run, across: dict[_SideKey, _Strips]) -> FloatArray:
    first, last = run.stations[0], run.stations[-1]
    return first + across[_key(run.side)].share[:, None] * (last - first)


def _crossed(quad: FloatArray) -> FloatArray:
    """Return four triangles about the centre of a plane quadrilateral (4, 3) m, or the one that it is where corners coincide."""
    corner = quad[_apart(quad)]
    if len(corner) == 3:
        return corner[None]
    return np.array([[a, b, corner.mean(axis=0)] for a, b in pairwise([*corner, corner[0]])])


def _rising(quad: FloatArray) -> FloatArray:
    """Return two triangles of a plane quadrilateral (4, 3) m, or the one that it is where corners coincide.

    A stack bends about its beds alone, and could not hold a node in the middle. The diagonals of both halves of a side lean
    towards each other.
    """
    corner = quad[_apart(quad)]
    return corner[[[0, 1, 2], [0, 2, 3]][: len(corner) - 2]]


def _falling(quad: FloatArray) -> FloatArray:
    """Return the same with the other diagonal."""
    return _rising(np.roll(quad, -1, axis=0))


def _apart(quad: FloatArray) -> BoolArray:
    return np.asarray(np.linalg.norm(quad - np.roll(quad, -1, axis=0), axis=1) > _ONE)


def _areas(corner: FloatArray) -> FloatArray:
    return 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
