"""The displacement-based check of the Italian code: Circolare of 21.1.2019 n. 7, C8.7.1.2.1, read in a transcription."""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from churchpipe.code_check import CONFIDENCE_FACTOR, Site, activation, along, verified
from churchpipe.errors import InputError
from churchpipe.loading.wrenches import pushed_masses
from churchpipe.mechanism import moving_stones, stone_speed
from churchpipe.model.arguments import check_kind
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve, vanishing
from churchpipe.model.checks import DisplacementCheck, LimitStateCheck, SafetyCheck
from churchpipe.model.digests import of_load
from churchpipe.model.loads import LoadCase
from churchpipe.model.lost_seat import LostSeat
from churchpipe.model.placed_loads import PlacedLoads
from churchpipe.oscillator import FOLLOW, LIMIT_STATES, LimitName, LimitStateCapacity, Oscillator, capacity, oscillator
from churchpipe.rigid_blocks.equilibrium import lateral_weight
from churchpipe.spectrum import Demand, demand_curve, spectral_displacement
from churchpipe.wording import counted, three_figures


def displacement_check(
    curve: BlockCapacityCurve,
    stones: Assemblage,
    load: LoadCase,
    site: Site | None,
    loads: PlacedLoads | None = None,
    *,
    crushing: bool = False,
    seat: LostSeat | None = None,
) -> DisplacementCheck:
    """Return the displacement-based check of a capacity curve; its message says why there is none, if so.

    It leads with e* = 1 and has what holds with e* of the stones besides, as the check with q does. That check is made of the
    same mechanism, for comparison. Of a curve whose last steps are not proved it is made with the curve ended before them and as
    it was found, and the one that withstands less counts; one that stopped because no motion was found that fits its forces is
    ended at its last proved step. load: as it is without what the stones carry. loads: that, whose masses
    are bodies of their own, as Q_k are in the circular. crushing: whether the masonry crushes on the curve, so that the
    confidence factor is that of the knowledge level. seat: where the first joist loses its seat (`large_displacements.seats`).

    Raises
    ------
    InputError: arguments of the wrong kind, other stones or another load than those of the curve.
    """
    given = (curve, BlockCapacityCurve), (stones, Assemblage), (load, LoadCase), (crushing, bool)
    for value, kind in (
        *given,
        *((site, Site),) * (site is not None),
        *((loads, PlacedLoads),) * (loads is not None),
        *((seat, LostSeat),) * (seat is not None),
    ):
        check_kind("displacement_check", value, kind)
    curve.check_of("displacement_check: curve", stones, "a curve")
    if not of_load(curve.given, load, pushed_alike=True):
        expected = "the load case that its block_pushover was called with"
        raise InputError("displacement_check: load", "the curve is of another load", found=load.name, expected=expected)
    try:
        bodies = _bodies(curve, stones, load, loads)
        curves, start = _mechanism(curve, bodies, site.confidence(crushing) if site else CONFIDENCE_FACTOR, seat)
    except InputError as error:
        return DisplacementCheck(message=str(error))
    demand = site.demand if site else None
    found = min(curves, key=lambda one: capacity(one.lumped, demand).ground) if demand else curves[0]
    careful = found.lumped
    unproved = _unproved(curve, ended=found is curves[0], compared=demand is not None and len(curves) > 1)
    check = DisplacementCheck(
        alpha0=start.alpha0,
        moving_weight=start.moving_weight,
        confidence_factor=start.confidence_factor,
        mass_fraction=start.mass_fraction,
        participating_mass=start.participating_mass,
        a0=start.a0_lumped,
        d0=careful.ultimate,
        d0_stones=found.ultimate,
        displacement=tuple(careful.displacement.tolist()),
        acceleration=tuple(careful.acceleration.tolist()),
        idealised_d0=careful.idealised.ultimate,
        lost_seat="" if seat is None else seat.said(careful.seat),
        unproved=unproved,
    )
    if site is None:
        return replace(check, missing="what the earthquake asks: [check] with a_g_m_s2 and [check.spectrum]")
    ground, force = site.ground_acceleration, verified(start, site)
    if demand is None:
        key = "[check.spectrum]" if site.spectrum is None else "check.floor.first_period_s, the first period of the building"
        return replace(check, missing=f"the spectrum: {key}", force_based=force)
    limits: dict[LimitName, LimitStateCapacity] = {name: capacity(careful, demand, name) for name in LIMIT_STATES}
    furthest = 2.5 * max(limit.displacement for limit in limits.values())
    of_stones = {name: capacity(found, demand, name).ground for name in LIMIT_STATES}
    return replace(
        check,
        a_g=ground,
        limit_states={name: _limit_state(name, limit, demand, ground) for name, limit in limits.items()},
        a_g_slv=limits["SLV"].ground,
        a_g_slc=limits["SLC"].ground,
        zeta_e=limits["SLV"].ground / ground,
        satisfied=limits["SLV"].ground >= ground,
        a_g_slv_stones=of_stones["SLV"],
        a_g_slc_stones=of_stones["SLC"],
        zeta_e_stones=of_stones["SLV"] / ground,
        satisfied_stones=of_stones["SLV"] >= ground,
        a_g_slv_idealised=capacity(careful.idealised, demand).ground,
        force_based=force,
        governs=_governs(limits["SLV"], force, cut=bool(unproved) and found is curves[0]),
        collapse_first=_collapse_first(limits["SLV"], limits["SLC"]),
        spectrum=site.parameters,
        demand={name: demand_curve(demand, ground, rule.damping, furthest) for name, rule in LIMIT_STATES.items()},
    )


