"""Pictures of the shell (VTK, off screen): plastic strain at collapse, and the opened joints of the stones on it."""

from pathlib import Path

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.shell import ShellModel
from churchpipe.report import colours
from churchpipe.report.figures import PICTURE_SIZE, frame_camera, scene
from churchpipe.report.motion import plastic_size, reference_strain, shell_amplitude
from churchpipe.report.shell_view import borders


def shell_picture(
    shell: ShellModel,
    motion: FloatArray,
    plastic: FloatArray,
    path: str | Path,
    toward: FloatArray,
    joints: tuple[FloatArray, IntArray] | None = None,
    size: tuple[int, int] = PICTURE_SIZE,
) -> None:
    """Write a PNG of the shell displaced by the motion of its nodes (nn, 3), facets coloured by plastic strain (nt, 6).

    The colour goes by the square root of the strain: hinges show beside cracks.

    toward: unit vector (3,) to the camera. joints: corners (n, 3) m of opened joints and where each one starts, drawn on the
    shell as it stands.
    """
    import pyvista as pv
    from matplotlib.colors import LinearSegmentedColormap

    speed = np.linalg.norm(motion, axis=1)
    amplitude = 0.0 if joints else shell_amplitude(shell, speed)
    points = shell.points + amplitude * motion
    strain = plastic_size(plastic, shell.thickness)
    reference = reference_strain(strain) or 1.0
    ramp = LinearSegmentedColormap.from_list("plastic", colours.PLASTIC_STOPS)
    surface = pv.PolyData.from_regular_faces(points, shell.triangles)
    surface.cell_data["colour"] = (ramp(np.sqrt(np.clip(strain / reference, 0, 1)))[:, :3] * 255).astype(np.uint8)
    edge = borders(shell)
    with scene(path, size) as plotter:
        solid = plotter.add_mesh(surface, scalars="colour", rgb=True, ambient=0.6, diffuse=0.6, specular=0.0)
        solid.mapper.SetResolveCoincidentTopologyToPolygonOffset()
        solid.mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(1.0, 1.0)
        plotter.add_mesh(pv.PolyData(points, lines=np.insert(edge, 0, 2, axis=1).ravel()), color=colours.EDGE, line_width=1.6)
        if joints and len(joints[0]):
            corners, pointer = joints
            count = np.diff(pointer)
            faces = np.insert(np.arange(len(corners)), pointer[:-1], count)
            plotter.add_mesh(pv.PolyData(corners, faces), color=colours.JOINT, opacity=0.55, lighting=False)
            after = np.arange(len(corners)) + 1
            after[pointer[1:] - 1] = pointer[:-1]
            rims = np.column_stack([np.full(len(corners), 2), np.arange(len(corners)), after])
            plotter.add_mesh(pv.PolyData(corners, lines=rims.ravel()), color=colours.JOINT, line_width=1.4)
        for position, strength in (((0.25, 0.55, 1.0), 0.6), ((-1.0, 0.0, 1.0), 0.3)):
            plotter.add_light(pv.Light(position=position, light_type="camera light", intensity=strength))
        frame_camera(plotter, points, toward)
