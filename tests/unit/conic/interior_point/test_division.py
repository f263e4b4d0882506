"""Sums over elements divided among threads: every block of rows written by one, the same digits with any number of them."""

import numpy as np
import pytest
import scipy.sparse as sp

from churchpipe.conic.interior_point.coupling import Coupling, touches
from churchpipe.conic.interior_point.division import divided
from churchpipe.conic.interior_point.normal import NormalMatrix

# Enough for several threads.
COUNT = 21_000


def chain(block: int) -> Coupling:
    """Return a coupling of local problems that touch a block near their place, the next, and one far away."""
    rng = np.random.default_rng(5)
    column = np.repeat(np.arange(2 * COUNT), 3)
    place = np.tile(np.arange(COUNT) // 2, 2)
    near = np.column_stack([place, place + 1, (place * 7) % (COUNT // 2)]).ravel()
    row = block * near + rng.integers(block, size=len(near))
    matrix = sp.csc_matrix((rng.normal(size=len(row)), (row, column)), shape=(block * (COUNT // 2 + 1), 2 * COUNT))
    return Coupling(touches(matrix, 2, block))


@pytest.mark.parametrize("shares", [1, 2, 5])
def test_each_block_is_written_by_one_share_that_sees_all_its_elements(shares: int) -> None:
    coupling = chain(1)
    width = np.diff(coupling.pointer)
    parts = divided(coupling.pointer[:-1], width, coupling.blocks, coupling.rows, shares)
    assert parts.shares == shares
    written = np.zeros(coupling.rows)
    for share in range(shares):
        mine = parts.members[parts.first[share] : parts.first[share + 1]]
        assert (np.diff(mine) > 0).all()
        for element in mine:
            touched = coupling.blocks[coupling.pointer[element] : coupling.pointer[element + 1]]
            np.add.at(written, touched[parts.owner[touched] == share], 1.0)
    np.testing.assert_array_equal(written, np.bincount(coupling.blocks, minlength=coupling.rows))


@pytest.mark.parametrize("block", [1, 3])
def test_the_last_digit_does_not_hang_on_the_number_of_threads(block: int, monkeypatch: pytest.MonkeyPatch) -> None:
    coupling, rng = chain(block), np.random.default_rng(6)
    x, root = rng.normal(size=2 * COUNT), rng.normal(size=(2, 2, COUNT))
    compliance = np.einsum("abk,cbk->ack", root, root)
    found = []
    for threads in ("1", "3"):
        monkeypatch.setenv("OMP_NUM_THREADS", threads)
        normal = NormalMatrix(coupling)
        found.append((coupling.couple(x), normal.assemble(compliance), normal.pattern))
    (force, values, pattern), (again, same, _) = found
    np.testing.assert_array_equal(force, again)
    np.testing.assert_array_equal(values, same)
    matrix = coupling.matrix()
    np.testing.assert_allclose(force, np.asarray(matrix @ x), atol=1e-12 * np.abs(force).max())
    whole = sp.bmat([[sp.diags(compliance[a, b]) for b in range(2)] for a in range(2)])
    expected = sp.tril(matrix @ whole @ matrix.T)
    lower = sp.csc_matrix((values, pattern.indices, pattern.indptr), shape=pattern.shape)
    assert np.abs((expected - lower).data).max() <= 1e-12 * np.abs(values).max()