@dataclass(frozen=True, slots=True)
class _Bodies:
    """What moves along a curve, stones and the masses on them. stone (n,): the stone of each, itself or which bears it; weight
    (n,) N; place (ns, n) m along the load at each step; moving (n,): whether it is part of the mechanism at the start; pushed
    (n,): N, of these alone, since what moves later must not make the oscillator go further."""

    stone: IntArray
    weight: FloatArray
    pushed: FloatArray
    place: FloatArray
    moving: BoolArray


def _bodies(curve: BlockCapacityCurve, stones: Assemblage, load: LoadCase, loads: PlacedLoads | None) -> _Bodies:
    if len(curve.displacement) < 2:
        found, expected = f"{counted(len(curve.displacement), 'step')} of the curve", "two or more"
        raise InputError("check", "no mechanism", found=found, expected=expected, remedy=FOLLOW)
    first = np.concatenate([np.diff(part[:2], axis=0)[0] for part in (curve.position, curve.rotation)], axis=1)
    moving = moving_stones(stone_speed(stones, first)) & ~stones.fixed
    stone, weight, pushed = np.arange(stones.count), stones.weight, lateral_weight(stones, load)
    place = along(load.direction, curve.position)
    if loads is not None and loads.mass.any():
        more, masses = pushed_masses(load, stones, loads)
        arm = loads.point - stones.centroid[loads.stone]
        turned = [Rotation.from_rotvec(rotation[loads.stone]).apply(arm) for rotation in curve.rotation]
        place = np.concatenate([place, place[:, loads.stone] + along(load.direction, np.array(turned))], axis=1)
        stone, weight = np.concatenate([stone, loads.stone]), np.concatenate([weight, loads.mass])
        pushed = np.concatenate([pushed + more, masses])
    return _Bodies(stone, weight, np.where(moving[stone], pushed, 0.0), place, moving[stone])


def _mechanism(
    curve: BlockCapacityCurve, bodies: _Bodies, confidence: float, seat: LostSeat | None
) -> tuple[list[Oscillator], SafetyCheck]:
    """Return the oscillator of a curve, before it that of its proved steps if some are not, and what starts the motion."""
    weight, pushed, moving = bodies.weight, bodies.pushed, bodies.moving
    motion = np.where(moving, bodies.place[1] - bodies.place[0], 0.0)
    displacement, d0 = _mean_displacement(curve, bodies)

    def until(count: int, end: float) -> Oscillator:
        travelled, factors = displacement[:count], curve.load_factor[:count]
        made = oscillator(travelled, factors, end, weight, motion, pushed=pushed, confidence_factor=confidence)
        at = math.inf if seat is None else float(np.interp(seat.step, np.arange(len(displacement)), displacement))
        return replace(made, seat=at * made.ultimate / end)

    stopped = curve.status == "not-converged"
    found = [] if stopped else [until(len(displacement), d0)]
    if stopped or not curve.proved:
        proved = curve.proved_steps
        if proved < 2:
            raise InputError("check", "no proved step of the curve beyond the first", found=proved, expected="two or more")
        found = [until(proved, float(displacement[proved - 1])), *found]
    return found, activation(curve.initial, weight[moving], pushed[moving], motion[moving], confidence)


