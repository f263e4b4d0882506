"""Results side by side."""

from collections.abc import Mapping, Sequence
from typing import Any

from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts

# What a load factor rests on; anything else is bad news that the command line reports with its exit code.
GOOD = frozenset({"optimal", "converged", "unbounded"})


def figures(stones: Assemblage, contacts: Contacts) -> dict[str, Any]:
    """Return the size of an assemblage in the words of summary.json; ground is no block and weighs nothing."""
    return {
        "blocks": int((~stones.fixed).sum()),
        "interfaces": len(contacts.blocks),
        "contact_points": len(contacts.point),
        "weight_kN": round(float(stones.weight.sum()) / 1e3, 6),
    }


def summary(name: str, sizes: Mapping[str, dict[str, Any]], analyses: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return summary.json: the size of the (first) geometry and all analyses; of a geometry sweep, all sizes by name."""
    first = next(iter(sizes.values()))
    several = {"geometries": dict(sizes)} if len(sizes) > 1 else {}
    return {"case": name, **first, **several, "analyses": list(analyses)}


def bad_news(analyses: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return the analyses without a load factor to rest on: unstable, not converged, failed."""
    return [analysis for analysis in analyses if analysis.get("status") not in GOOD]
