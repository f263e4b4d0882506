"""What the corners of cells answer, and its sums over the cells, in one pass over some cells at a time.

The forces and openings of a chunk of cells stay in the cache. As arrays of all corners between one pass and the next they would
be written to memory and read again, which takes longer than the sums.
"""

import numpy as np

from churchpipe.conic.threads import bounds_of, in_shares, shares_of
from churchpipe.homogenised_shell.cell_forces import CellForces, Entries, Kinds
from churchpipe.homogenised_shell.corner_cones import CornerCones, answered, loop, pushed
from churchpipe.model.arrays import FloatArray

# So many cells are taken at a time.
_CHUNK = 128


def push_cells(
    cones: CornerCones, forces: CellForces, aim: FloatArray, lack: FloatArray, left: float
) -> tuple[FloatArray, FloatArray]:
    """Return the stresses (6, nq) and the sums on the stones (rows,) of x + dx, of corners that open by left lack and no more."""
    stress, still = np.empty((6, len(forces.points))), np.empty(forces.rows)
    in_shares(_push, forces.count, forces.kinds, forces.entries, cones.x, cones.z, cones.slope, aim, lack, left, stress, still)
    return stress, still


def answer_cells(
    cones: CornerCones,
    forces: CellForces,
    aim: FloatArray,
    lack: FloatArray,
    left: float,
    strain: FloatArray,
    stones: FloatArray,
) -> float:
    """Find ds and dz of corners that open by left lack and as cells do whose joints strain (6, nq) and stones move (rows,) so.

    Return the rate at which the first cone is left.
    """
    rates = np.zeros(shares_of(forces.count))
    tried = (cones.x, cones.z, cones.slope, aim, lack, left, *cones.tried)
    in_shares(_answer, forces.count, forces.kinds, forces.entries, np.ascontiguousarray(strain), stones, *tried, rates)
    return float(rates.max())


@loop
def _push(
    share: int,
    shares: int,
    kinds: Kinds,
    entries: Entries,
    x: FloatArray,
    z: FloatArray,
    slope: FloatArray,
    aim: FloatArray,
    lack: FloatArray,
    left: float,
    stress: FloatArray,
    still: FloatArray,
) -> None:
    points, first, corner, row = kinds
    entry, sums, components, of_corner, values = entries
    total = np.empty(_CHUNK)
    for g in range(len(first) - 1):
        n = first[g + 1] - first[g]
        begun, end = bounds_of(n, share, shares)
        count = (corner[g + 1] - corner[g]) // max(n, 1)
        force = np.empty((3, count * _CHUNK))
        for start in range(begun, end, _CHUNK):
            size = min(_CHUNK, end - start)
            for c in range(count):
                pushed(x, z, slope, aim, lack, left, corner[g] + c * n + start, size, force, c * _CHUNK)
            at = entry[g]
            while at < entry[g + 1]:
                s = sums[at]
                total[:] = 0.0
                while at < entry[g + 1] and sums[at] == s:
                    value = values[at]
                    part = force[components[at], of_corner[at] * _CHUNK : of_corner[at] * _CHUNK + size]
                    for j in range(np.uint64(size)):
                        total[j] += value * part[j]
                    at += 1
                if s < 6:
                    for j in range(size):
                        stress[s, points[first[g] + start + j]] = total[j]
                else:
                    begin = row[g] + (s - 6) * n + start
                    for j in range(size):
                        still[begin + j] = total[j]


@loop
def _answer(
    share: int,
    shares: int,
    kinds: Kinds,
    entries: Entries,
    strain: FloatArray,
    stones: FloatArray,
    x: FloatArray,
    z: FloatArray,
    slope: FloatArray,
    aim: FloatArray,
    lack: FloatArray,
    left: float,
    ds: FloatArray,
    dz: FloatArray,
    rates: FloatArray,
) -> None:
    points, first, corner, row = kinds
    entry, sums, components, of_corner, values = entries
    moved, rate = np.empty(_CHUNK), np.empty(_CHUNK)
    fastest = 0.0
    for g in range(len(first) - 1):
        n = first[g + 1] - first[g]
        begun, end = bounds_of(n, share, shares)
        count = (corner[g + 1] - corner[g]) // max(n, 1)
        opening = np.empty((3, count * _CHUNK))
        for start in range(begun, end, _CHUNK):
            size = min(_CHUNK, end - start)
            for c in range(count):
                begin = corner[g] + c * n + start
                for i in range(3):
                    part, missing = opening[i, c * _CHUNK : c * _CHUNK + size], lack[i, begin : begin + size]
                    for j in range(np.uint64(size)):
                        part[j] = left * missing[j]
            at = entry[g]
            while at < entry[g + 1]:
                s = sums[at]
                if s < 6:
                    for j in range(size):
                        moved[j] = strain[s, points[first[g] + start + j]]
                else:
                    begin = row[g] + (s - 6) * n + start
                    for j in range(size):
                        moved[j] = stones[begin + j]
                while at < entry[g + 1] and sums[at] == s:
                    value = values[at]
                    part = opening[components[at], of_corner[at] * _CHUNK : of_corner[at] * _CHUNK + size]
                    for j in range(np.uint64(size)):
                        part[j] += value * moved[j]
                    at += 1
            for c in range(count):
                begin = corner[g] + c * n + start
                answered(x, z, slope, aim, opening, c * _CHUNK, begin, size, ds, dz, rate)
                for j in range(size):
                    if rate[j] > fastest:
                        fastest = rate[j]
    rates[share] = fastest
