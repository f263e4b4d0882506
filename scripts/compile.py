"""Compile the loops of the solvers, if none of them is compiled yet: python scripts/compile.py

Their first calls would do so. Several processes at once would compile the same ones, each for itself.
"""

import churchpipe as cp
from churchpipe.compilation import compiled

ELASTIC = cp.Elastic(block_modulus=3e9, block_poisson=0.2, joint_modulus=0.3e9, joint_poisson=0.2, joint_thickness=0.001)
STONE = cp.Material("default", 18e3, 0.6, elastic=ELASTIC)
PUSH = cp.LoadCase((0, 1, 0))


def compile_all() -> None:
    """Call every solver once, on a small wall."""
    building = cp.generators.wall(length=1.2, brick=(0.4, 0.25, 0.1), courses=4, materials=(STONE,))
    stones = cp.derive_blocks(building)
    contacts = cp.find_contacts(stones)
    cp.limit_analysis(stones, contacts, PUSH, STONE.friction, flow="non-associative")
    cp.block_pushover(stones, contacts, PUSH, STONE.friction, steps=2)
    shell = cp.derive_shell(building, element_size=0.4)
    for planes in ("cell", "paper"):
        cp.shell_limit_analysis(shell, PUSH, [STONE], planes=planes)
        cp.pushover(shell, PUSH, [STONE], planes=planes, steps=3)


if __name__ == "__main__" and not compiled():
    compile_all()
