"""report.html: what it says, that it says it offline, and that the viewer gets the right arrays."""

import base64
import io
import json
import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure
from matplotlib.image import imread
from rich.console import Console

import churchpipe as cp
from churchpipe import generators
from churchpipe.mechanism import Part, moving_stones, reference_speed, stone_of_point, stone_speed
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.checks import DisplacementCheck, SafetyCheck
from churchpipe.model.polyhedra import face_normals
from churchpipe.model.results import Iteration
from churchpipe.report.drawings import ELEVATIONS, PLAN, View, cut_polygons, drawings_svg, elevations, sections
from churchpipe.report.drawn_loads import drawn_loads
from churchpipe.report.figures import mechanism_picture
from churchpipe.report.html import write_report
from churchpipe.report.motion import camera_position, displaced_points, ground_plate, natural_amplitude, push_direction, viewpoint
from churchpipe.report.notes import status_note
from churchpipe.report.page import breakable
from churchpipe.report.plots import WIDTH, convergence_svg, gaps_svg, legend_below, new_plot
from churchpipe.report.safety import overall
from churchpipe.report.surface import edges, triangles
from churchpipe.report.table import COLUMNS, Row, amount, figure, small
from churchpipe.report.title_block import material_rows, title_block
from churchpipe.report.viewer import joint_values
from churchpipe.stones.contacts import find_contacts
from churchpipe.terminal import results_table
from imprecise import corner
from records import EMPTY, analysis, summary
from report_pages import INF, NAN, VERSIONS, Page, record_of, report, rocking, state_of, tower
from solids import box, on_ground, prism


@pytest.fixture(scope="module")
def page_text(tmp_path_factory: pytest.TempPathFactory) -> str:
    stones = tower()
    first = state_of(stones)
    steps = (Iteration(0.24, 0.1), Iteration(0.21, 0.01), Iteration(0.2, 0.0, 2e-6))
    second = state_of(
        stones, flow="non-associative", load_factor=0.2, lower_bound=NAN, upper_bound=NAN, status="converged", history=steps,
        gap=4e-7, interval=(0.19, 0.21), friction_violation=3e-9, fixed_points=(0.205, 0.2),
    )  # fmt: skip
    fall = np.zeros((4, 6))
    fall[3, 2] = -1.0
    third = state_of(stones, load_factor=NAN, lower_bound=NAN, upper_bound=NAN, status="unstable", velocities=fall)
    fourth = state_of(stones, load_factor=INF, lower_bound=INF, upper_bound=INF, status="unbounded", velocities=np.zeros((4, 6)))
    results = [
        (record_of(first), first),
        (record_of(second), second),
        (record_of(third, friction=0.1), third),
        # summary.json has no infinity: the state knows better.
        (replace(record_of(fourth, load="up"), load_factor=NAN, lower_bound=None, upper_bound=None), fourth),
    ]
    return report(tmp_path_factory.mktemp("report"), results)


@pytest.fixture(scope="module")
def page(page_text: str) -> Page:
    return Page(page_text)


def test_nothing_is_fetched(page: Page, page_text: str) -> None:
    assert page.addresses
    assert [a[:40] for a in page.addresses if not a.startswith(("data:", "#"))] == []
    imports = json.loads(page.scripts["importmap"])["imports"]
    own = {f"churchpipe/{name}.js" for name in ("shell", "tools", "loads")}
    assert set(imports) == {"three", "three/addons/controls/OrbitControls.js", *own}
    assert all(address.startswith("data:text/javascript;base64,") for address in imports.values())
    style = re.search(r"<style>(.*?)</style>", page_text, re.DOTALL)
    assert style
    assert not re.search(r"url\(|@import", style[1])
    # Names of XML vocabularies are the only addresses in the page; they are never requested.
    without_data = re.sub(r"data:[^\"]*", "", page_text)
    assert set(re.findall(r"https?://[^\"'\s<>]+", without_data)) <= {
        "http://www.w3.org/2000/svg",
        "http://www.w3.org/1999/xlink",
    }


def test_every_module_that_a_script_imports_is_inlined(page: Page) -> None:
    imports = json.loads(page.scripts["importmap"])["imports"]
    sources = [page.scripts["module"], *(base64.b64decode(a.split(",", 1)[1]).decode() for a in imports.values())]
    wanted = {name for source in sources for name in re.findall(r"""(?:^|\n)[^\n/]*?\bfrom\s*["']([^"']+)["']""", source)}
    assert wanted == set(imports)


def test_table_holds_the_numbers_of_the_summary(page: Page) -> None:
    first = page.table[0]
    assert first["Analysis"] == "associative"
    assert first["Load"] == "+x"
    assert (first["Friction"], first["Load factor"]) == ("0.7", "0.250000")
    assert (first["Lower bound"], first["Upper bound"]) == ("0.2499999", "0.2500001")
    assert (first["Status"], first["Iterations"], first["Seconds"]) == ("optimal", "17", "1.2")
    assert (first["Equilibrium"], first["Strength"]) == ("2.0e\u221210", "3.0e\u221211")
    second = page.table[1]
    assert (second["Gap g / α"], second["Friction violation"]) == ("2.0e\u221206", "3.0e\u221209")


