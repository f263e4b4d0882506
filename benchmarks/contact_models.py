"""Both contact models, and joints that crush, on the tilting tests and a church: load factors and processor times.

    PYTHONPATH=tests python benchmarks/contact_models.py S5 S22 church --flow associative non-associative

Prints the rows of the tables in docs/contact_models.md. The church takes hours without dilatancy;
--joints and --loads choose rows.
"""

import argparse
from pathlib import Path
from time import process_time
from typing import Any

import churchpipe as cp
from models import TILTING_LOADS, box_building, tilting_test

CASES = Path(__file__).parents[1] / "pipeline" / "cases"
VARIANTS: dict[str, dict[str, Any]] = {
    "corners": {},
    "torsion": {"contact_model": "torsion"},
    "5 MPa": {"compressive_strength": 5e6},
    "1 MPa": {"compressive_strength": 1e6},
}


def model(name: str) -> tuple[cp.Assemblage, cp.Contacts, dict[str, cp.LoadCase], float]:
    """Return stones, contacts, loads by name, and friction."""
    if name != "church":
        return *tilting_test(name), {"": TILTING_LOADS[name]}, 0.7
    stones = cp.derive_blocks(cp.read_case(CASES / "church.toml").building())
    return stones, cp.find_contacts(stones), {"+x": cp.LoadCase((1, 0, 0)), "-y": cp.LoadCase((0, -1, 0))}, 0.6


def main() -> None:
    """Print one row an analysis."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", nargs="+")
    parser.add_argument("--flow", nargs="+", default=["associative"])
    parser.add_argument("--joints", nargs="+", default=list(VARIANTS), choices=VARIANTS)
    parser.add_argument("--loads", nargs="+", help="of the church: +x, -y; left out: both")
    asked = parser.parse_args()
    # Kernels are compiled or loaded before the clock starts.
    warm = box_building("warm")
    for options in VARIANTS.values():
        cp.limit_analysis(*warm, cp.LoadCase((1, 0, 0)), 0.6, flow="non-associative", **options)
    print("| model | flow | joints | load factor | interval | processor s | status |\n|" + "---|" * 7)
    for name in asked.models:
        stones, contacts, loads, friction = model(name)
        for load_name in asked.loads or loads if name == "church" else loads:
            for flow in asked.flow:
                for words in asked.joints:
                    figures = row(stones, contacts, loads[load_name], friction, flow, VARIANTS[words])
                    print(f"| {name} {load_name} | {flow} | {words} | {figures} |", flush=True)


def row(
    stones: cp.Assemblage, contacts: cp.Contacts, load: cp.LoadCase, friction: float, flow: Any, options: dict[str, Any]
) -> str:
    """Return the figures of one analysis."""
    begin = process_time()
    state = cp.limit_analysis(stones, contacts, load, friction, flow=flow, **options)
    interval = "" if flow == "associative" else f"{state.interval[0]:.4f} .. {state.interval[1]:.4f}"
    return f"{state.load_factor:.5f} | {interval} | {process_time() - begin:.1f} | {state.status}"


if __name__ == "__main__":
    main()
