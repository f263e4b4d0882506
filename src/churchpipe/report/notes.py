"""Paragraphs of the report that depend on how an analysis ended."""

import math

import numpy as np

from churchpipe.mechanism import moving_stones, reference_speed, stone_speed
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.names import OUTER
from churchpipe.model.results import StartRun
from churchpipe.report.table import Row, figure, small
from churchpipe.wording import counted

SHOWN = 12
# Bounds this close, absolute or as a share of the load factor, meet: what a certificate asks for.
BOUNDS_MEET = 1e-6


def status_note(stones: Assemblage, row: Row) -> str:
    """Return what an engineer must know about an unusual end of an analysis; "" for a usual one."""
    if row.of_shell:
        return _shell_note(row)
    message = f" In detail: {row.state.message}." if row.state and row.state.message else ""
    match row.status:
        case "unstable":
            return "The structure does not stand under its own weight, so there is no load factor. " + _fallen_stones(stones, row)
        case "unbounded":
            return (
                "No lateral load of this kind brings the structure down: friction and geometry hold at any load factor. "
                "Check the direction, the loaded panels and the supports; a real structure would crush or slide elsewhere first, "
                "and with a compressive strength of its materials it has a load factor."
                f"{message}"
            )
        case "not-converged" if row.record.method == "curve":
            said = f": {row.record.message}" if row.record.message else ""
            return f"The capacity curve is not proved to its end{said}. The load factor is that at which it starts."
        case "not-converged" if row.state and math.isnan(row.state.load_factor):
            return f"There is no load factor without dilatancy.{message}"
        case "not-converged":
            return f"The iteration did not reach a certified state without dilatancy. {_unfinished(row)}{message}"
        case "failed":
            return f"No certified answer was found, and an uncertified number would be worse than none. {_missing_proof(row)}"
    told = row.record.message if row.record.method == "curve" else ""
    return f"{told[0].upper()}{told[1:]}." if told else ""


def convergence_note(row: Row) -> str:
    """Return one sentence a fact about a non-associative result: its gap, interval and fixed points."""
    state = row.state
    if state is None:
        return ""
    parts = []
    if row.relative_gap is not None:
        parts.append(f"Gap g / load factor: {small(row.relative_gap)}.")
    if np.isfinite(state.interval).all():
        low, high = state.interval
        parts.append(f"Load factors compatible with this mechanism: {figure(low, 4)} to {figure(high, 4)}.")
    if len(state.starts) > 1:
        parts += [_start_note(run) for run in state.starts]
        lowest = min(state.fixed_points, default=math.nan)
        parts += [f"The lowest value found is {figure(lowest, 4)}."] if len(state.fixed_points) > 1 else []
    elif len(state.fixed_points) == 1:
        parts.append(f"Every start led to {figure(state.fixed_points[0], 4)}.")
    elif state.fixed_points:
        values = ", ".join(figure(v, 4) for v in sorted(state.fixed_points))
        parts.append(f"The starts led to {values}; the lowest is the safe one.")
    if math.isfinite(state.friction_violation):
        parts.append(f"Friction violation left: {small(state.friction_violation)}.")
    return " ".join(parts)


def _missing_proof(row: Row) -> str:
    """Return what a failed analysis lacks, from its own figures: bounds at all, bounds that meet, or forces that balance."""
    lower, upper = row.value("lower_bound"), row.value("upper_bound")
    message = row.state.message if row.state else row.record.message
    says = f" The solver says: {message}." if message else ""
    if lower is None or upper is None or not (math.isfinite(lower) and math.isfinite(upper)):
        return f"The solver stopped before it had bounds.{says}"
    found = f"the lower bound is {figure(lower, 8)}, the upper {figure(upper, 8)}"
    if abs(upper - lower) > BOUNDS_MEET * max(1.0, abs(upper)):
        return f"The bounds did not meet: {found}.{says}"
    residual, violation = (small(row.value(key)) for key in ("equilibrium_residual", "cone_violation"))
    return (
        f"The bounds meet ({found}), but the forces do not prove the lower one: largest residual of equilibrium {residual}, "
        f"worst force outside its cone {violation}, over the total weight.{says}"
    )


def _start_note(run: StartRun) -> str:
    """Return where one of several starts led."""
    start = "start that holds loose stones fast" if run.start == "held" else f"{run.start} start"
    words = f"The {start} {'led to' if run.converged else 'did not settle; it last was at'} {figure(run.load_factor, 4)}"
    facts: list[str] = []
    if math.isfinite(run.gap) and run.load_factor:
        facts.append(f"forces and motion miss each other by {small(run.gap / abs(run.load_factor))} of it")
    low, high = run.interval
    facts += [f"interval {figure(low, 4)} to {figure(high, 4)}"] if math.isfinite(low) and math.isfinite(high) else []
    return f"{words} ({', '.join(facts)})." if facts else f"{words}."


def _shell_note(row: Row) -> str:
    message = row.record.message
    match row.status:
        case "unstable":
            return f"The shell does not stand under its own weight, so there is no load factor: {message}."
        case "unbounded":
            return "No lateral load of this kind brings the shell down."
        case "not-converged":
            return f"The capacity curve ends before a proved plateau; its load factor is the largest one reached. {message}"
        case "failed":
            return f"No certified answer was found. {message}"
    note = OUTER.get(row.record.planes or "", "")
    return f"{note[0].upper()}{note[1:]}." if note else ""


def _fallen_stones(stones: Assemblage, row: Row) -> str:
    if row.state is None:
        return ""
    speed = stone_speed(stones, np.nan_to_num(row.state.velocities))
    # Slow stones are carried along or are rounding: name those that fall, fastest first.
    falling = np.flatnonzero(moving_stones(speed) & (speed > 0.05 * reference_speed(speed)))
    if not len(falling):
        return ""
    order = falling[np.argsort(-speed[falling], kind="stable")]
    names = ", ".join(stones.block_id[order[:SHOWN]])
    more = f" and {len(order) - SHOWN} more" if len(order) > SHOWN else ""
    return f"{counted(len(order), 'stone moves', 'stones move')}, fastest first: {names}{more}. The picture shows how."


def _unfinished(row: Row) -> str:
    state = row.state
    if state is None or not state.history:
        return "Treat its load factor as an estimate."
    last = [step.load_factor for step in state.history[-10:]]
    steps = f"{len(last)} steps" if len(last) > 1 else "step"
    return (
        f"Over its last {steps} the load factor ranged from {figure(min(last), 4)} to {figure(max(last), 4)}. "
        "Treat it as an estimate; the associative load factor remains an upper limit."
    )