def test_joints_of_a_stone_have_their_resultants_and_rates() -> None:
    stones = tower()
    contacts = find_contacts(stones)
    top = int(np.flatnonzero((contacts.blocks == [2, 3]).all(axis=1))[0])
    forces = np.zeros((len(contacts.point), 3))
    forces[contacts.point_ptr[top] : contacts.point_ptr[top + 1]] = [4500.0, 300.0, -400.0]
    values = joint_values(stones, contacts, state_of(stones, forces=forces))
    assert values[top, :2] == pytest.approx([18000.0, 2000.0])
    # The two upper cubes turn together: their joint keeps shut, the one below opens by 0.1 rad/s over 1 m.
    below = int(np.flatnonzero((contacts.blocks == [1, 2]).all(axis=1))[0])
    assert values[[top, below], 2] == pytest.approx([0.0, 0.1], abs=1e-9)
    assert values[:, 3] == pytest.approx(np.zeros(len(values)), abs=1e-9)
    # A result without forces leaves the resultants at zero.
    assert not joint_values(stones, contacts, state_of(stones))[:, :2].any()


def test_missing_and_infinite_numbers_are_words(page: Page) -> None:
    second, unstable, unbounded = page.table[1:]
    assert second["Lower bound"] == second["Upper bound"] == "none"
    assert unstable["Load factor"] == "none"
    assert unbounded["Load factor"] == "no limit"
    assert not re.search(r"\b(nan|inf|null|undefined)\b", page.text, re.IGNORECASE)


@pytest.mark.parametrize(
    ("value", "text"),
    [(NAN, "none"), (None, "none"), (INF, "no limit"), (0.2065393, "0.206539"), (-0.5, "\u22120.500000"), (0.0, "0.000000")],
)
def test_figure(value: float | None, text: str) -> None:
    assert figure(value) == text


@pytest.mark.parametrize(("value", "text"), [(NAN, "none"), (INF, "infinite"), (0.0, "0"), (3.14e-10, "3.1e\u221210")])
def test_small(value: float, text: str) -> None:
    assert small(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(0.0, "0.0"), (0.0432, "0.0432"), (0.99, "0.99"), (12.34, "12.3"), (45678.9, "45,678.9"), (None, "none")]
)
def test_small_models_have_figures_too(value: float | None, text: str) -> None:
    assert amount(value, 1) == text


def test_reports_of_other_geometries_are_reached(tmp_path: Path) -> None:
    state = state_of(tower())
    sizes = dict.fromkeys(("base", "length=2", "<b>"), EMPTY)
    first = report(tmp_path, [(record_of(state, geometry="base"), state)], geometries=sizes)
    assert 'href="geometry/length%3D2/report.html">length=2</a>' in first
    assert 'href="geometry/%3Cb%3E/report.html">&lt;b&gt;</a>' in first
    other = report(tmp_path, [(record_of(state, geometry="length=2"), state)], geometries=sizes)
    assert 'href="../../report.html">base</a>' in other


def test_the_title_block_names_work_and_input(tmp_path: Path) -> None:
    stones = tower()
    state = state_of(stones)
    text = report(tmp_path, [(record_of(state), state)])
    assert "SHA-256" in text
    assert "churchpipe 0.1.0" in text
    entries = dict(title_block({"author": "A. Rossi", "client": ""}, "name = 1", VERSIONS))
    assert entries["author"] == "A. Rossi"
    assert "client" not in entries
    assert entries["case file"] != dict(title_block({}, "name = 2", VERSIONS))["case file"]


def test_materials_have_the_stones_that_are_made_of_them() -> None:
    said = [{"name": "default", "friction": 0.6, "cohesion": 2e3}]
    assert material_rows(tower(), said) == [("default", "3", "3", "18", "54", "0.6", "2")]
    assert material_rows(tower(), [])[0][5:] == ("", "")
    swept = [{"material.default.friction": 0.4}, {"material.default.friction": 0.5}, {"material.default.friction": 0.4}]
    assert material_rows(tower(), said, swept)[0][5:] == ("0.4, 0.5", "2")


def test_a_plan_cuts_what_stands_higher() -> None:
    titles = dict(drawings_svg(tower(), drawn_loads(tower(), [])))
    plan, front, *others = titles.values()
    assert next(iter(titles)) == "Plan, cut 1.20 m above the foot"
    assert len(others) == 5  # three more elevations, two sections
    # 1 m wide and deep, 3 m high.
    assert plan.count("1.00 m") == 2
    assert ("1.00 m" in front, "3.00 m" in front) == (True, True)


