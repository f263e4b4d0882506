"""How far apart the faces are that meet or nearly meet: why the tolerances of joints are what they are."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.contacts import TOUCHING, Contacts

BINS = 24
# Angles smaller than this, rad, are counted with it.
PARALLEL = 1e-5


@dataclass(frozen=True, slots=True)
class Histogram:
    """Counts in bins of equal ratio: edges (n + 1,), m or rad; joints (n,) and near_misses (n,) of them. What is smaller than the
    first edge is in the first bin."""

    edges: FloatArray
    joints: IntArray
    near_misses: IntArray


def gap_histogram(contacts: Contacts) -> Histogram:
    """Return how many faces are how far apart, m: joints where they are widest apart or deepest in each other."""
    return _histogram(np.abs(contacts.gap).max(axis=1, initial=0.0), np.abs(contacts.near_misses.gap), TOUCHING)


def angle_histogram(contacts: Contacts) -> Histogram:
    """Return how many faces are at which angle, rad."""
    return _histogram(contacts.angle, contacts.near_misses.angle, PARALLEL)


def _histogram(joints: FloatArray, near: FloatArray, least: float) -> Histogram:
    largest = max(float(joints.max(initial=0.0)), float(near.max(initial=0.0)), 10.0 * least)
    edges = np.geomspace(least, 1.001 * largest, BINS + 1)
    counts = [np.histogram(np.maximum(values, least), edges)[0].astype(np.int64) for values in (joints, near)]
    return Histogram(edges, counts[0], counts[1])


def histogram_lines(contacts: Contacts) -> list[str]:
    """Return the gaps and angles of joints and near misses as lines of text, one a decade."""
    out: list[str] = []
    tables = (
        ("gap, mm", 1e3, np.abs(contacts.gap).max(axis=1, initial=0.0), np.abs(contacts.near_misses.gap), TOUCHING),
        ("angle, degrees", float(np.degrees(1.0)), contacts.angle, contacts.near_misses.angle, PARALLEL),
    )
    for words, unit, joints, near, least in tables:
        out.append(f"{words:>16}   joints   near misses")
        edges = [0.0, *(least * 10.0 ** np.arange(0, 8)).tolist()]
        for low, high in pairwise(edges):
            counts = [int(((values >= low) & (values < high)).sum()) for values in (joints, near)]
            if any(counts):
                out.append(f"{'below' if not low else 'from':>7} {unit * (low or high):8.3g}   {counts[0]:6d}   {counts[1]:11d}")
    return out
