"""The corpus: small files with one fault each, the options they are read with, and the findings that they deserve.

`python tests/corpus_files.py` writes them into tests/corpus again.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

CORPUS = Path(__file__).parent / "corpus"
Points = Sequence[tuple[float, ...]]

BRICK = [(0, 0), (250, 0), (250, 65), (0, 65)]
BLOCK = [(0, 0), (400, 0), (400, 300), (0, 300)]
HOLE = [(150, 100), (250, 100), (250, 200), (150, 200)]
BRICK_ABOVE = [(x, y + 65) for x, y in BRICK]
GROUND = [(-200, -80), (700, -80), (700, 0), (-200, 0)]
OUTLINES: dict[str, Any] = {"thickness": 0.12}
LAID: dict[str, Any] = {"thickness": 0.4, "support": "base", "bond": "running", "course": 0.25, "stone": 0.5}
FACES = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]


def polyline(corners: Points, *, layer: str = "0", closed: bool = True) -> str:
    """A POLYLINE of an R12 drawing; a third coordinate is its bulge."""
    lines = ["0", "POLYLINE", "8", layer, "66", "1", "70", str(int(closed))]
    for x, y, *bulge in corners:
        lines += ["0", "VERTEX", "8", layer, "10", f"{x}", "20", f"{y}", *(["42", f"{bulge[0]}"] if bulge else [])]
    return "\n".join([*lines, "0", "SEQEND", ""])


def face(corners: Points, layer: str = "0") -> str:
    """A 3DFACE."""
    lines = ["0", "3DFACE", "8", layer]
    for number, corner in enumerate(corners):
        lines += [item for axis in range(3) for item in (f"{10 * (axis + 1) + number}", f"{corner[axis]}")]
    return "\n".join([*lines, ""])


def dxf(*entities: str, unit: int = 4) -> str:
    """A drawing without tables; unit: $INSUNITS, millimetres."""
    header = f"0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n{unit}\n0\nENDSEC\n"
    return header + "0\nSECTION\n2\nENTITIES\n" + "".join(entities) + "0\nENDSEC\n0\nEOF\n"


def corners(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> list[tuple[float, ...]]:
    """The corners of a box."""
    return [(a, b, c) for a in x for b in y for c in z]


def obj(*bodies: tuple[str, Points, Sequence[Sequence[int]]]) -> str:
    """Objects of an OBJ; faces count the vertices of their object from 1."""
    lines, offset = [], 0
    for name, points, faces in bodies:
        lines += [f"o {name}", *("v " + " ".join(f"{value:g}" for value in point) for point in points)]
        lines += ["f " + " ".join(str(node + offset) for node in around) for around in faces]
        offset += len(points)
    return "\n".join(lines) + "\n"


PLATE = ("ground", corners((-1, 2), (-1, 2), (-0.5, 0)), FACES)
LOW = ("low", corners((0, 1), (0, 1), (0, 0.5)), FACES)
HIGH = corners((0, 1), (0, 1), (0.5, 1))
PLATE_TOP = [(-1, -1, 0), (2, -1, 0), (2, 2, 0), (-1, 2, 0)]
WARPED = [*HIGH[:7], (1, 1, 1.02)]
SOUP = [HIGH[node - 1] for around in FACES for node in around]
SOUP_FACES = [tuple(range(4 * k + 1, 4 * k + 5)) for k in range(6)]
LEANING = [(x, y + 0.2 * z, z) for x, y, z in corners((0, 4), (0, 0.4), (0, 3))]
GROUNDED = polyline(GROUND, layer="ground")
CUBE = [tuple(100 * value for value in point) for point in corners((0, 1), (0, 1), (0, 1))]
PIER = [(0, 0), (50, 0), (50, 3000), (0, 3000)]
WALL = [(0, 0), (4000, 0), (4000, 3000), (0, 3000)]
WINDOW = [(1500, 1000), (2500, 1000), (2500, 2000), (1500, 2000)]

# Name -> its text, the options it is read with, the codes of its findings.
FILES: dict[str, tuple[str, dict[str, Any], set[str]]] = {
    "sound.dxf": (dxf(GROUNDED, polyline(BRICK)), OUTLINES, {"W24", "W19"}),
    "empty.dxf": ("", OUTLINES, {"E01"}),
    "words.dxf": ("The stones are in the other file.\n", OUTLINES, {"E01"}),
    "dwg.dxf": ("AC1032\0\0\0\0", OUTLINES, {"E02"}),
    "truncated.dxf": (dxf(GROUNDED, polyline(BRICK))[:-60], OUTLINES, {"E03"}),
    "no-unit.dxf": (dxf(GROUNDED, polyline(BRICK), unit=0), OUTLINES, {"E04", "W24", "W19"}),
    "inches.dxf": (
        dxf(*(polyline([(x / 1e3, y / 1e3) for x, y in o]) for o in (BRICK,)), unit=1),
        OUTLINES,
        {"E05", "E12", "W24", "W19"},
    ),
    "doubled.dxf": (dxf(GROUNDED, polyline(BRICK), polyline(BRICK)), OUTLINES, {"E11", "W24", "W19"}),
    "doubled-repaired.dxf": (dxf(GROUNDED, polyline(BRICK), polyline(BRICK)), OUTLINES | {"repair": True}, {"W11", "W24", "W19"}),
    "no-support.dxf": (dxf(polyline(BRICK)), OUTLINES, {"E12", "W24", "W19"}),
    "support-below.dxf": (dxf(polyline(BRICK)), OUTLINES | {"support": "base"}, {"W12", "W24", "W19"}),
    "no-stones.dxf": (dxf(GROUNDED), OUTLINES, {"E17", "W24"}),
    "loose-lines.dxf": (
        dxf(GROUNDED, polyline(BRICK), polyline([(0, 500), (90, 600)], closed=False)),
        OUTLINES,
        {"W18", "W24", "W19"},
    ),
    "no-thickness.dxf": (dxf(GROUNDED, polyline(BRICK)), {}, {"E24"}),
    "far-away.dxf": (dxf(GROUNDED, polyline([*BRICK[:3], (0, 1e308)])), OUTLINES, {"E10", "W24"}),
    "crossing.dxf": (dxf(GROUNDED, polyline([BRICK[0], BRICK[2], BRICK[1], BRICK[3]])), OUTLINES, {"E25", "W24"}),
    "not-closed.dxf": (dxf(GROUNDED, polyline([*BRICK, (0, 2)], closed=False)), OUTLINES, {"W25", "W24", "W19"}),
    "joints-open.dxf": (
        dxf(GROUNDED, *(polyline([(x, y + k * 75 + 10) for x, y in BRICK]) for k in range(3))),
        OUTLINES,
        {"E26", "W24", "W19"},
    ),
    "joints-closed.dxf": (
        dxf(GROUNDED, *(polyline([(x, y + k * 75 + 10) for x, y in BRICK]) for k in range(3))),
        OUTLINES | {"joint": 0.01},
        {"W26", "W24", "W19"},
    ),
    "curved.dxf": (dxf(GROUNDED, polyline([(0, 0), (250, 0), (250, 65, 0.3), (0, 65)])), OUTLINES, {"W27", "W24", "W19"}),
    "open-body.dxf": (dxf(*(face([CUBE[n - 1] for n in around]) for around in FACES[:5])), {}, {"E10"}),
    "opening.dxf": (dxf(polyline(WALL), polyline(WINDOW, layer="OPENING")), LAID, {"W12", "W24", "W28", "W19"}),
    "void.dxf": (dxf(GROUNDED, polyline(BLOCK), polyline(HOLE, layer="OPENING")), OUTLINES, {"W29", "W24", "W19"}),
    "outline-inside.dxf": (dxf(GROUNDED, polyline(BLOCK), polyline(HOLE)), OUTLINES, {"E29", "W24", "W19"}),
    "narrow-pier.dxf": (
        dxf(polyline(WALL), polyline([(60, 0), (3000, 0), (3000, 2000), (60, 2000)], layer="OPENING")),
        LAID,
        {"E28", "W24"},
    ),
    "sound.obj": (obj(PLATE, LOW, ("high", HIGH, FACES)), {}, {"W19", "W43", "W45"}),
    "warped.obj": (obj(PLATE, LOW, ("high", WARPED, FACES)), {}, {"W10", "W19", "W43", "W45"}),
    "ground-in-pieces.obj": (
        obj(("ground", [*PLATE_TOP, *3 * [(5, 5, 0)]], [(1, 2, 3, 4), (5, 6, 7)]), LOW),
        {},
        {"E10", "W19", "W43", "W45"},
    ),
    "soup.obj": (obj(PLATE, LOW, ("high", SOUP, SOUP_FACES)), {}, {"W40", "W19", "W43", "W45"}),
    "inside-out.obj": (obj(PLATE, LOW, ("high", HIGH, [around[::-1] for around in FACES])), {}, {"W40", "W19", "W43", "W45"}),
    "hole.obj": (obj(PLATE, LOW, ("high", HIGH, FACES[:5])), {}, {"E10", "W19", "W43", "W45"}),
    "hole-repaired.obj": (obj(PLATE, LOW, ("high", HIGH, FACES[:5])), {"repair": True}, {"W41", "W19", "W43", "W45"}),
    "faces-twice.obj": (obj(PLATE, LOW, ("high", HIGH, [*FACES, *FACES])), {}, {"E10", "W19", "W43", "W45"}),
    "stone-twice.obj": (obj(PLATE, LOW, ("again", LOW[1], FACES)), {}, {"E11", "W19", "W43", "W45"}),
    "no-ground.obj": (obj(LOW, ("high", HIGH, FACES)), {}, {"E12", "W19", "W45"}),
    "two-in-one.obj": (
        obj(PLATE, ("pair", [*LOW[1], *HIGH], [*FACES, *(tuple(n + 8 for n in around) for around in FACES)])),
        {},
        {"W42", "W19", "W43", "W45"},
    ),
    "number.obj": (obj(PLATE, LOW).replace("0.5", "0,5"), {}, {"E03", "W18", "W43", "W45"}),
    "vertex-missing.obj": (obj(PLATE, LOW).replace("f 9 10 12 11", "f 9 10 12 99"), {}, {"E03", "E10", "W43", "W45"}),
    "millimetres.obj": (
        obj(*((name, [tuple(1e3 * v for v in point) for point in points], faces) for name, points, faces in (PLATE, LOW))),
        {},
        {"E04"},
    ),
    "leaning-wall.obj": (obj(("wall", LEANING, FACES)), LAID | {"thickness": None}, {"E28", "W45"}),
    "wall-to-lay.obj": (
        obj(("wall", corners((0, 4), (0, 0.4), (0, 3)), FACES)),
        LAID | {"thickness": None},
        {"W12", "W28", "W19", "W45"},
    ),
}


def main() -> None:
    """Write the files."""
    for name, (text, _, _) in FILES.items():
        (CORPUS / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
