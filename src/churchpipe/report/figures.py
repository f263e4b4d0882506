"""Pictures of mechanisms (VTK, off screen) and plots (matplotlib, as SVG)."""

import io
import pickle
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.results import LimitState
from churchpipe.report import colours
from churchpipe.report.motion import (
    PUSH_LENGTH,
    camera_position,
    displaced_points,
    ground_plate,
    moving_stones,
    natural_amplitude,
    push_arrow_start,
    reference_speed,
    stone_of_point,
    stone_speed,
    viewpoint,
)
from churchpipe.report.surface import edges, triangles

PICTURE_SECONDS = 300
VIEW_ANGLE = 24.0


def mechanism_picture(
    stones: Assemblage,
    velocities: FloatArray | None,
    path: str | Path,
    *,
    amplitude: float | None = None,
    push: FloatArray | None = None,
    size: tuple[int, int] = (1500, 1100),
) -> None:
    """Write a PNG of the structure displaced by velocities (nb, 6), stones coloured by speed; None: as it stands, by panel.

    amplitude: factor on the velocities; by default the mechanism moves by 8 % of the structure's size.
    push: direction (3,) of the lateral load, drawn as an arrow.
    """
    import pyvista as pv
    from matplotlib.colors import LinearSegmentedColormap, to_rgb
    from PIL import Image

    motion = np.zeros((stones.count, 6)) if velocities is None else np.asarray(velocities, dtype=float)
    arrow = None if push is None else np.asarray(push, dtype=float) / np.linalg.norm(push)
    speed = stone_speed(stones, motion)
    plate = ground_plate(stones)
    points = displaced_points(stones, motion, natural_amplitude(stones, speed) if amplitude is None else amplitude)
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

    plotter = pv.Plotter(off_screen=True, window_size=list(size), lighting="none")
    try:
        plotter.renderer.set_background("white")
        solid = plotter.add_mesh(mesh, scalars="colour", rgb=True, ambient=0.5, diffuse=0.75, specular=0.0)
        # Edges lie in the faces: push the faces back a little so that the edges win.
        solid.mapper.SetResolveCoincidentTopologyToPolygonOffset()
        solid.mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(1.0, 1.0)
        plotter.add_mesh(lines, color=colours.EDGE, line_width=1.6, opacity=0.6)
        _add_surroundings(plotter, stones, arrow)
        framed = points[~plate[owner]]
        if arrow is not None:
            framed = np.concatenate([framed, push_arrow_start(stones, arrow)[None, :]])
        _set_camera(plotter, framed, viewpoint(stones, motion))
        plotter.enable_anti_aliasing("ssaa")
        pixels = plotter.screenshot(return_img=True)
    finally:
        plotter.close()
    # Flat faces need few colours: a palette makes the file a third of its size.
    Image.fromarray(np.asarray(pixels)).quantize(256, dither=Image.Dither.NONE).save(path, format="PNG", optimize=True)


def mechanism_pictures(jobs: Sequence[tuple[Assemblage, FloatArray | None, Path, FloatArray | None]]) -> str:
    """Draw pictures (stones, velocities, path, push) in a child process; return why it failed, or "" when it did not.

    A graphics library that is missing or crashes then costs a picture, not the report.
    """
    if not jobs:
        return ""
    try:
        done = subprocess.run(
            [sys.executable, "-c", "from churchpipe.report import figures; figures.draw_from_stdin()"],
            input=pickle.dumps(list(jobs)),
            capture_output=True,
            timeout=PICTURE_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no picture after {PICTURE_SECONDS} s"
    if done.returncode == 0:
        return ""
    if done.returncode < 0:
        return f"the graphics library crashed, signal {-done.returncode}"
    lines = done.stderr.decode(errors="replace").strip().splitlines()
    return lines[-1] if lines else f"the drawing process ended with code {done.returncode}"


def draw_from_stdin() -> None:
    """Draw the pickled jobs of `mechanism_pictures`: what its child process runs."""
    for stones, velocities, path, push in pickle.load(sys.stdin.buffer):
        mechanism_picture(stones, velocities, path, push=push)


def convergence_svg(state: LimitState, associative: float | None = None) -> str:
    """Return an SVG of the non-associative iteration: load factor above, friction violation and gap below."""
    steps = np.arange(1, len(state.history) + 1)
    factor = np.array([step.load_factor for step in state.history])
    errors = {
        "friction violation": (np.array([step.violation for step in state.history]), colours.ALARM, "o"),
        "gap g / load factor": (np.array([step.gap for step in state.history]), colours.PUSH, "s"),
    }
    figure, (upper, lower) = _plot(2, (7.2, 4.6))
    if np.isfinite(state.interval).all():
        upper.axhspan(*state.interval, color=colours.PUSH, alpha=0.12, lw=0, label="interval of the mechanism")
    if associative is not None and np.isfinite(associative):
        upper.axhline(associative, color=colours.INK, lw=1, ls="--", label=f"associative, {associative:.4f}")
    for number, value in enumerate(state.fixed_points):
        label = "fixed points of the starts" if number == 0 else None
        upper.axhline(value, color=colours.PUSH, lw=0.9, ls=":", label=label)
    upper.plot(steps, factor, "-o", ms=3.2, lw=1.4, color="#a8581a", label="load factor")
    upper.set_ylabel("load factor")
    for label, (values, colour, marker) in errors.items():
        seen = np.isfinite(values) & (values > 0)
        if seen.any():
            lower.semilogy(steps[seen], values[seen], "-", marker=marker, ms=3.2, lw=1.2, color=colour, label=label)
    lower.set_ylabel("error")
    lower.set_xlabel("iteration")
    for axes in (upper, lower):
        axes.margins(y=0.18)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return _svg(figure)


def friction_svg(curves: Sequence[tuple[str, FloatArray, FloatArray]]) -> str:
    """Return an SVG of load factor against friction; each curve: label, frictions (n,), load factors (n,)."""
    figure, (axes,) = _plot(1, (7.2, 3.2))
    for (label, friction, factor), marker in zip(curves, "os^vD<>ph*" * (len(curves) // 10 + 1), strict=False):
        order = np.argsort(friction)
        axes.plot(friction[order], factor[order], "-", marker=marker, ms=4.5, lw=1.4, label=label)
    axes.set_xlabel("friction coefficient")
    axes.set_ylabel("load factor")
    axes.set_ylim(bottom=0)
    axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return _svg(figure)


def _plot(rows: int, size: tuple[float, float]) -> tuple[Any, Any]:
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0]
    for a in axes:
        a.grid(color="#e6e2db", lw=0.7)
        a.spines[["top", "right"]].set_visible(False)
        a.tick_params(labelsize=8)
    if rows > 1:
        axes[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
    return figure, axes


def _svg(figure: Any) -> str:
    from matplotlib import rc_context

    buffer = io.StringIO()
    # Text stays text (searchable, in the page's font); without metadata the file names no address at all.
    nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "churchpipe", "font.family": "sans-serif"}):
        figure.savefig(buffer, format="svg", metadata=nothing)
    text = buffer.getvalue()
    return text[text.index("<svg") :]


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


def _set_camera(plotter: Any, points: FloatArray, toward: FloatArray) -> None:
    width, height = plotter.window_size
    position, focus = camera_position(points, toward, VIEW_ANGLE, width / height)
    plotter.camera_position = [tuple(position), tuple(focus), (0.0, 0.0, 1.0)]
    plotter.camera.view_angle = VIEW_ANGLE
    plotter.reset_camera_clipping_range()
