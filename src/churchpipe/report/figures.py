"""Pictures of mechanisms (VTK, off screen)."""

import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, Any

import numpy as np

from churchpipe.mechanism import moving_stones, reference_speed, stone_of_point, stone_speed
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import KINDS, Contacts
from churchpipe.model.placed_loads import Applied
from churchpipe.report import colours
from churchpipe.report.applied import add_applied
from churchpipe.report.motion import (
    PUSH_LENGTH,
    camera_position,
    displaced_points,
    ground_plate,
    natural_amplitude,
    push_arrow_start,
    viewpoint,
)
from churchpipe.report.shell_view import joint_order
from churchpipe.report.surface import edges, triangles

PICTURE_SECONDS = 300
PICTURE_SIZE = (1500, 1100)
# A pixel is the mean of so many by so many: more than four are not worth their time.
SAMPLES = 2
# A process more costs a second, and a quarter of a gigabyte: so many at least are worth a process.
FEW_PICTURES, MOST_PROCESSES = 4, 4
# What to draw: a function of this package and its arguments.
Job = tuple[Callable[..., None], tuple[Any, ...]]
VIEW_ANGLE = 24.0


def mechanism_picture(
    stones: Assemblage,
    velocities: FloatArray | None,
    path: str | Path,
    push: FloatArray | None = None,
    applied: Applied | None = None,
    *,
    amplitude: float | None = None,
    size: tuple[int, int] = PICTURE_SIZE,
    toward: FloatArray | None = None,
) -> None:
    """Write a PNG of the structure displaced by velocities (nb, 6), stones coloured by speed; None: as it stands, by panel.

    amplitude: factor on the velocities; by default the mechanism moves by 8 % of the structure's size.
    push: direction (3,) of the lateral load, drawn as an arrow. applied: ties and loads, drawn as lines and arrows.
    toward: unit vector (3,) towards the eye; by default a good side, see `viewpoint`.
    """
    import pyvista as pv
    from matplotlib.colors import LinearSegmentedColormap, to_rgb

    motion = np.zeros((stones.count, 6)) if velocities is None else np.asarray(velocities, dtype=float)
    arrow = None if push is None else np.asarray(push, dtype=float) / np.linalg.norm(push)
    speed = stone_speed(stones, motion)
    plate = ground_plate(stones)
    factor = natural_amplitude(stones, speed) if amplitude is None else amplitude
    points = displaced_points(stones, motion, factor)
    if velocities is None or not moving_stones(speed).any():
        kinds = np.unique(stones.panel, return_inverse=True)[1]
        stone_colour = np.array([to_rgb(colours.PANELS[k % len(colours.PANELS)]) for k in kinds])
    else:
        ramp = LinearSegmentedColormap.from_list("speed", colours.SPEED_STOPS)
        stone_colour = ramp(np.clip(speed / reference_speed(speed), 0, 1))[:, :3]
    stone_colour[stones.fixed] = to_rgb(colours.SUPPORT)
    owner = stone_of_point(stones)
    faces = triangles(stones, ~plate)
    mesh = pv.PolyData.from_regular_faces(points, faces)
    mesh.cell_data["colour"] = (stone_colour[owner[faces[:, 0]]] * 255).astype(np.uint8)
    lines = pv.PolyData(points, lines=np.insert(edges(stones, ~plate), 0, 2, axis=1).ravel())

    with scene(path, size) as plotter:
        # Faces that look away are behind others of their stone.
        look = {"ambient": 0.5, "diffuse": 0.75, "specular": 0.0, "culling": "back"}
        solid = plotter.add_mesh(mesh, scalars="colour", rgb=True, **look)
        # Edges lie in the faces: push the faces back a little so that the edges win.
        solid.mapper.SetResolveCoincidentTopologyToPolygonOffset()
        solid.mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(1.0, 1.0)
        plotter.add_mesh(lines, color=colours.EDGE, line_width=1.6, opacity=0.6)
        _add_surroundings(plotter, stones, arrow)
        if applied is not None:
            add_applied(plotter, stones, motion, factor, applied)
        framed = points[~plate[owner]]
        if arrow is not None:
            framed = np.concatenate([framed, push_arrow_start(stones, arrow)[None, :]])
        frame_camera(plotter, framed, viewpoint(stones, motion) if toward is None else toward)


