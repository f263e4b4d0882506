"""What the 3-D viewer needs to show the shell beside the stones: meshes, motions, plastic strains, opened joints."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from churchpipe.mechanism import reference_speed
from churchpipe.model.arrays import FloatArray, IntArray, pointer_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.results import CapacityCurve, ShellLimitState
from churchpipe.model.shell import ShellModel
from churchpipe.report import colours
from churchpipe.report.motion import joint_opening, opened_joints, plastic_size, reference_strain, shell_amplitude
from churchpipe.report.packing import packed

ShellState = ShellLimitState | CapacityCurve
# Sine of the angle between facets from which an edge is drawn.
FOLD = 0.3


def motion_of(state: ShellState) -> FloatArray:
    """Return the motion of the nodes (nn, 3): velocities at collapse, or displacements at the last step."""
    return np.nan_to_num(state.velocities if isinstance(state, ShellLimitState) else state.displacement)


def shell_data(
    meshes: Mapping[str, ShellModel],
    results: Sequence[tuple[str, str, ShellState, int]],
    stones: Assemblage,
    contacts: Contacts,
    velocities: Sequence[FloatArray],
    origin: FloatArray,
) -> dict[str, Any]:
    """Return the shell's part of the viewer's input as JSON-ready values, lengths in m from `origin` (3,).

    results: label, name of its mesh, state, and which rigid-block analysis answers the same question (-1: none).
    velocities: of the rigid-block analyses, (nb, 6) each. Base64 arrays: float32 (`points`, `motion`, `strain`) and uint32.
    """
    names = list(meshes)
    return {
        "meshes": [_mesh(mesh, origin) for mesh in meshes.values()],
        "analyses": [
            {"label": label, "mesh": names.index(mesh), "partner": partner, **_state(meshes[mesh], state)}
            for label, mesh, state, partner in results
        ],
        "joints": [_joints(stones, contacts, moved, origin) for moved in velocities],
        "plastic_stops": colours.PLASTIC_STOPS,
        "joint": colours.JOINT,
    }


def _mesh(shell: ShellModel, origin: FloatArray) -> dict[str, Any]:
    panels, panel_of = np.unique(shell.panel, return_inverse=True)
    return {
        "points": packed(shell.points - origin, "<f4"),
        "triangles": packed(shell.triangles, "<u4"),
        "borders": packed(borders(shell), "<u4"),
        "panels": [str(name) for name in panels],
        "panel_of": packed(panel_of, "<u4"),
    }


def _state(shell: ShellModel, state: ShellState) -> dict[str, Any]:
    motion = motion_of(state)
    speed = np.linalg.norm(motion, axis=1)
    strain = plastic_size(np.nan_to_num(state.plastic), shell.thickness)
    return {
        "motion": packed(motion, "<f4"),
        "strain": packed(strain, "<f4"),
        "reference_strain": reference_strain(strain),
        "reference_speed": reference_speed(speed),
        "amplitude": shell_amplitude(shell, speed),
        # Of a curve that falls at once there is but the mechanism, of any size.
        "real": isinstance(state, CapacityCurve) and state.status != "unstable",
    }


def _joints(stones: Assemblage, contacts: Contacts, velocities: FloatArray, origin: FloatArray) -> dict[str, Any]:
    outline, pointer = joint_outlines(contacts, np.flatnonzero(opened_joints(joint_opening(contacts, stones, velocities))))
    return {"points": packed(outline - origin, "<f4"), "ptr": packed(pointer, "<u4")}


def joint_outlines(contacts: Contacts, interfaces: IntArray) -> tuple[FloatArray, IntArray]:
    """Return the corners (n, 3) m of interfaces, in order around each, and where each one starts (len + 1,)."""
    order, pointer = joint_order(contacts), contacts.point_ptr
    corners = [contacts.point[order[pointer[i] : pointer[i + 1]]] for i in interfaces]
    starts = pointer_of([len(part) for part in corners])
    return np.concatenate(corners) if corners else np.empty((0, 3)), starts


def joint_order(contacts: Contacts) -> IntArray:
    """Return the contact points (nc,), those of each interface in order around it."""
    first = contacts.point_ptr[:-1]
    interface = contacts.interface_of_point
    middle = (
        np.add.reduceat(contacts.point, first, axis=0) / np.diff(contacts.point_ptr)[:, None] if len(first) else contacts.point
    )
    flat = np.einsum("pac,pc->pa", contacts.frame[interface][:, 1:], contacts.point - middle[interface])
    return np.lexsort((np.arctan2(flat[:, 1], flat[:, 0]), interface))


def borders(shell: ShellModel) -> IntArray:
    """Return the edges (n, 2) of the mesh that bound it, or where walls meet."""
    pairs = np.sort(np.concatenate([shell.triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
    edge, inverse, count = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    normal = np.tile(shell.axes[:, 2], (3, 1))
    mean = np.zeros((len(edge), 3, 3))
    np.add.at(mean, inverse.ravel(), normal[:, :, None] * normal[:, None, :])
    # Facets in one plane, whichever way their normals point, make a tensor of rank one.
    folded = np.linalg.eigvalsh(mean)[:, 1] > FOLD**2 / 2
    return edge[(count == 1) | folded]