def test_dimensions_of_high_drawings_can_be_read_on_paper() -> None:
    """A tower is drawn smaller than what is low, so that it fits; its figures are as large."""
    style = (Path(sys.modules[write_report.__module__].__file__ or "").parent / "static" / "report.css").read_text(
        encoding="utf-8"
    )
    printed = style.partition("@media print")[2]
    [most] = re.findall(r"\.drawings svg \{ max-height: ([\d.]+)cm; \}", printed)
    for drawing in dict(drawings_svg(tower(), drawn_loads(tower(), []))).values():
        [(width, height)] = re.findall(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', drawing)
        shown = min(float(most) / float(height), 8.4 / float(width)) * 72 / 2.54
        sizes = [float(size) for size in re.findall(r"font-size: ([\d.]+)px", drawing)]
        assert sizes
        assert min(sizes) * shown > 6.5


def test_dimensions_stand_beside_supports_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """An arch on skewbacks, which are drawn and not measured."""
    stones = cp.derive_blocks(generators.arch(mean_radius=1.0, thickness=0.2, width=0.5, voussoirs=9))
    drawn: list[tuple[float, float, float]] = []

    def kept(plot: Figure) -> str:
        (axes,) = plot.axes
        width = next(text for text in axes.texts if text.get_text().endswith(" m") and not text.get_rotation())
        lowest = min(float(np.asarray(path.vertices, dtype=float)[:, 1].min()) for path in axes.collections[0].get_paths())
        drawn.append((axes.get_ylim()[0], float(width.get_position()[1]), lowest))
        return ""

    monkeypatch.setattr("churchpipe.report.drawings.svg_of", kept)
    drawings_svg(stones, drawn_loads(stones, []))
    assert min(lowest for *_, lowest in drawn) < -0.05
    for least, line, lowest in drawn:
        assert least < line < lowest


def test_what_is_seen_through_a_door_is_darker_than_the_wall_around_it(monkeypatch: pytest.MonkeyPatch) -> None:
    walls = [
        {"name": "front", "start": (0, 0), "end": (4, 0), "toward": "+y"},
        {"name": "back", "start": (0, 4), "end": (4, 4), "toward": "-y"},
    ]
    door = {"name": "door", "wall": "front", "centre": 2.0, "width": 1.0, "height": 2.0}
    building = generators.house(course=0.5, stone_length=1.0, height=3.0, thickness=0.5, walls=walls, openings=[door])
    stones = cp.derive_blocks(building)
    pages: list[Figure] = []
    monkeypatch.setattr("churchpipe.report.drawings.svg_of", lambda plot: pages.append(plot) or "")
    titles = [title for title, _ in drawings_svg(stones, drawn_loads(stones, []))]
    faces = pages[titles.index(ELEVATIONS[0].title)].axes[0].collections[0]

    def brightness(place: tuple[float, float]) -> float:
        """Of the nearest face there, which is the last that is drawn."""
        nearest = max(k for k, path in enumerate(faces.get_paths()) if path.contains_point(place))
        return float(np.array(faces.get_facecolor())[nearest, :3].sum())

    assert brightness((1.8, 0.9)) < brightness((0.7, 0.9)) - 0.3


def test_a_plan_at_the_height_of_a_bed_joint_cuts_the_course_above(monkeypatch: pytest.MonkeyPatch) -> None:
    """Four courses of .3 m end at 1.2 m, where plans are cut: no stone was, and a window above looked like a wall."""
    walls = [{"name": "front", "start": (0, 0), "end": (4, 0), "toward": "+y"}]
    window = {"name": "window", "wall": "front", "centre": 2.0, "width": 1.0, "sill": 1.2, "height": 0.9}
    building = generators.house(course=0.3, stone_length=0.75, height=3.0, thickness=0.5, walls=walls, openings=[window])
    stones = cp.derive_blocks(building)
    pages: list[Figure] = []
    monkeypatch.setattr("churchpipe.report.drawings.svg_of", lambda plot: pages.append(plot) or "")
    assert "Plan, cut 1.20 m above the foot" in dict(drawings_svg(stones, drawn_loads(stones, [])))
    solid = pages[0].axes[0].collections[1]
    areas = [shapely.Polygon(np.asarray(path.vertices, dtype=float)).area for path in solid.get_paths()]
    assert sum(areas) == pytest.approx(3.0 * 0.5)


def test_long_names_break_at_their_underscores_and_are_escaped() -> None:
    assert breakable("vault_nave_skewback_right 12 %") == "vault_<wbr>nave_<wbr>skewback_<wbr>right 12\u00a0%"
    assert breakable("nave_left, <b>_a_name_of_letters</b>").startswith("nave_left, &lt;b&gt;_<wbr>a_")


def test_a_legend_stands_below_its_plot_which_grows_by_it() -> None:
    def size(count: int) -> tuple[float, float]:
        figure, (axes,) = new_plot(1, (WIDTH, 2.8))
        for number in range(count):
            axes.plot([0, 1], [0, number], label=f"load factor of load {number}")
        legend_below(axes)
        return tuple(figure.get_size_inches())

    assert size(0) == pytest.approx((WIDTH, 2.8))
    assert size(1)[0] == size(9)[0] == pytest.approx(WIDTH)
    # Two short labels stand beside each other.
    assert size(1) == pytest.approx(size(2))
    assert size(9)[1] - size(1)[1] == pytest.approx(4 * 0.19)


def test_sections_cut_through_the_middle_both_ways() -> None:
    titles = list(dict(drawings_svg(tower(), drawn_loads(tower(), []))))
    assert titles[-2:] == ["Section at y = 0.50 m, towards +y", "Section at x = 100000.50 m, towards \u2212x"]
    # A wall along x shows its elevation when it is cut along x.
    wall = np.array([0.0, 0.0, 0.0]), np.array([3.2, 0.25, 2.4])
    assert [view.title for view, _ in sections(*wall)] == ["Section at x = 1.60 m, towards \u2212x"]
    # Of its ends the section says more than an elevation.
    assert [view.title for view in elevations(*wall)] == ["Elevation from \u2212y", "Elevation from +y"]


@pytest.mark.parametrize(("view", "level", "area"), [(ELEVATIONS[0], -0.4, 0.6), (ELEVATIONS[1], 0.1, 1.0), (PLAN, 0.5, 0.3)])
def test_a_section_has_the_area_of_what_it_cuts(view: View, level: float, area: float) -> None:
    """A stone of .3 x 1 x 1 m behind, or beside, one of .3 x .5 x 1 m that no plane but y = .4 m reaches."""
    stones = on_ground(box((0, 0.3), (0, 1), (0, 1)), box((0.4, 0.7), (0.3, 0.8), (2, 3)), unit_weight=18e3, reach=3)
    points = stones.points @ np.array([view.across, view.up, view.toward], dtype=float).T
    rings = cut_polygons(stones, ~stones.fixed, points, level)
    assert sum(shapely.Polygon(ring).area for ring in rings) == pytest.approx(area)


def test_unusual_ends_are_explained(page: Page) -> None:
    assert "1 stone moves, fastest first: </script><b>C." in page.text
    assert "does not stand under its own weight" in page.text
    assert "No lateral load of this kind brings the structure down" in page.text


@pytest.mark.parametrize(
    ("lower", "upper", "words"),
    [
        (0.396, 0.397, "The bounds did not meet: the lower bound is 0.39600000, the upper 0.39700000."),
        (0.39659686, 0.39659687, "The bounds meet (the lower bound is 0.39659686, the upper 0.39659687), but the forces do not"),
        (NAN, NAN, "The solver stopped before it had bounds."),
    ],
)
def test_a_failed_analysis_says_what_it_lacks(lower: float, upper: float, words: str) -> None:
    stones = tower()
    state = state_of(stones, load_factor=NAN, lower_bound=lower, upper_bound=upper, status="failed", message="short steps")
    note = status_note(stones, Row(record_of(state), state))
    assert words in note
    assert note.endswith("The solver says: short steps.")
    assert ("did not meet" in note) == (lower == 0.396)


def test_a_curve_says_what_it_leaves_out() -> None:
    """Its load factor is that of joints without the cohesion that stands in the case: the table must not claim it."""
    told = analysis(method="curve", status="converged", cohesion_kPa=50.0, message="cohesion is left out")
    assert status_note(tower(), Row(told)) == "Cohesion is left out."
    cells = {column.title: column.text(Row(told)) for column in COLUMNS}
    assert cells["Cohesion, kPa"] == "left out"
    assert {column.title: column.text(Row(replace(told, method=None))) for column in COLUMNS}["Cohesion, kPa"] == "50"


def test_the_contents_lead_to_every_section(page_text: str) -> None:
    contents = page_text[page_text.index("<nav") : page_text.index("</nav>")]
    links = re.findall(r'<a href="#([\w-]+)">(.+?)</a>', contents)
    assert len(links) > 3
    headed = [part.split('"', 1) for part in page_text.split('<section id="')[1:]]
    assert links == [(name, re.findall("<h2>(.+?)</h2>", rest)[0]) for name, rest in headed]


def test_the_interval_stands_beside_a_load_factor_without_dilatancy(tmp_path: Path) -> None:
    """On its card and in the table of the report, and in that of the terminal, as far as it is known."""
    out = io.StringIO()
    known = analysis(flow="non-associative", load_factor=0.2, interval=(0.19, 0.21))
    for record, words in ((known, "0.1900 to 0.2100"), (replace(known, interval=None), "")):
        assert {column.title: column.text(Row(record)) for column in COLUMNS}["Interval"] == words
        table = results_table(replace(summary(), analyses=(record,)))
        headers = [str(column.header) for column in table.columns]
        assert ("interval" in headers) == bool(words)
        Console(file=out, width=200).print(table)
        shown = Page(report(tmp_path, [], [record])).text
        assert ("interval: 0.1900 to 0.2100" in shown) == bool(words)
    assert "0.200000  0.1900 to 0.2100" in out.getvalue()


def test_non_associative_result_is_explained(page: Page) -> None:
    assert "Load factors compatible with this mechanism: 0.1900 to 0.2100." in page.text
    assert "The starts led to 0.2000, 0.2050; the lowest is the safe one." in page.text
    assert "friction violation" in page.text


def test_not_converged_gives_the_range_of_the_last_steps(tmp_path: Path) -> None:
    history = tuple(Iteration(value, 1e-2) for value in [0.5] + [0.21, 0.24] * 5)
    state = state_of(tower(), flow="non-associative", status="not-converged", load_factor=0.225, history=history)
    state = replace(state, message="most of the gap at a joint of A and B; what helps")
    page = Page(report(tmp_path, [(record_of(state), state)]))
    # Where it lies, and what helps, as in the terminal.
    assert "In detail: most of the gap at a joint of A and B; what helps." in page.text
    assert "Over its last 10 steps the load factor ranged from 0.2100 to 0.2400." in page.text


def test_names_are_escaped(page: Page, page_text: str) -> None:
    assert "tower &amp; co" in page_text
    assert 'name = "<tower>"' in page.text
    assert "<tower>" not in page_text
    assert "<b>C" not in page_text
    assert json.loads(page.scripts["application/json"])["id"][3] == "</script><b>C"


def test_viewer_data_decode_to_the_arrays(page: Page) -> None:
    data = json.loads(page.scripts["application/json"])
    stones = tower()
    points = np.frombuffer(base64.b64decode(data["points"]), "<f4").reshape(-1, 3)
    # The middle of the plan at the foot is the origin: 100 km away float32 would have lost 4 mm.
    np.testing.assert_allclose(points[8:], stones.points[8:] - [1e5 + 0.5, 0.5, 0.0], atol=1e-6)
    centroid = np.frombuffer(base64.b64decode(data["centroid"]), "<f4").reshape(-1, 3)
    np.testing.assert_allclose(centroid[1:], [[0, 0, 0.5], [0, 0, 1.5], [0, 0, 2.5]], atol=1e-6)
    velocities = np.frombuffer(base64.b64decode(data["analyses"][0]["velocities"]), "<f4").reshape(-1, 6)
    np.testing.assert_allclose(velocities, rocking(stones), atol=1e-7)
    assert np.frombuffer(base64.b64decode(data["point_ptr"]), "<u4").tolist() == [0, 8, 16, 24, 32]
    triangle = np.frombuffer(base64.b64decode(data["triangles"]), "<u4").reshape(-1, 3)
    assert len(triangle) == 3 * 12
    assert triangle.min() == 8, "the ground plate is not drawn"
    assert len(np.frombuffer(base64.b64decode(data["edges"]), "<u4")) == 2 * 3 * 12
    assert [panel["name"] for panel in data["panels"] if panel["drawn"]] == ["<belfry>", "shaft"]
    assert [data["panels"][k]["name"] for k in data["panel_of"]] == ["support", "shaft", "shaft", "<belfry>"]
    assert data["ground"] is True
    assert [analysis["moving"] for analysis in data["analyses"]] == [2, 2, 1, 0]
    assert [analysis["push"] is None for analysis in data["analyses"]] == [False, False, True, True]


def test_pictures_are_inlined_and_kept(tmp_path: Path) -> None:
    stones = tower()
    state = state_of(stones)
    record = record_of(state, name="a1")
    write_report(
        tmp_path / "report.html",
        summary=replace(summary(), analyses=(record,)),
        stones=stones,
        contacts=find_contacts(stones),
        results=[(record, state)],
        case_text="",
        versions={},
        figures_dir=tmp_path / "figures",
    )
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    kept = (tmp_path / "figures" / "a1.png").read_bytes()
    assert f'src="data:image/png;base64,{base64.b64encode(kept).decode()}"' in text
    assert sorted(p.name for p in tmp_path.iterdir()) == ["figures", "report.html"]


def test_report_without_graphics_is_still_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Neither in a process of its own nor in a fork.
    monkeypatch.setattr(sys, "executable", "/bin/false")
    monkeypatch.setitem(sys.modules, "pyvista", None)
    stones = tower()
    state = state_of(stones)
    results = [(record_of(state), state)]
    path = tmp_path / "report.html"
    given = {"summary": replace(summary(), analyses=(results[0][0],)), "case_text": "", "versions": {}}
    write_report(path, stones=stones, contacts=find_contacts(stones), results=results, **given)
    page = Page(path.read_text(encoding="utf-8"))
    assert "Pictures could not be drawn" in page.text
    assert page.table[0]["Load factor"] == "0.250000"
    assert "module" in page.scripts


def test_sections_follow_the_content(tmp_path: Path) -> None:
    state = state_of(tower())
    shell, own = analysis(name="s", model="homogenised-shell", method="limit", load_factor=0.31), record_of(state)
    plain = Page(report(tmp_path, [(record_of(state), state)]))
    assert "Sliding without dilatancy" not in plain.text
    assert "Gap g / α" not in plain.rows[0]
    assert "Model" not in plain.rows[0]
    both = Page(report(tmp_path, [(own, state)], [own, shell], shell={"elements": 1440, "nodes": 800, "element_size_mm": 60.0}))
    assert [(row["Model"], row["Load factor"]) for row in both.table] == [
        ("rigid blocks", "0.250000"),
        ("shell", "0.310000"),
    ]
    assert "1,440" in both.text


def test_sweep_has_its_columns_and_its_plot(tmp_path: Path) -> None:
    stones = tower()
    results = []
    for friction, factor in ((0.4, 0.2), (0.6, 0.3)):
        for bricks in (14, 16):
            state = state_of(stones, load_factor=factor)
            swept = {"material.default.friction": friction, "source.main_wall_bricks": bricks}
            name = f"{friction}-{bricks}"
            results.append((record_of(state, friction=friction, name=name, swept=swept), state))
    text = report(tmp_path, results)
    page = Page(text)
    assert [row["main wall bricks"] for row in page.table] == ["14", "16", "14", "16"]
    assert page.rows[0].count("Friction") == 1
    assert "Load factor against friction." in page.text
    assert len({analysis["label"] for analysis in json.loads(page.scripts["application/json"])["analyses"]}) == 4


def test_convergence_plot_shows_what_it_has() -> None:
    stones = tower()
    state = state_of(stones, flow="non-associative", history=(Iteration(0.3, 0.1), Iteration(0.25, 0.0)))
    plain = convergence_svg(state)
    assert plain.startswith("<svg")
    assert "interval of the mechanism" not in plain
    assert "gap g" not in plain
    full = convergence_svg(replace(state, interval=(0.2, 0.3), history=(*state.history, Iteration(0.25, 0.0, 1e-6))), 0.31)
    assert all(words in full for words in ("interval of the mechanism", "associative, 0.3100", "gap g"))


def test_load_factors_that_hardly_differ_are_ticks_as_they_are() -> None:
    # And not as 0.2 to 1.0, with "1e-5+2.4999e-1" in the corner.
    history = (Iteration(0.2499925, 0.1, 1e-4), Iteration(0.2499982, 0.0, 1e-5), Iteration(0.2499995, 0.0, 1e-6))
    drawn = convergence_svg(state_of(tower(), flow="non-associative", history=history), 0.25)
    texts = re.findall(r"<text[^>]*>([^<]*)</text>", drawn)
    assert not [text for text in texts if "e\u2212" in text or "+" in text]
    assert {"0.249992", "0.249998"} <= set(texts)


def test_picture_shows_the_mechanism(tmp_path: Path) -> None:
    stones = tower()
    mechanism_picture(stones, rocking(stones), tmp_path / "moved.png", push=np.array([1.0, 0, 0]), size=(300, 220))
    mechanism_picture(stones, None, tmp_path / "still.png", size=(300, 220))
    moved, still = imread(tmp_path / "moved.png")[..., :3], imread(tmp_path / "still.png")[..., :3]
    assert moved.shape == (220, 300, 3)
    red = (moved[..., 0] > 0.4) & (moved[..., 1] < 0.3) & (moved[..., 2] < 0.3)
    assert red.mean() > 0.01, "the fastest stones are dark red"
    assert np.abs(moved - still).mean() > 0.02


def test_stones_that_move_as_one_body_stay_together_and_keep_their_shape() -> None:
    stones = tower()
    moved = displaced_points(stones, rocking(stones), 8.0)
    body = stone_of_point(stones) >= 2
    before, after = (np.linalg.norm(p[body][:, None] - p[body][None], axis=2) for p in (stones.points, moved))
    np.testing.assert_allclose(after, before, atol=1e-9)
    # 0.8 rad about the edge x = 1, z = 1: the far lower edge, 1 m away, rises by sin 0.8.
    np.testing.assert_allclose(
        moved[16:24][stones.points[16:24, 0] == 1e5][0], [1e5 + 1 - np.cos(0.8), 0, 1 + np.sin(0.8)], atol=1e-9
    )
    np.testing.assert_array_equal(moved[~body], stones.points[~body])


@settings(deadline=None)
@given(st.lists(st.floats(-2, 2), min_size=6, max_size=6))
def test_displacement_starts_along_the_velocity(u: list[float]) -> None:
    stones = on_ground(prism([(0, 0), (2, 0), (0, 1)], 0.5))
    velocities = np.zeros((2, 6))
    velocities[1] = u
    step = 1e-6
    rate = (displaced_points(stones, velocities, step) - stones.points)[8:] / step
    expected = velocities[1, :3] + np.cross(velocities[1, 3:], stones.points[8:] - stones.centroid[1])
    np.testing.assert_allclose(rate, expected, atol=3e-5)


def test_speed_amplitude_and_who_moves() -> None:
    stones = tower()
    speed = stone_speed(stones, rocking(stones))
    np.testing.assert_allclose(speed, [0, 0, 0.1 * np.sqrt(2), 0.1 * np.sqrt(5)])
    assert moving_stones(speed).tolist() == [False, False, True, True]
    assert natural_amplitude(stones, speed) * reference_speed(speed) == pytest.approx(0.08 * np.sqrt(11))
    assert natural_amplitude(stones, np.zeros(4)) == 0.0
    assert not moving_stones(np.zeros(4)).any()


def test_one_loose_stone_does_not_hide_the_mechanism() -> None:
    speed = np.concatenate([np.full(200, 1.0), [100.0]])
    assert reference_speed(speed) == 25.0
    assert moving_stones(speed).all()


def test_ground_plate_is_told_from_other_supports() -> None:
    skewback = box((-1, 0), (0, 1), (0, 1))
    stones = Assemblage.from_polyhedra([box((-9, 9), (-9, 9), (-1, 0)), skewback, box((0, 1), (0, 1), (0, 1))], 1e4, fixed=[0, 1])
    assert ground_plate(stones).tolist() == [True, False, False]


def test_view_frames_every_point_and_faces_the_push() -> None:
    stones = tower()
    toward = viewpoint(stones, rocking(stones))
    assert np.linalg.norm(toward) == pytest.approx(1)
    assert toward[0] > 0
    points = stones.points[8:]
    position, focus = camera_position(points, toward, 24.0, 1.5)
    depth = (position - points) @ toward
    across = (points - position) - ((points - position) @ toward)[:, None] * toward
    right = np.cross([0, 0, 1], toward) / np.linalg.norm(np.cross([0, 0, 1], toward))
    slope = np.tan(np.deg2rad(12))
    assert (np.abs(across @ right) <= 1.5 * slope * depth).all()
    assert (np.abs(across @ np.cross(toward, right)) <= slope * depth).all()
    np.testing.assert_allclose(np.cross(position - focus, toward), 0, atol=1e-9)


@pytest.mark.parametrize(
    ("direction", "expected"),
    [([0, -1, 0], [0, -1, 0]), ([3, 4, 0], [0.6, 0.8, 0]), ([0, 0, 0], None)],
)
def test_push_direction(direction: list[float], expected: list[float] | None) -> None:
    found = push_direction(analysis(direction=direction))
    assert (None if found is None else found.tolist()) == expected


def test_triangles_cover_the_faces_convex_or_not() -> None:
    ell = prism([(0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3)], 0.5)
    stones = on_ground(ell, box((3, 4), (0, 1), (0, 1)))
    drawn = ~ground_plate(stones)
    corner = stones.points[triangles(stones, drawn)]
    cross = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 2
    shown = np.repeat(drawn, np.diff(stones.block_face_ptr))
    area, _, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    assert np.linalg.norm(cross, axis=1).sum() == pytest.approx(np.linalg.norm(area[shown], axis=1).sum())
    # Outward everywhere: the divergence theorem gives the volume, 4 m2 x 0.5 m + 1 m3.
    assert np.einsum("ij,ij->", corner.mean(axis=1), cross) / 3 == pytest.approx(3.0)
    assert len(edges(stones, drawn)) == 18 + 12


PARTS = [
    {"name": "<belfry>", "weight_kN": 18.0, "moving": 1.0, "displacement": 1.0, "motion": 0.75},
    {"name": "shaft", "weight_kN": 36.0, "moving": 0.5, "displacement": -0.25, "motion": 0.25},
    {"name": "crypt", "weight_kN": 9.0, "moving": 0.0, "displacement": 0.0, "motion": 0.0},
]
CHECK = {
    "alpha0": 0.25,
    "moving_weight_kN": 36.0,
    "participating_mass_t": 3.304,
    "mass_fraction": 0.9,
    "confidence_factor": 1.35,
    "a0_m_s2": 2.0178,
    "a0_lumped_m_s2": 1.816,
    "moving_stones": 2,
}
SITED = {
    "a_g_m_s2": 1.5,
    "soil_factor": 1.2,
    "q": 2.0,
    "demand_m_s2": 0.9,
    "a_g_slv_m_s2": 3.027,
    "zeta_e": 2.018,
    "satisfied": True,
    "a_g_slv_stones_m_s2": 3.363,
    "zeta_e_stones": 2.242,
    "satisfied_stones": True,
}


def test_macro_elements_are_listed(tmp_path: Path) -> None:
    state = state_of(tower())
    page = Page(report(tmp_path, [(record_of(state, parts=PARTS), state)]))
    assert ["<belfry>", "18.0", "100 %", "1.00", "75.0 %"] in page.rows
    assert ["shaft", "36.0", "50 %", "\u22120.25", "25.0 %"] in page.rows
    assert "At rest: crypt." in page.text
    assert "crypt" not in {row[0] for row in page.rows if row}


def test_the_check_without_a_site_compares_nothing(tmp_path: Path) -> None:
    state = state_of(tower())
    page = Page(report(tmp_path, [(record_of(state, check=CHECK), state)]))
    [cells] = [row for row in page.rows if "3.3" in row]
    assert cells[1:] == ["0.2500", "36", "2", "1.35", "1.816", "3.3", "0.900", "2.018"]
    assert "The case does not say what the earthquake asks" in page.text
    assert "where crushing of the masonry is not modelled, the circular asks" in page.text


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({}, "satisfied"),
        ({"satisfied": False}, "only with e* of stones"),
        ({"satisfied": False, "satisfied_stones": False}, "not satisfied"),
    ],
)
def test_the_check_with_a_site_has_a_verdict(tmp_path: Path, changes: dict, word: str) -> None:
    state = state_of(tower())
    check = CHECK | SITED | changes
    other = {"message": "check: the load is not horizontal."}
    text = report(tmp_path, [(record_of(state, check=check), state), (record_of(state, "up", check=other), state)])
    # The verdict on the building stands before all load factors.
    told = "satisfied" if word == "satisfied" else "not satisfied"
    before = " ".join(Page(text.partition('<section class="cards"')[0]).text.split())
    assert f"Safety check: {told}." in before
    assert (
        "is 2.02 (associative, load +x, friction 0.7): the ground acceleration that the building withstands, over the "
        "a_g = 1.500 m/s\u00b2 that is asked for. It is made of an associative load factor" in before
    )
    assert ("Under +x the building does not bear" in before) == (told == "not satisfied")
    # A card whose check fails is not as green as the solver is content.
    assert ('class="card optimal unsafe"' in text) == (word != "satisfied")
    page = Page(text)
    [cells] = [row for row in page.rows if "3.3" in row]
    assert cells[9:] == ["1.500", "1.20", "2.0", "0.900", "3.027", "2.02", "2.24", word]
    assert f"\u03b6_E = 2.02, {word}; with e* of the stones 2.24" in page.text
    assert "a_Z / q" not in page.text
    assert "no check. check: the load is not horizontal." in page.text


