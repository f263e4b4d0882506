"""What a case names of the whole building: joints by where they lie, ground that moves, a point to watch."""

from functools import partial

from churchpipe.config.carries import tried
from churchpipe.config.case import Case
from churchpipe.errors import InputError
from churchpipe.large_displacements.control import control_of
from churchpipe.large_displacements.path_arguments import check_step
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.quantities import Place
from churchpipe.stones.footing import footing, whole_ground_question
from churchpipe.stones.joints import joints_of


def picks(case: Case) -> bool:
    """Return whether a case names any of it."""
    curve = case.rigid.curve and (case.rigid.curve.control or case.rigid.curve.step)
    return bool(case.joints or case.movements or curve or (case.shell and case.shell.control_place))


def check_picked(case: Case, stones: Assemblage, contacts: Contacts) -> None:
    """Look for the joints of its groups, the ground of its movements and the points of its curves in the whole building.

    Steps of curves and movements are no longer than it is.

    Raises
    ------
    InputError: with the line of the case, what is not there.
    """
    control = case.rigid.curve.control if case.rigid.curve else None
    steps = [("rigid.curve.step", case.rigid.curve.step)] if case.rigid.curve else []
    steps += [(f"movements.{number}.step", movement.step) for number, movement in enumerate(case.movements)]
    try:
        for place, step in steps:
            if step is not None:
                check_step(place, stones, step)
        for number, group in enumerate(case.joints):
            tried(f"joints.{number}", partial(joints_of, stones, contacts, group))
        for number, movement in enumerate(case.movements):
            if place := movement.support or movement.within:
                tried(f"movements.{number}", partial(footing, stones, contacts, place))
        for load in case.loads if control else ():
            _check_control(stones, load, control, "rigid.curve.control")
        followed = case.shell.control_place if case.shell else None
        for load in case.loads if followed else ():
            _check_control(stones, load, followed, "shell.control_point")
    except InputError as error:
        raise case.located(error.at(f"{case.path}: {error.where}")) from error


def ground_questions(case: Case, stones: Assemblage, contacts: Contacts) -> list[str]:
    """Return what to ask about movements of all the ground that a whole building stands on; after `check_picked`."""
    places = [(one.name, one.support or one.within) for one in case.movements if one.about is None]
    asked = [whole_ground_question(stones, contacts, name, place) for name, place in places if place]
    return [text for text in asked if text]


def _check_control(stones: Assemblage, load: LoadCase, control: Place | None, where: str) -> None:
    try:
        control_of(stones, load, control)
    except InputError as error:
        raise error.at(where) from error