def joints_picture(contacts: Contacts, path: str | Path, toward: FloatArray) -> None:
    """Write a PNG of the joints, coloured by kind with a key; toward: unit vector (3,) towards the eye."""
    import pyvista as pv
    from matplotlib.colors import to_rgb

    corners = np.split(joint_order(contacts), contacts.point_ptr[1:-1])
    mesh = pv.PolyData(contacts.point, np.concatenate([np.insert(joint, 0, len(joint)) for joint in corners]))
    shown = {kind: colours.PANELS[number] for number, kind in enumerate(KINDS) if (contacts.kind == kind).any()}
    mesh.cell_data["colour"] = (np.array([to_rgb(shown[kind]) for kind in contacts.kind]) * 255).astype(np.uint8)
    with scene(path, PICTURE_SIZE) as plotter:
        plotter.add_mesh(mesh, scalars="colour", rgb=True, lighting=False, show_edges=True, edge_color=colours.EDGE)
        plotter.renderer.add_legend([[kind, colour] for kind, colour in shown.items()], bcolor=None, face="rectangle")
        frame_camera(plotter, contacts.point, toward)


@contextmanager
def scene(path: str | Path, size: tuple[int, int]) -> Iterator[Any]:
    """Yield an empty scene, a plotter without lights on white; what is in it at the end becomes a PNG of this size."""
    import pyvista as pv
    from PIL import Image

    # VTK looks for an X server first, and warns of a bad one where there is none, before it draws without.
    with nullcontext() if os.environ.get("DISPLAY") else pv.vtk_verbosity("error"):
        plotter = pv.Plotter(off_screen=True, window_size=[SAMPLES * side for side in size], lighting="none")
    try:
        plotter.renderer.set_background("white")
        plotter.disable_anti_aliasing()
        # Translucent things are blended in the order in which they were added: in any order takes longer than all the rest.
        plotter.renderer.SetUseOIT(False)
        yield plotter
        pixels = plotter.screenshot(return_img=True)
    finally:
        plotter.close()
    save_screenshot(Image.fromarray(np.asarray(pixels)).reduce(SAMPLES), path)


