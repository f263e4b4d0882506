"""A report of three cubes, and what its page says."""

import itertools
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from html.parser import HTMLParser
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from churchpipe.io.records import Analysis
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.results import LimitState
from churchpipe.report.html import write_report
from churchpipe.stones.contacts import find_contacts
from records import analysis, summary
from solids import box

VERSIONS = {"churchpipe": "0.1.0", "clarabel": "0.11.1"}
DIRECTIONS = {"+x": [1.0, 0.0, 0.0], "-x": [-1.0, 0.0, 0.0], "+y": [0.0, 1.0, 0.0], "-y": [0.0, -1.0, 0.0]}
NAN, INF = float("nan"), float("inf")


def tower() -> Assemblage:
    """Three cubes of 1 m, one on the other, far from the origin."""
    cubes = [box((1e5, 1e5 + 1), (0, 1), (i, i + 1)) for i in range(3)]
    return Assemblage.from_polyhedra(
        [box((0, 2e5), (-1e5, 1e5), (-1, 0)), *cubes],
        18e3,
        fixed=[0],
        panel=["ground", "shaft", "shaft", "<belfry>"],
        course=[-1, 0, 1, 2],
        block_id=["G", "A", "B", "</script><b>C"],
    )


def rocking(stones: Assemblage) -> np.ndarray:
    """The two upper cubes of `tower` turn together about the lower edge of the second, towards +x, at 0.1 rad/s."""
    u = np.zeros((4, 6))
    spin = np.array([0.0, 0.1, 0.0])
    u[2:, :3] = np.cross(spin, stones.centroid[2:] - [1e5 + 1, 0, 1])
    u[2:, 3:] = spin
    return u


def state_of(stones: Assemblage, **changes: object) -> LimitState:
    base = LimitState(0.25, "optimal", 0.2499999, 0.2500001, np.zeros((0, 3)), rocking(stones), 2e-10, 3e-11, 17, 1.25)
    return replace(base, **changes)


_NUMBERS = count(1)


def record_of(state: LimitState, load: str = "+x", friction: float = 0.7, **more: object) -> Analysis:
    keys = ("flow", "load_factor", "lower_bound", "upper_bound", "status", "iterations", "seconds", "equilibrium_residual")
    words = {"name": f"a{next(_NUMBERS)}", "load": load, "friction": friction} | {key: getattr(state, key) for key in keys}
    return analysis(**words | {"direction": DIRECTIONS.get(load, [0.0, 0.0, 0.0])} | more)


def report(
    folder: Path, results: list[tuple[Analysis, LimitState]], analyses: Sequence[Analysis] | None = None, **words: object
) -> str:
    stones = tower()
    contacts = find_contacts(stones)
    sizes = {"case": "tower & co", "blocks": 3, "interfaces": 3, "contact_points": 12, "weight_kN": 54.0}
    records = tuple(analyses or [record for record, _ in results])
    with pytest.MonkeyPatch.context() as patch:
        # Each drawing process costs seconds; test_pictures_are_inlined_and_kept starts a real one.
        patch.setattr(
            "churchpipe.report.html.mechanism_pictures", lambda jobs: nullcontext(lambda: "" if jobs else "nothing to draw")
        )
        write_report(
            folder / "report.html",
            summary=replace(summary(**sizes | words), analyses=records),
            stones=stones,
            contacts=contacts,
            results=results,
            case_text='name = "<tower>"',
            versions=VERSIONS,
        )
    return (folder / "report.html").read_text(encoding="utf-8")


class Page(HTMLParser):
    """The tables' cells, the visible text, the addresses and the scripts of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.addresses: list[str] = []
        self.scripts: dict[str, str] = {}
        self.text = ""
        self._open: list[str] = []
        self._script = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.addresses += [
            value or "" for key, value in attrs if key in ("src", "href", "xlink:href", "action", "data", "poster", "srcset")
        ]
        if tag in ("tr", "td", "th", "script", "style"):
            self._open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
        if tag == "script":
            self._script = given.get("type") or ""
            self.scripts[self._script] = ""

    def handle_endtag(self, tag: str) -> None:
        if self._open and self._open[-1] == tag:
            self._open.pop()

    def handle_data(self, data: str) -> None:
        data = data.replace("\u00a0", " ")  # as it is read
        inside = self._open[-1] if self._open else ""
        if inside == "script":
            self.scripts[self._script] += data
        elif inside != "style":
            self.text += data
        if inside in ("td", "th"):
            self.rows[-1][-1] += data.strip()

    @property
    def table(self) -> list[dict[str, str]]:
        """The first table of the page, that of the load factors."""
        heading, *rows = itertools.takewhile(lambda row: row[0] != "Material", self.rows)
        return [dict(zip(heading, row, strict=True)) for row in rows]
