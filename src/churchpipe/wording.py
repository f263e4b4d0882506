"""Words that follow a number."""


def counted(number: int, one: str, several: str = "") -> str:
    """Return a number and what it counts, with its verb where there is one.

    Parameters
    ----------
    one
        "stone moves", after 1.
    several
        "stones move", after any other number; by default `one` with an s.
    """
    return f"{number} {one if number == 1 else several or one + 's'}"