def save_screenshot(pixels: Any, path: str | Path) -> None:
    """Write an image (rows, columns, 3) as PNG. Flat faces need few colours: a palette makes the file a third of its size."""
    from PIL import Image

    image, plain = Image.fromarray(np.asarray(pixels)), Image.Dither.NONE
    # A sixteenth of the pixels holds the colours, and is sorted in a tenth of the time.
    palette = image.resize((image.width // 4, image.height // 4), Image.Resampling.NEAREST).quantize(256, dither=plain)
    image.quantize(palette=palette, dither=plain).save(path, format="PNG")


@contextmanager
def mechanism_pictures(jobs: Sequence[Job]) -> Iterator[Callable[[], str]]:
    """Draw pictures in child processes; yield what waits for them and says why one failed, or "" when none did.

    A graphics library that is missing or crashes then costs pictures, not the report, and the rest of the report is made
    meanwhile. Many pictures are shared out among the cores.
    """
    share = max(1, min(os.cpu_count() or 1, MOST_PROCESSES, len(jobs) // FEW_PICTURES))
    with ExitStack() as opened:
        drawing = [opened.enter_context(_drawing_process(jobs[first::share])) for first in range(share)] if jobs else []
        yield lambda: next(filter(None, [wait() for wait in drawing]), "")


@contextmanager
def _drawing_process(jobs: Sequence[Job]) -> Iterator[Callable[[], str]]:
    with TemporaryFile() as errors, (_forked if _alone() else _fresh)(jobs, errors) as wait:

        def problem() -> str:
            code = wait()
            if code is None:
                return f"no picture after {PICTURE_SECONDS} s"
            if code < 0:
                return f"the graphics library crashed, signal {-code}"
            errors.seek(0)
            lines = errors.read().decode(errors="replace").strip().splitlines()
            return "" if code == 0 else lines[-1] if lines else f"the drawing process ended with code {code}"

        yield problem


def _alone() -> bool:
    """Return whether this process has no other threads, of the graphics library for example: a fork of it lacks them."""
    tasks = Path("/proc/self/task")
    return tasks.is_dir() and len(list(tasks.iterdir())) == 1


@contextmanager
def _forked(jobs: Sequence[Job], errors: IO[bytes]) -> Iterator[Callable[[], int | None]]:
    """Draw in a fork, which has the libraries at once; yield what waits for its exit code: None where it lasts too long."""
    child = get_context("fork").Process(target=_draw_apart, args=(jobs, errors.fileno()))
    child.start()

    def wait() -> int | None:
        child.join(PICTURE_SECONDS)
        return child.exitcode

    try:
        yield wait
    finally:
        child.kill()
        child.join()


def _draw_apart(jobs: Sequence[Job], errors: int) -> None:
    """Draw, silently; what goes wrong is written to a file, by its number."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.dup2(errors, 2)
    # Whoever tests or runs this may have put others in their place.
    sys.stdout, sys.stderr = (os.fdopen(number, "w", encoding="utf-8", closefd=False) for number in (1, 2))
    for draw, arguments in jobs:
        draw(*arguments)


@contextmanager
def _fresh(jobs: Sequence[Job], errors: IO[bytes]) -> Iterator[Callable[[], int | None]]:
    """Draw in a process of its own; as `_forked`."""
    with TemporaryFile() as orders:
        pickle.dump(list(jobs), orders)
        orders.seek(0)
        command = [sys.executable, "-c", "from churchpipe.report import figures; figures.draw_from_stdin()"]
        child = subprocess.Popen(command, stdin=orders, stdout=subprocess.DEVNULL, stderr=errors)

        def wait() -> int | None:
            with suppress(subprocess.TimeoutExpired):
                child.wait(PICTURE_SECONDS)
            return child.returncode

        try:
            yield wait
        finally:
            child.kill()
            child.wait()


def draw_from_stdin() -> None:
    """Draw the pickled jobs of `_fresh`: what its child process runs."""
    for draw, arguments in pickle.load(sys.stdin.buffer):
        draw(*arguments)


def _add_surroundings(plotter: Any, stones: Assemblage, push: FloatArray | None) -> None:
    """Add light, a faint ground and the arrow of the load."""
    import pyvista as pv

    for position, strength in (((0.25, 0.55, 1.0), 0.85), ((-1.0, 0.0, 1.0), 0.3)):
        light = pv.Light(position=position, light_type="camera light", intensity=strength)
        plotter.add_light(light)
    free = stones.points[~stones.fixed[stone_of_point(stones)]]
    low, high = free.min(axis=0), free.max(axis=0)
    middle = (low + high) / 2
    if ground_plate(stones).any():
        reach = 1.3 * np.ptp(free[:, :2], axis=0) + 0.25 * stones.size
        level = low[2] - 1e-3 * stones.size
        plane = pv.Plane(center=(middle[0], middle[1], level), i_size=reach[0], j_size=reach[1], i_resolution=1, j_resolution=1)
        plotter.add_mesh(plane, color=colours.GROUND, opacity=0.45, lighting=False)
    if push is not None:
        length = PUSH_LENGTH * stones.size
        arrow = pv.Arrow(
            start=push_arrow_start(stones, push),
            direction=push,
            scale=length,
            shaft_radius=0.04,
            tip_radius=0.11,
            tip_length=0.35,
            shaft_resolution=32,
            tip_resolution=48,
        )
        plotter.add_mesh(arrow, color=colours.PUSH, lighting=False)


def frame_camera(plotter: Any, points: FloatArray, toward: FloatArray) -> None:
    """Place a plotter's camera so that it frames points (n, 3), seen from the direction `toward` (3,)."""
    width, height = plotter.window_size
    position, focus = camera_position(points, toward, VIEW_ANGLE, width / height)
    plotter.camera_position = [tuple(position), tuple(focus), (0.0, 0.0, 1.0)]
    plotter.camera.view_angle = VIEW_ANGLE
    plotter.reset_camera_clipping_range()
