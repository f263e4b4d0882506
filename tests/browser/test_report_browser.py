"""The report in a real browser: the tools of its viewer, what it saves, and no word of complaint on the console."""

import io
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, sync_playwright

from churchpipe import cli
from damaged_drawings import write_damaged

CASE = Path(__file__).parents[2] / "pipeline" / "cases" / "wall.toml"
pytestmark = pytest.mark.slow("README: the report works in a browser, offline")


def report_of(case: Path, folder: Path) -> Path:
    """The report of a run of a case."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["churchpipe", "run", str(case), "--out", str(folder)])
        with pytest.raises(SystemExit) as left:
            cli.main()
    assert left.value.code == 0
    return folder / "report.html"


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return report_of(CASE, tmp_path_factory.mktemp("run"))


# A corner that sinks below a wall that carries a roof, and five samples of its friction; its names are hostile.
SETTLING = """
name = "settling"
[project]
title = "<script>document.title = 'taken'</script> Größe & Maß, Kirchengemeinde_Sankt_Ägidien_und_Sankt_Nikolaus"
[source]
generator = "wall"
length_m = 1.6
brick_mm = [400, 250, 200]
courses = 5
[material.default]
unit_weight_kN_m3 = 18
friction = 0.6
[[line_loads]]
name = "<img src=x onerror=alert(1)> roof_of_the_nave_and_of_the_long_northern_aisle_with_its_lanterns"
wall = "wall"
dead_kN_m = 3
[[load]]
direction = [0, 1, 0]
[[movements]]
name = "corner_below_the_tower_<b>north_west</b>_where_the_ground_was_found_to_be_soft"
within_mm = [[-100, -500], [500, 500]]
furthest_mm = 20
step_mm = 10
[sample]
number = 5
[[sample.parameters]]
key = "material.default.friction"
distribution = "uniform"
low = 0.5
high = 0.7
"""


@pytest.fixture(scope="module")
def settling(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("settling")
    (folder / "case.toml").write_text(SETTLING, encoding="utf-8")
    return report_of(folder / "case.toml", folder / "run")


@pytest.fixture(scope="module")
def chromium() -> str:
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    assert found, "no Chromium found: scripts/slow.sh installs it"
    return found


@pytest.fixture(params=[1400, 390], ids=["screen", "phone"])
def page(request: pytest.FixtureRequest, report: Path, chromium: str) -> Iterator[Page]:
    yield from opened(report, request.param, chromium)


def opened(file: Path, width: int, chromium: str, colours: Literal["light", "dark"] = "light") -> Iterator[Page]:
    """A page in the browser, which complains of nothing and asks nothing of the network."""
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--enable-unsafe-swiftshader"])
        page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=colours)
        # Without a graphics card, and beside other work, a picture takes long.
        page.set_default_timeout(180_000)
        complaints: list[str] = []
        requests: list[str] = []
        page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda wanted: requests.append(wanted.url))
        page.goto(file.as_uri())
        page.wait_for_function("document.body.dataset.ready === 'true'")
        yield page
        assert complaints == []
        assert [url for url in requests if not url.startswith(("file:", "data:", "blob:"))] == []
        browser.close()


def test_nothing_is_cut(page: Page) -> None:
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    # Nor has anything to be scrolled sideways: wide tables are stacked, headings beside their cells.
    inside = (
        "[...document.querySelectorAll('.scroll, pre, figure')].filter((box) => box.scrollWidth > box.clientWidth + 1).length"
    )
    assert page.evaluate(inside) == 0
    wide = page.locator("#load-factors .scroll")
    assert ("stacked" in (wide.get_attribute("class") or "")) == page.evaluate("window.innerWidth < 700")
    cell = wide.locator("td.factor").first
    assert cell.get_attribute("data-heading") == "Load factor"


# Both flow rules of a building and of a variant: all columns that a case of stones has as a rule.
TIED = """
name = "tied"
[source]
generator = "wall"
length_m = 1.6
brick_mm = [400, 250, 200]
courses = 5
[material.default]
unit_weight_kN_m3 = 18
friction = 0.6
[[load]]
direction = [1, 0, 0]
[rigid]
flow = ["associative", "non-associative"]
[[variants]]
name = "a roof on the wall"
[[variants.add.line_loads]]
name = "roof"
wall = "wall"
dead_kN_m = 3
"""


@pytest.fixture(scope="module")
def tied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tied")
    (folder / "case.toml").write_text(TIED, encoding="utf-8")
    return report_of(folder / "case.toml", folder / "run")


@pytest.mark.parametrize(("width", "stacked", "beside"), [(1400, False, 15), (1200, False, 15), (900, True, 2), (390, True, 1)])
def test_load_factors_stand_side_by_side_where_there_is_room(
    tied: Path, chromium: str, width: int, stacked: bool, beside: int
) -> None:
    for page in opened(tied, width, chromium):
        box = page.locator("#load-factors .scroll")
        assert ("stacked" in (box.get_attribute("class") or "")) == stacked
        assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
        assert box.evaluate("(box) => box.scrollWidth <= box.clientWidth + 1")
        cells = box.locator("tbody tr").last.locator("td")
        assert len(set(cells.evaluate_all("(cells) => cells.map((cell) => cell.offsetLeft)"))) >= beside


@pytest.mark.parametrize("colours", ["light", "dark"])
@pytest.mark.parametrize("width", [1400, 390])
def test_a_support_that_settles_and_hostile_names(
    settling: Path, chromium: str, width: int, colours: Literal["light", "dark"]
) -> None:
    for page in opened(settling, width, chromium, colours):
        assert page.title() != "taken"
        assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
        # No word is cut by the box that it stands in.
        cut = """[...document.querySelectorAll('h1, h2, h3, p, li, dd, td, th, figcaption, .card, option')]
            .filter((box) => box.scrollWidth > box.clientWidth + 1 && getComputedStyle(box).display !== 'inline')
            .map((box) => box.tagName + ' ' + box.textContent.slice(0, 60))"""
        assert page.evaluate(cut) == []
        words = page.evaluate(
            """[...document.querySelectorAll("#movements svg text")].map((text) => text.getBoundingClientRect())
            .map((box) => Math.min(box.width, box.height))"""
        )
        assert words
        assert min(words) > 3.5
        left = page.evaluate("[...document.querySelector('.panels').children].map((one) => one.getBoundingClientRect().left)")
        assert (len(set(left)) == 1) == (width < 700)


def test_a_report_of_a_moved_support_is_printed_without_half_empty_pages(settling: Path) -> None:
    import weasyprint

    def filled(page: Any) -> float:
        """How far down a page words and pictures reach, as a share of its height; its footer is not counted."""
        shown = [
            box
            for box in page._page_box.descendants()
            if type(box).__name__ in ("TextBox", "InlineReplacedBox", "BlockReplacedBox") and box.position_y < page.height - 80
        ]
        return max((box.position_y + box.height for box in shown), default=0.0) / page.height

    pages = [filled(page) for page in weasyprint.HTML(filename=str(settling)).render().pages]
    assert len(pages) > 2
    assert min(pages[:-1]) > 0.65, pages


def test_dimensions_of_drawings_can_be_read(page: Page) -> None:
    heights = page.evaluate(
        """[...document.querySelectorAll(".drawings svg text")].map((text) => text.getBoundingClientRect())
        .map((box) => Math.min(box.width, box.height))"""
    )
    assert heights
    assert min(heights) > 8


def test_a_stone_shows_its_joints(page: Page) -> None:
    page.select_option("#viewer-viewpoint", "from the front")
    canvas = page.locator("#viewer-canvas")
    box = canvas.bounding_box()
    assert box
    canvas.click(position={"x": 0.5 * box["width"], "y": 0.75 * box["height"]})
    assert page.inner_text("#viewer-picked").startswith("Stone wall-")
    assert "bed" in page.inner_text("#viewer-joints")
    before = canvas.screenshot()
    page.locator("#viewer-joints button").first.click()
    assert canvas.screenshot() != before
    assert page.locator("#viewer-joints .marked").count() == 1


def test_a_stone_is_found_by_its_name_and_marked(page: Page) -> None:
    before = page.locator("#viewer-canvas").screenshot()
    page.fill("#viewer-stone", "wall-0-0")
    page.press("#viewer-stone", "Enter")
    assert page.inner_text("#viewer-picked") == "no stone wall-0-0"
    page.select_option("#viewer-viewpoint", "from the front")
    name = page.evaluate("JSON.parse(document.getElementById('viewer-data').textContent).id.at(-1)")
    page.fill("#viewer-stone", name)
    page.press("#viewer-stone", "Enter")
    assert page.inner_text("#viewer-picked").startswith(f"Stone {name}: wall")
    assert "bed" in page.inner_text("#viewer-joints")
    assert page.locator("#viewer-canvas").screenshot() != before
    # How far it moves is told for what is shown.
    told = page.inner_text("#viewer-picked")
    page.locator("#viewer-amplitude").fill("90")
    assert page.inner_text("#viewer-picked") != told
    # The largest displacement is that of the fastest stone.
    fastest = page.evaluate(
        """(() => {
            const data = JSON.parse(document.getElementById('viewer-data').textContent);
            const bytes = Uint8Array.from(atob(data.analyses[0].speed), (letter) => letter.charCodeAt(0));
            const speed = new Float32Array(bytes.buffer);
            return data.id[speed.indexOf(Math.max(...speed))];
        })()"""
    )
    page.fill("#viewer-stone", fastest)
    page.press("#viewer-stone", "Enter")
    largest = page.inner_text("#viewer-moved").removeprefix("largest displacement as drawn ")
    assert page.inner_text("#viewer-picked").endswith(f", moves {largest}")


def test_keys_turn_and_zoom_the_view(page: Page) -> None:
    canvas = page.locator("#viewer-canvas")
    for key in ("ArrowLeft", "ArrowUp", "+"):
        before = canvas.screenshot()
        canvas.press(key)
        assert canvas.screenshot() != before


def test_full_screen_is_offered(page: Page) -> None:
    page.click("#viewer-full")
    page.wait_for_function("document.fullscreenElement === document.getElementById('viewer')")


def test_a_section_and_hidden_parts_change_the_picture(page: Page) -> None:
    def picture() -> Image.Image:
        return Image.open(io.BytesIO(page.locator("#viewer-canvas").screenshot())).convert("L")

    def changed(one: Image.Image, other: Image.Image) -> float:
        return float((np.abs(np.asarray(one, dtype=np.int16) - np.asarray(other, dtype=np.int16)) > 8).mean())

    whole = picture()
    page.select_option("#viewer-section", "z")
    assert changed(whole, picture()) > 0.02
    page.select_option("#viewer-section", "")
    assert changed(whole, picture()) < 0.002
    page.click("summary:has-text('Parts')")
    page.uncheck("#viewer-parts input >> nth=-1")
    assert changed(whole, picture()) > 0.02


@pytest.mark.parametrize("width", [1400, 390])
def test_a_model_is_looked_at_before_any_analysis(tmp_path: Path, chromium: str, width: int) -> None:
    hostile = "</script><script>document.title = 'taken'</script>"
    case = tmp_path / "named.toml"
    text = CASE.read_text(encoding="utf-8").replace('name = "wall"', f'name = "wall"\n[project]\ntitle = "{hostile}"')
    roof = f'[[line_loads]]\nname = "{hostile}"\nwall = "wall"\ndead_kN_m = 3\n'
    case.write_text(text + roof, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["churchpipe", "view", str(case), "--no-open", "--out", str(tmp_path / "view.html")])
        with pytest.raises(SystemExit):
            cli.main()
    for page in opened(tmp_path / "view.html", width, chromium):
        assert page.title() != "taken"
        assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
        page.click("summary:has-text('Parts')")
        loaded = page.locator("#viewer-canvas").screenshot()
        page.uncheck("#viewer-loads")
        assert page.locator("#viewer-canvas").screenshot() != loaded
        page.uncheck("#viewer-parts input >> nth=0")


@pytest.mark.parametrize("colours", ["light", "dark"])
@pytest.mark.parametrize("width", [1400, 390])
@pytest.mark.parametrize(("damage", "severity"), [("duplicate_stone", "error"), ("wrong_volume", "warning")])
def test_what_was_found_in_a_drawing_is_shown_in_its_place(
    tmp_path: Path, chromium: str, damage: str, severity: str, width: int, colours: Literal["light", "dark"]
) -> None:
    write_damaged(tmp_path)
    drawing = (tmp_path / f"{damage}.dxf").rename(tmp_path / "<img src=x onerror=alert(1)> wall.dxf")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["churchpipe", "check", str(drawing), "--out", str(tmp_path / "found")])
        with pytest.raises(SystemExit) as left:
            cli.main()
    assert left.value.code == (severity == "error")
    for page in opened(tmp_path / "found" / "findings.html", width, chromium, colours):
        assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
        assert page.inner_text("h1") == drawing.name
        first = page.locator(f"details.{severity}").first
        if severity == "warning":
            first.locator("summary").click()
        assert first.locator("li").first.is_visible()
        # The mark of the finding: a red ball on blue stones, an amber one on stones of brick.
        canvas = page.locator("#viewer-canvas")
        red, green, blue = np.moveaxis(
            np.asarray(Image.open(io.BytesIO(canvas.screenshot())).convert("RGB"), dtype=np.int16), -1, 0
        )
        ball = red - green > 60 if severity == "error" else green - blue > 60
        assert 10 < ball.sum() < 0.02 * ball.size
        box = canvas.bounding_box()
        assert box
        canvas.click(position={"x": 0.5 * box["width"], "y": 0.6 * box["height"]})
        assert page.inner_text("#viewer-picked").startswith("Stone ")


def test_the_motion_plays(page: Page) -> None:
    page.click("#viewer-play")
    page.wait_for_function("document.getElementById('viewer-play').textContent === 'Pause'")
    first = page.evaluate("document.getElementById('viewer-canvas').dataset.amplitude")
    page.wait_for_function("document.getElementById('viewer-canvas').dataset.amplitude !== " + repr(first))


def test_pictures_and_tables_are_saved(page: Page) -> None:
    with page.expect_download() as picture:
        page.click("#viewer-picture")
    assert Path(picture.value.path()).read_bytes().startswith(b"\x89PNG")
    with page.expect_download() as table:
        page.locator("button.csv").first.click()
    text = Path(table.value.path()).read_text(encoding="utf-8-sig")
    assert "Load factor" in text
    assert "0.470951" in text
    # Spreadsheets know no other minus sign.
    assert re.search(r",\d\.\de-\d\d,", text)
    assert "\u2212" not in text
