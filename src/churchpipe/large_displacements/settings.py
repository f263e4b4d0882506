"""Constants of capacity curves and of supports that move, checked."""

from dataclasses import dataclass, fields

import numpy as np

from churchpipe.model.arguments import check_constants
from churchpipe.model.stone_path import CREDIBLE, FITS


@dataclass(frozen=True, slots=True)
class Demands:
    """What the programs of a step must reach; a misfit is what a motion lacks of one without dilatancy, over the load factor.

    fitting: a motion that misses its forces by no more fits them; begins: the same of the first step, which decides on which of
    several ways a path goes. enough: the same of a motion that goes on from the last one, on which no more pairs are spent that
    hardly gain, and which is kept, in a small model, rather than looked for by other ways; resting: so many pairs in a row that
    hardly gain end every search. far: pairs that miss by more than so many times `enough` end where they will not come to it at
    the rate of the last. astray: where the forces of the last step miss a motion by more, they do not lead on, and no more
    programs are spent on them. shorter: a motion may go so many times less far than the length that its programs charge the gaps
    for. across: where forces would need more work than this share of the load's across the gaps that such a motion leaves open,
    the step is sought again with the length that it goes. further: one that does not fit and may go so many times further is
    sought anew with that length. faster: very few stones, whose motion does not come to fit, fall when they are so many times
    faster than usual, see `PathSettings.few` and `falling.usual_speed`. onward: whether pairs begin near the pair before them
    where no motion is known. duality_gap: error of the associative programs, whose velocities may move the stones. closed: gaps
    narrower than this share of the step are closed: programs that are solved roughly open joints by as much while they bear.
    """

    fitting: float
    begins: float
    enough: float
    resting: float
    far: float
    astray: float
    shorter: float
    across: float
    further: float
    faster: float
    onward: bool
    duality_gap: float
    closed: float


