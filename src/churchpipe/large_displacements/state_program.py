"""The program of a state: the balance of its stones where they are now, with the gaps of their contacts."""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.pressed import pressed_joints
from churchpipe.conic.solve import solver_for
from churchpipe.conic.wrenches import Balance
from churchpipe.large_displacements.moving_model import MovingModel
from churchpipe.large_displacements.path_state import PathState, last_motion, standing
from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.step import StepProgram
from churchpipe.large_displacements.travelling import TravellingLoads
from churchpipe.large_displacements.twisted import friction_shift
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import contact_wrenches
from churchpipe.rigid_blocks.iterations import approached_forces
from churchpipe.rigid_blocks.pressed import with_further
from churchpipe.rigid_blocks.settings import SchemeSettings

# Gaps below this share of the size of the model are those of rounding.
ROUNDING = 1e-12


def state_program(model: MovingModel, state: PathState) -> tuple[Assemblage, StepProgram, IntArray, FloatArray]:
    """Return the stones, the program of a state, the free stones, and the gaps of its points; slack of its ties."""
    stones = standing(model, state)
    contacts, gap = state.joints.at(state.poses)
    # What rounding opens is no gap: where many motions are possible, it would tell which of them is found.
    gap = np.where(np.abs(gap) < max(ROUNDING * model.length, model.demands.closed * model.step), 0.0, gap)
    free = np.flatnonzero(~stones.fixed)
    rotation = state.poses.rotation
    dead = model.dead.rows(rotation, free, model.force, model.length)
    friction = model.friction.of(contacts.blocks, stones.count)[contacts.interface_of_point]
    bound, softness = np.full(len(gap), np.inf), np.zeros(len(gap))
    at = contacts.point + state.joints.lever if model.contact_model == "torsion" else None
    if isinstance(model.driven, TravellingLoads):
        balance: Balance = contact_wrenches(stones, contacts, free, model.length, at)
        live = model.driven.rows(rotation, free, model.force, model.length)
        if model.ties.name:
            balance = balance.joined(model.ties.wrenches(state.poses, free, model.length))
            broken = model.ties.broken(state.rest, state.fallen)
            bound = np.append(bound, np.where(broken, 0.0, model.ties.strength / model.force))
            gap = np.append(gap, np.where(broken, 0.0, state.rest - model.ties.lengths(state.poses)))
            softness = np.append(softness, np.where(broken, 0.0, model.force / model.ties.stiffness))
            friction = np.append(friction, np.zeros(len(broken)))
    else:
        twist = model.driven.twist(state.poses)
        twist[:, 3:] *= model.length
        wrenches = contact_wrenches(stones, contacts, np.append(free, model.driven.stones), model.length, at)
        # Of the balance of the support only that along its movement is left.
        along = sp.block_diag([sp.identity(6 * len(free)), twist.reshape(1, -1)], format="csr")
        balance = sp.csc_matrix(along @ wrenches.tocsc())
        dead, live = np.append(dead, 0.0), np.append(np.zeros_like(dead), 1.0)
    strength, points, rows = Strength(friction, np.zeros_like(bound), bound), len(bound), len(dead)
    if model.strength is not None:
        joints = state.joints
        capacity = model.strength.of(joints.blocks, stones.count) * joints.rectangle / model.force
        crush = np.isfinite(capacity)
        bear = np.flatnonzero(crush[joints.interface])
        number = (np.cumsum(crush) - 1)[joints.interface[bear]]
        if len(bear):
            pressed = pressed_joints(bear, number, joints.place[bear], capacity[crush], 1.0 / int(crush.sum()), points)
            balance, strength = pressed.below(balance), with_further(strength, pressed)
            dead, live = np.append(dead, pressed.constant), np.append(live, np.zeros_like(pressed.constant))
            gap, softness = (np.append(each, np.zeros(len(strength.bound) - points)) for each in (gap, softness))
    pushed = isinstance(model.driven, TravellingLoads)
    least = max(PATH.least, PATH.small * state.first if pushed else 0.0)
    return stones, StepProgram(balance, dead, live, strength, np.zeros_like(gap), points, rows, softness, least), free, gap


def velocities_of(model: MovingModel, state: PathState, free: IntArray, y: FloatArray) -> FloatArray:
    """Return the velocities (nb, 6) of all stones from the multipliers (m,) of a program with these free ones."""
    out = np.zeros((model.stones.count, 6))
    out[free] = y[: 6 * len(free)].reshape(-1, 6)
    out[:, 3:] /= model.length
    if not isinstance(model.driven, TravellingLoads):
        out[model.driven.stones] = y[6 * len(free)] * model.driven.twist(state.poses)
    return out


def last_velocities(model: MovingModel, state: PathState, free: IntArray, program: StepProgram) -> FloatArray:
    """Return the multipliers of the last motion where the stones are now, for a large model with the rows of its stones alone."""
    stones_alone = isinstance(model.driven, TravellingLoads) and len(program.dead) == 6 * len(free)
    if state.before is None or not model.large or not stones_alone:
        return np.zeros(0)
    velocity = last_motion(state)[free]
    y = np.concatenate([velocity[:, :3], model.length * velocity[:, 3:]], axis=1).ravel()
    power = float(program.live @ y)
    return y / power if power > 0 else np.zeros(0)


def as_in(model: MovingModel, state: PathState, velocities: FloatArray) -> PathState:
    """Return a state whose points slide as by the velocities (nb, 6) of an analysis without dilatancy; they have its forces."""
    if model.contact_model == "torsion":
        state = replace(state, joints=replace(state.joints, lever=pressure_levers(state, state.joints.pressing)))
    _, program, free, _ = state_program(model, state)
    y, moving = np.zeros_like(program.dead), velocities[free]
    y[: 6 * len(free)] = np.concatenate([moving[:, :3], model.length * moving[:, 3:]], axis=1).ravel()
    power = float(program.live @ y)
    if not power > 0:
        return state
    return replace(state, joints=replace(state.joints, sliding=program.slip(y / power)[: len(state.joints.pressing)]))


def pressure_levers(state: PathState, normal: FloatArray) -> FloatArray:
    """Return where friction acts beside the points (nc, 3) m under normal forces (nc,) of any unit."""
    contacts, _ = state.joints.at(state.poses)
    tangents = contacts.frame[contacts.interface_of_point, 1:]
    shift = friction_shift(contacts, normal, np.einsum("kac,kc->ka", tangents, state.joints.lever))
    return np.einsum("kac,ka->kc", tangents, shift)


def approached(model: MovingModel, state: PathState) -> PathState:
    """Return a state whose points press as in forces that hardly exceed friction, sought from those that it has."""
    program, points = step_program(model, state), len(state.joints.pressing)
    forces = np.zeros(len(program.closing))
    forces[:points] = state.joints.pressing
    solve = solver_for(program.balance, model.solver)
    forces, _ = approached_forces(program, program.strength, forces, solve, SchemeSettings(), rough=True)
    return replace(state, joints=replace(state.joints, pressing=forces[:points]))


def step_program(model: MovingModel, state: PathState) -> StepProgram:
    """Return the program of a step from a state, of the length of the last one."""
    _, program, _, gap = state_program(model, state)
    return program.within(gap, program.softness, state.length)