def test_the_check_of_a_storey_says_what_the_height_asks(tmp_path: Path) -> None:
    state = state_of(tower())
    check = CHECK | SITED
    with_floor = check | {"floor_demand_m_s2": 2.45}
    above = Page(report(tmp_path, [(record_of(state, check=with_floor), state)])).text
    assert "a_Z = S_e(T1) \u03b3 \u03c8" in above
    assert "give [check.floor]" not in above
    ground = Page(report(tmp_path, [(record_of(state, check=check), state)])).text
    assert "give [check.floor]" in ground
    assert "a_Z = S_e(T1)" not in ground
    assert "\u03b1\u2080 is the work of the collapse load" in ground


def test_a_check_that_no_load_has_is_said_at_the_head(tmp_path: Path) -> None:
    state = state_of(tower())
    refused = {"message": "the load is not horizontal.", "a_g_m_s2": 1.5}
    text = report(tmp_path, [(record_of(state, "up", check=refused), state)])
    before = " ".join(Page(text.partition('<section class="cards"')[0]).text.split())
    assert "Safety check: not made. No load of the case has a check: associative, load up, friction 0.7." in before
    assert "no check. the load is not horizontal." in Page(text).text


def test_of_a_load_the_check_by_displacements_governs_and_of_several_loads_the_lowest() -> None:
    def row(load: str, zeta_e: float, check: type[SafetyCheck | DisplacementCheck], **more: str) -> Row:
        satisfied = zeta_e >= 1
        return Row(replace(analysis(load=load, **more), check=check(zeta_e=zeta_e, a_g=1.5, satisfied=satisfied)))

    rows = [row("+x", 0.8, SafetyCheck), row("+x", 1.4, DisplacementCheck, method="curve"), row("+y", 1.6, SafetyCheck)]
    asked = [one.load for one in rows]
    found = overall(rows, asked)
    assert found is not None
    assert (found["satisfied"], "is 1.40 (capacity curve" in found["words"]) == (True, True)
    # The card of the same load says otherwise, in red.
    assert "that one decides. By accelerations alone" in found["words"]
    assert f"the lowest \u03b6_E is 0.80 ({rows[0].label})." in found["words"]
    found = overall(rows[1:], asked[1:])
    assert found is not None
    assert "decides" not in found["words"]
    found = overall(rows, asked)
    assert found is not None
    found = overall([*rows, row("-y", 0.9, SafetyCheck)], [*asked, "-y"])
    assert found is not None
    assert not found["satisfied"]
    assert found["words"].startswith("Under \u2212y the building does not bear")
    assert overall([Row(analysis())], ["+x"]) is None