@dataclass(frozen=True, slots=True)
class PathSettings:
    """Lengths of steps, rounds of programs and errors within which a step is proved. Shares are relative unless a unit is given.

    Length of a step:
        step, reach: largest displacement of a step, and how far apart points may be that can still come to bear, over the median
        thickness of the stones that move. turn: largest rotation, rad. right: a length that is right within this factor is kept;
        shortest: a step below this share of the largest is tiny, and stones that run ahead in it fall, though the structure
        jumps; stalled: so many tiny steps in a row that are not proved end the path. least_charge: a step may charge its gaps as
        if it were this much shorter than the last one, however short it is then: where a few stones run ahead of all others,
        every sliding joint would else count as open. snapping: nor as if it were shorter than this share of the largest, m per
        unit of work: where the load does no work, as in a snap, every step would else be a tenth of the one before, until its
        program has no solution in the numbers of a computer. drop: where the load factor falls by more than this share of the
        first one within a step, the place is sought to `located` of it; bend: or, unless the model is large, by this share more
        than it would along the last step, as when a joint stops sliding or another hinge opens. nearer: where a step of a large
        model is not proved, it is sought from nearer places, the last of them within this share of the step before. lengths:
        times that pairs of programs are begun, each with the length of step of the last motion. open: a joint that is wider than
        this share of the step holds nothing, in a large model as the step begins, in a smaller one where no motion fits. drift: a
        gap narrower than this share of the step is one that steps make themselves; forces across wider ones are told as a jump,
        and hold no stone of a large model, and very few of a smaller one, where no motion fits.

    Programs of a step:
        first_programs, programs: as drawn, where the sliding is unknown, and later. pairs: of programs that make forces and
        motion fit, at most. rounds: friction follows the pressure for so many rounds at most, or until it acts elsewhere by no
        more than `at_rest`, a share of a stone. whole_way: after so many rounds it goes half of the way, or it would go to and
        fro. rests: a misfit above this share of the one before hardly falls any more. least, small: a load factor nearer to
        zero than this, or, of a push, than this share of the first one, counts as this much where errors are measured by it.

    What a motion is worth, by what it lacks of one without dilatancy, a share of the load factor (and see `Demands`):
        started: a start further away is not good enough; higher: nor one whose load factor exceeds that of the certified
        analysis by this share. fits: it proves a step. credible: it tells how the stones go on. steady: a motion goes on as it
        did when no stone's speed has changed by more than this share of the fastest.

    Stones that move, by shares of the fastest speed:
        still: slower ones stand still. rim: a stone at the rim of the halo that is faster moves. worth: a halo that leaves no
        more than this share of the stones out is not worth having. kept: a halo keeps the first load factor within this share.
        large: with more points of contact the certified analysis takes many minutes. falling, ahead: those that take part in a
        fall, or in a motion that has gone local. jump: stones run ahead while the others are no more than so many times faster
        than in the last motion, unless the model is large. faster: a motion so many times faster than that of the last step is
        one of a few stones. expendable: stones that weigh no more than this share of what moved at the start may fall out
        without ending the curve; few: a share of what may fall out, see `Demands.faster`. strongest: what normal forces of so
        many weights in all cannot hold falls. withstood: in a large model a light stone falls that cannot stand this share of
        the last load factor, even if all others stood fast. let_go: in a large model, where no motion fits its forces, joints
        let go that open under pressure and make up more than this share of the misfit; foremost: of the stones that then fall
        those faster than this are taken out first. left_behind: stones slower than this share of a support stand still while
        it moves.

    Contacts found anew:
        depth, deeper: shares of the reach: how deep new neighbours may have sunk into each other, and stones that bore on each
        other before. narrow: the narrowest overlap that is a joint, likewise. same: two faces are the same joint as before when
        the cosine between their normals is larger. bearing: a joint that crushes bears where its gap is at most this share of
        the reach, beside the depth to which one stone has sunk into the other. further: a line of equal gap is worth points of
        its own when its gap exceeds that of the line before by this factor.

    Proof of a reaction:
        bounds: distance of its bounds, over it. balance: residual and violation of the cones, over the weight. flow: gap of a
        motion without dilatancy, over the reaction. nothing: a reaction below this share of the weight is none.

    Raises
    ------
    InputError: a constant that is not positive, a share of one or more, a factor of one or less.
    """

    step: float = 0.1
    reach: float = 0.2
    turn: float = 0.02
    right: float = 1.6
    shortest: float = 1e-3
    stalled: int = 25
    least_charge: float = 0.04
    snapping: float = 1e-6
    drop: float = 0.1
    bend: float = 0.01
    located: float = 0.1
    nearer: float = 0.3
    open: float = 0.25
    drift: float = 0.02
    lengths: int = 3
    first_programs: int = 12
    programs: int = 4
    pairs: int = 6
    rounds: int = 8
    rests: float = 0.9
    at_rest: float = 1e-3
    whole_way: int = 2
    least: float = 0.01
    small: float = 0.1
    started: float = 0.01
    higher: float = 5e-3
    fits: float = FITS
    credible: float = CREDIBLE
    steady: float = 0.3
    still: float = 1e-3
    rim: float = 1e-2
    worth: float = 0.2
    kept: float = 0.01
    large: int = 20_000
    falling: float = 0.02
    ahead: float = 0.1
    jump: float = 2.0
    faster: float = 20.0
    expendable: float = 0.05
    few: float = 0.1
    strongest: float = 100.0
    let_go: float = 0.01
    foremost: float = 0.5
    withstood: float = 0.8
    left_behind: float = 1e-4
    depth: float = 0.5
    deeper: float = 2.0
    narrow: float = 0.125
    same: float = 0.7
    bearing: float = 1e-3
    further: float = 1.5
    bounds: float = 1e-5
    balance: float = 1e-8
    flow: float = 1e-3
    nothing: float = 1e-7

    def __post_init__(self) -> None:
        counts = ("stalled", "lengths", "first_programs", "programs", "pairs", "rounds", "whole_way", "large")
        no_shares = (*counts, "jump", "strongest")
        factors = ("right", "faster", "deeper", "further")
        shares = [item.name for item in fields(self) if item.name not in (*no_shares, *factors)]
        check_constants(self, below_one=shares, above_one=factors)


PATH = PathSettings()
EXACTING = Demands(
    fitting=2e-3,
    begins=2e-3,
    enough=2e-3,
    resting=np.inf,
    far=np.inf,
    astray=np.inf,
    shorter=PATH.right,
    across=1e-5,
    further=np.inf,
    faster=PATH.faster,
    onward=False,
    duality_gap=1e-7,
    closed=0.0,
)
# In a large model a program takes seconds.
THRIFTY = Demands(
    fitting=8e-3,
    begins=5e-3,
    enough=0.01,
    resting=2,
    far=2.0,
    astray=0.1,
    shorter=25.0,
    across=8e-3,
    further=4.0,
    faster=5.0,
    onward=True,
    duality_gap=1e-5,
    closed=1e-3,
)
