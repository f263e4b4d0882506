"""Joints left open in a drawing: closed where the person named their width, named where nobody did."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from churchpipe.dxf.reading import JointMode, Mortar
from churchpipe.dxf.stones import Stone
from churchpipe.findings import Finding
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.stones.contact_tolerances import HAIRLINE
from churchpipe.stones.mortar import Solid, close_joints, open_joints
from churchpipe.stones.self_crossing import self_crossing_stones
from churchpipe.wording import counted

# Open joints are a matter of the whole drawing when there are this many for each stone.
MANY = 0.25
# Joints wider than this many times the smallest dimension of the median stone are a slip of the pen; contacts reach across joints
# that are kept open up to half of it.
WIDEST_GROWN, WIDEST_KEPT = 2.0, 0.5
# Widths that differ by a smaller share are told as one.
ALIKE = 1e-3


def jointed(
    stones: list[Stone], joint: float, mode: JointMode, mortar: Mortar, unit: float, findings: list[Finding]
) -> tuple[list[Stone], FloatArray]:
    """Return stones that meet in their joints, and by what the weight of each counts (nb,): 1 unless mortar is ignored.

    joint: nominal width, drawing units; unit: a drawing unit, m, for the volumes in the findings. With `mode` "keep" stones are
    left as they are: then it is the contacts that reach across.
    """
    size = float(np.median([np.ptp(stone.points, axis=0).min() for stone in stones]))
    widest = (WIDEST_KEPT if mode == "keep" else WIDEST_GROWN) * size
    if joint > widest:
        # In a wrong unit everything is too wide or too thin: then it is the unit that is named.
        if any(finding.code in ("E04", "E05") for finding in findings):
            return stones, np.ones(len(stones))
        what = "a joint of {} between stones whose smallest dimension is {}: {} at most can be closed"
        remedy = "Give the width of one joint, with its unit" + ("; wide ones take --joint-mode grow." if mode == "keep" else ".")
        findings.append(Finding("E26", what, remedy=remedy, lengths=(joint, size, widest)))
        return stones, np.ones(len(stones))
    closed = close_joints([(stone.points, stone.faces) for stone in stones], joint)
    count = len(np.unique(closed.joints.joint))
    # A stone without a volume, of which another finding tells, has no mortar either.
    share = np.divide(closed.volume_before, closed.volume, out=np.ones(len(stones)), where=closed.volume != 0)
    if not count:
        remedy = "Give the width of the joints as drawn, or leave --joint out if the stones touch."
        findings.append(Finding("W26", "no joint as wide as asked for ({}) was found", remedy=remedy, lengths=(joint,)))
        return stones, np.ones(len(stones))
    free = np.array([not stone.fixed for stone in stones])
    before, after = (unit**3 * float(volume[free].sum()) for volume in (closed.volume_before, closed.volume))
    low, high = float(closed.joints.width.min()), float(closed.joints.width.max())
    lengths, wide = ((high,), "{}") if _alike(low, high) else ((low, high), "{} to {}")
    what = f"{counted(count, 'joint')} of {wide}; stones {before:.6g} m3, with their mortar {after:.6g} m3: "
    if mode == "keep":
        findings.append(Finding("W26", what + "stones were left as drawn, contacts reach across", lengths=lengths))
        return stones, 1 / share if mortar == "counted" else np.ones(len(stones))
    what += "stones were grown to meet in the middle; mortar weighs " + ("like stone" if mortar == "counted" else "nothing")
    findings.append(Finding("W26", what, lengths=lengths))
    for first, second, width in closed.wide:
        what = f'a gap of {{}} to the stone "{stones[second].name}" is too wide for a joint, or off the others, and stays open'
        remedy = "Draw it as wide as the joints beside it, or pass another --joint: the two stones do not touch there."
        findings.append(stones[first].place.finding("W26", what, remedy=remedy, lengths=(width,)))
    for index in closed.stuck:
        findings.append(stones[index].place.finding("W26", "a stone that could not be grown was left as it was"))
    grown = [
        replace(stone, points=points, faces=tuple(faces)) for stone, (points, faces) in zip(stones, closed.solids, strict=True)
    ]
    findings += _crossed(stones, closed.solids, unit) if not any(f.severity == "error" for f in findings) else []
    return grown, share if mortar == "ignored" else np.ones(len(stones))


def _crossed(stones: Sequence[Stone], grown: Sequence[Solid], unit: float) -> list[Finding]:
    """Return what is to be said of stones whose surface crosses itself once they are grown, and did not as drawn."""

    def crossing(solids: Sequence[Solid]) -> list[int]:
        lengths = [(unit * points, faces) for points, faces in solids]
        return [index for index, _ in self_crossing_stones(Assemblage.from_polyhedra(lengths, 1.0))]

    found = [stones[index] for index in crossing(grown)]
    drawn = crossing([(stone.points, stone.faces) for stone in found]) if found else []
    what = "grown into its mortar, the surface of this stone crosses itself, which it does not as drawn"
    remedy = "Pass --joint-mode keep, which leaves stones as drawn, or draw it up to the middle of its joints."
    return [stone.place.finding("E26", what, remedy=remedy) for index, stone in enumerate(found) if index not in drawn]


def unnamed_joints(stones: Sequence[Stone], unit: float) -> list[Finding]:
    """Return what is to be said of stones that do not touch because mortar was left out between them."""
    joints = open_joints([(stone.points, stone.faces) for stone in stones])
    # Hairlines, such as between the chords of two curves, are joints without being asked for.
    wide = joints.width > HAIRLINE * float(np.median([np.ptp(stone.points, axis=0).min() for stone in stones]))
    width, count = joints.width[wide], len(np.unique(joints.joint[wide]))
    if count < MANY * len(stones):
        return []
    low, usual, high = (float(value) for value in np.quantile(width, (0.0, 0.5, 1.0)))
    wide, lengths = ("{}", (usual,)) if _alike(low, high) else ("from {} to {}, most about {}", (low, high, usual))
    what = f"{count} gaps between the stones, {wide}"
    remedy = f"Pass --joint {1e3 * unit * usual:.3g}mm to grow the stones until they meet in the middle."
    return [Finding("E26", what, "stones that touch, or the width of their joints", remedy, lengths=lengths)]


def _alike(low: float, high: float) -> bool:
    return high - low <= ALIKE * high
