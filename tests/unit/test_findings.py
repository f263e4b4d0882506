"""Findings of a file: one line a kind, with count, first places and the remedy."""

import json
import re
from pathlib import Path

from churchpipe.findings import CODES, REMEDIES, Finding, Findings, Place


def test_findings_of_one_kind_are_one_line_with_count_first_places_and_remedy() -> None:
    items = [
        Place("MESH", f"A{i}", position=(i, 0.0, 0.0)).finding(
            "E10", "face 3 is {} out of plane", expected="planar", remedy="Use triangles.", lengths=(0.5 + i,)
        )
        for i in range(225)
    ]
    items.append(Finding("E10", "no body in the block", "a MESH"))
    lines = str(Findings("vault.dxf", tuple(f.in_metres(0.001) for f in items))).splitlines()
    assert lines == [
        "dxf/E10 vault.dxf: 225 times: MESH #A0 at (0.00, 0.00, 0.00) m: face 3 is 0.0005 m out of plane: expected planar. "
        "Use triangles. Also: MESH #A1 at (0.001, 0.00, 0.00) m; MESH #A2 at (0.002, 0.00, 0.00) m; "
        "MESH #A3 at (0.003, 0.00, 0.00) m; and 221 more.",
        "dxf/E10 vault.dxf: no body in the block: expected a MESH. Draw it again as one closed body; "
        "churchpipe check FILE -o DIR marks the place.",
    ]


def test_records_hold_every_place_and_are_json() -> None:
    found = Findings("a.obj", tuple(Finding("E11", f"stone {i} drawn twice", position=(1.0, 2.0, i)) for i in range(9)), "obj")
    assert str(found).startswith("obj/E11 a.obj: 9 times: at (1.00, 2.00, 0.00)")
    (record,) = json.loads(json.dumps(found.records()))
    assert (record["code"], record["severity"], record["count"]) == ("E11", "error", 9)
    assert [place["position"][2] for place in record["places"]] == list(range(9))


def test_every_finding_ends_in_what_to_do_next() -> None:
    assert list(REMEDIES) == list(CODES)
    for code, remedy in REMEDIES.items():
        assert str(Findings("a.dxf", (Finding(code, "something"),))).endswith(f"something. {remedy}")
        assert remedy.endswith(".")
    assert Finding("E24", "outlines", remedy="Draw them deeper.").remedy == "Draw them deeper."


def test_every_code_and_its_remedy_are_in_the_docs() -> None:
    text = (Path(__file__).parents[2] / "docs" / "drawings.md").read_text(encoding="utf-8")
    rows = [row.strip("| ").split(" | ") for row in text.splitlines() if re.match(r"\| [EW]\d\d ", row)]
    assert {code: remedy for code, _, remedy in rows} == REMEDIES
