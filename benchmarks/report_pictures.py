"""The pictures of the manual that show a report, or were drawn for one.

    python benchmarks/report_pictures.py [PICTURE ...]     # all, or those named; they go to docs/pictures

Each is taken of the run of a ready case in the folder runs/, which is made if it is not there or no longer up to date. What shows
a part of the page is taken in a browser (Chromium).
"""

import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, ViewportSize, sync_playwright

FOLDER = Path("docs/pictures")
# Picture -> ready case, and what of its run: a file of the folder figures/; "top", the head of the page; "#id", a section of it.
PICTURES = {
    "s22_mechanism": ("s22", "-y_associative.png"),
    "s22_overlay": ("s22", "-y_limit_overlay.png"),
    "variants_report": ("chapel_variants", "top"),
    "uncertainty": ("s5_uncertain", "#uncertainty"),
    "church_convergence": ("church_sliding", "#convergence"),
}
WINDOW: ViewportSize = {"width": 1200, "height": 1760}


def main(names: Sequence[str]) -> None:
    """Make the runs and take the pictures."""
    for name in names or PICTURES:
        case, what = PICTURES[name]
        done = subprocess.run(["churchpipe", "run", f"pipeline/cases/{case}.toml"], check=False)
        if done.returncode not in (0, 3):
            sys.exit(f"{name}: the run of {case} failed")
        run, picture = Path("runs", case), FOLDER / f"{name}.png"
        if what.endswith(".png"):
            shutil.copyfile(run / "figures" / what, picture)
        else:
            photographed(run / "report.html", what, picture)
        print(picture, flush=True)


def photographed(page: Path, what: str, picture: Path) -> None:
    """Take a picture of the head of a page, or of a section of it."""
    with new_sheet() as sheet:
        sheet.goto(page.resolve().as_uri())
        sheet.wait_for_function("document.body.dataset.ready === 'true'")
        (sheet if what == "top" else sheet.locator(what)).screenshot(path=picture)
    with_few_colours(picture)


def drawing_photographed(drawing: str, picture: Path) -> None:
    """Take a picture of a drawing (SVG)."""
    with new_sheet(scale=2) as sheet:
        sheet.set_content(drawing)
        sheet.locator("svg").screenshot(path=picture)
    with_few_colours(picture)


@contextmanager
def new_sheet(scale: float = 1) -> Iterator[Page]:
    """Yield an empty page of a browser; scale: pixels of a picture for one of the page."""
    with sync_playwright() as play:
        program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
        if program is None:
            sys.exit("pictures of a report: no browser found, expected chromium or google-chrome; sudo apt-get install chromium")
        browser = play.chromium.launch(executable_path=program, args=["--no-sandbox", "--enable-unsafe-swiftshader"])
        yield browser.new_page(viewport=WINDOW, device_scale_factor=scale)
        browser.close()


def with_few_colours(picture: Path) -> None:
    """Write a picture again with a palette: a third of its size."""
    Image.open(picture).convert("P", palette=Image.Palette.ADAPTIVE).save(picture, optimize=True)


if __name__ == "__main__":
    main(sys.argv[1:])