def test_the_verdict_names_what_moves() -> None:
    south, east = (Part(name, 1e4, 1.0, 1.0, motion) for name, motion in (("south storey 2", 0.93), ("east", 0.07)))
    check = SafetyCheck(zeta_e=0.8, a_g=1.5, satisfied=False)
    limit = Row(replace(analysis(load="-y"), check=check, parts=(south, east)))
    found = overall([limit], ["-y"])
    assert found is not None
    assert "What moves, by its share of the motion: south storey 2 93 %, east 7 %." in found["words"]
    # The record of a curve does not say it; what starts the curve is the mechanism of the limit analysis beside it.
    curve = Row(replace(analysis(load="-y", method="curve"), check=DisplacementCheck(zeta_e=0.9, a_g=1.5, satisfied=False)))
    found = overall([limit, curve], ["-y", "-y"])
    assert found is not None
    assert f"is 0.90 ({curve.label})" in found["words"]
    assert f"What starts to move ({limit.label}), by its share of the motion: south storey 2 93 %, east 7 %." in found["words"]


def test_without_check_and_parts_there_are_no_such_sections(tmp_path: Path) -> None:
    state = state_of(tower())
    page = Page(report(tmp_path, [(record_of(state), state)]))
    assert "What moves" not in page.text
    assert "Safety check" not in page.text


def test_report_tells_of_near_misses_and_pictures_the_gaps(tmp_path: Path) -> None:
    exact, open_heads = corner(), corner(head_gap=0.01)
    assert gaps_svg(find_contacts(exact)) == ""
    path = tmp_path / "report.html"
    given = {"summary": summary(), "results": [], "case_text": "", "versions": {}}
    write_report(path, stones=open_heads, contacts=find_contacts(open_heads), **given)
    text = path.read_text(encoding="utf-8")
    assert "Near misses: 48 pairs of faces" in text
    assert "contact gap, 0.002" in text