def _unproved(curve: BlockCapacityCurve, *, ended: bool, compared: bool) -> str:
    """Return the sentences on steps that are not proved, "" where all are.

    ended: whether the check ends the curve before them; compared: whether because it withstands less so.
    """
    end = ""
    if curve.status == "not-converged":
        last = three_figures(1e3 * float(curve.displacement[-1]))
        end = f"The curve stops at {last} mm, where no motion was found that fits its forces. "
    if curve.proved:
        return f"{end}The check takes it as ended there." if end else ""
    proved, count = curve.proved_steps, len(curve.misfit)
    worst, place = float(curve.misfit[proved:].max()), three_figures(1e3 * float(curve.displacement[proved - 1]))
    missed = f": motions miss their forces by up to {100 * worst:.2g} %" if worst > 0.01 else ""
    if curve.jumps.any():
        missed = ": the structure jumps on the way, or stones of it hang, and these load factors are no equilibria"
    taken = "as ended before them" if ended else "as it was found"
    taken += ", which withstands less" if compared else ""
    return (
        f"{end}From step {proved + 1} of {count} on, beyond {place} mm, not every step of the curve is proved{missed}. "
        f"The check takes the curve {taken}."
    )


def _mean_displacement(curve: BlockCapacityCurve, bodies: _Bodies) -> tuple[FloatArray, float]:
    """Return the mean displacement (ns,) m of what is pushed of the mechanism, and stands, and its d0.

    The point that the curve is drawn against does not matter.
    """
    gone = [0.0]
    for step, way in enumerate(np.diff(bodies.place, axis=0)):
        fallen = [part.stones for part in curve.fallen if part.step <= step]
        out = np.isin(bodies.stone, np.concatenate([*fallen, np.zeros(0, dtype=np.int64)]))
        weight = np.where(out, 0.0, bodies.pushed)
        total = float(weight.sum())
        gone.append(gone[-1] + (float(weight @ way) / total if total > 0 else 0.0))
    displacement = np.array(gone)
    if curve.status == "vanished":
        return displacement, vanishing(displacement, curve.load_factor)
    return displacement, gone[-1] if curve.status == "collapsed" else math.nan


def _limit_state(name: LimitName, found: LimitStateCapacity, demand: Demand, ground: float) -> LimitStateCheck:
    damping = LIMIT_STATES[name].damping
    return LimitStateCheck(
        displacement=found.displacement,
        acceleration=found.acceleration,
        period=found.period,
        damping_percent=damping,
        demand=spectral_displacement(demand, found.period, ground, damping),
        a_g=found.ground,
        governed=found.governed,
    )


def _governs(found: LimitStateCapacity, force: SafetyCheck, *, cut: bool) -> str:
    """Return the sentence on which of the two checks governs, and why; cut: whether the check ends the curve where its proofs do,
    so that little travel is no property of the mechanism."""
    q, other, reach = force.q, force.a_g_slv, f"The mechanism may go {three_figures(found.displacement * 1e3)} mm"
    if cut and found.ground < other:
        why = (
            f"{reach} as far as the curve is proved, and how much further it goes is not known: the smaller value is for want of "
            "proof. Shorter steps may prove more."
        )
    elif found.governed == "onset":
        # With q = 1 both checks ask when the motion starts.
        promise = ", and q promises a reserve that it has not" if found.ground < other * (1 - 1e-6) else ""
        why = f"{reach}, so little that it falls as soon as it starts{promise}."
    elif found.ground < other:
        why = f"{reach}, less than q takes for granted, so the check with q alone is not safe here."
    else:
        why = f"{reach}, more than q gives it credit for, so the check with q alone is more severe than need be."
    values = f"a_g,SLV is {found.ground:.3f} m/s2 by displacements and {other:.3f} m/s2 with q = {q:g}"
    return f"The displacement-based check governs, as the rule of the circular: {values}. {why}"


def _collapse_first(safety: LimitStateCapacity, collapse: LimitStateCapacity) -> str:
    """Return what makes the capacity of SLC smaller than that of SLV, "" where it is not: by the circular it comes after SLV."""
    if not collapse.ground < safety.ground:
        return ""
    return (
        f"Collapse (SLC) comes before life safety (SLV) here: a_g,SLC is {collapse.ground:.3f} m/s2 and a_g,SLV "
        f"{safety.ground:.3f} m/s2. Between the displacements of the two, {three_figures(1e3 * safety.displacement)} and "
        f"{three_figures(1e3 * collapse.displacement)} mm, the acceleration falls from {three_figures(safety.acceleration)} to "
        f"{three_figures(collapse.acceleration)} m/s2, as where a tie breaks. So the period grows from {safety.period:.2f} to "
        f"{collapse.period:.2f} s, and the earthquake asks for more than the mechanism has gained. Compare a_g,SLC with the "
        "ground acceleration of SLC as well, which the check of SLV does not look at."
    )
