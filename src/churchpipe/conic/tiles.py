"""Products of dense columns, a tile of numbers at a time, which stay in the registers of the processor until they are complete.

The loops that numba makes of such products write every partial sum to memory: a third of the speed. So a tile is spelt out here
for the compiler, as instructions on vectors of four numbers; it makes of them what the processor has.
"""

from collections.abc import Callable
from typing import Any

import numba
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from churchpipe.model.arrays import FloatArray

# Columns of a tile, and rows of the lower and the higher kind.
COLUMNS = 4
_ROWS, _MORE_ROWS = 4, 8

_VECTOR = 4
_DOUBLE, _INDEX, _LANE = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
_FOUR = ir.VectorType(_DOUBLE, _VECTOR)
_ZERO = ir.Constant(_FOUR, [0.0] * _VECTOR)
_LANES = ir.Constant(ir.VectorType(_LANE, _VECTOR), [0] * _VECTOR)
# Vectors begin wherever a column does, on no boundary but that of a number.
_ALIGNED = 8
# Products are added in one instruction where the processor has one.
_CONTRACTED = ("contract",)


def _tile(rows: int) -> Callable[..., Any]:
    """Return the function that subtracts a tile of so many rows from i on and of four columns from j on, for numba's loops."""

    @intrinsic
    def subtract(_: Any, a: Any, out: Any, i: Any, j: Any, to: Any, line: Any, length: Any, across: Any, fresh: Any) -> Any:  # noqa: ARG001
        """Do what `subtract_products` does, for so many rows."""
        signature = types.void(a, out, *6 * (types.int64,), types.boolean)

        def generate(target: Any, builder: Any, _: Any, given: Any) -> Any:
            start, end = (target.make_array(kind)(target, builder, at).data for kind, at in ((a, given[0]), (out, given[1])))
            row, other, column, apart, count, beyond, new = given[2:]
            sums = _sums(builder, start, (row, other, apart, count), rows // _VECTOR)
            first = builder.gep(end, [builder.add(builder.mul(column, beyond), row)])
            with builder.if_else(new) as (alone, added):
                with alone:
                    _store(builder, first, beyond, sums, over=False)
                with added:
                    _store(builder, first, beyond, sums, over=True)
            return target.get_dummy_value()

        return signature, generate

    return subtract


def _sums(builder: Any, start: Any, place: tuple[Any, Any, Any, Any], vectors: int) -> list[list[Any]]:
    """Emit the loop over the length, and return the sums of each column, vector by vector."""
    row, other, apart, count = place
    before, loop, after = builder.block, builder.append_basic_block("products"), builder.append_basic_block("summed")
    left, right = builder.gep(start, [row]), builder.gep(start, [other])
    builder.branch(loop)
    builder.position_at_end(loop)

    def carried(value: Any) -> Any:
        found = builder.phi(value.type)
        found.add_incoming(value, before)
        return found

    k, high, wide = carried(ir.Constant(_INDEX, 0)), carried(left), carried(right)
    old = [[carried(_ZERO) for _ in range(vectors)] for _ in range(COLUMNS)]
    of_rows = [_load(builder, _shifted(builder, high, _VECTOR * each)) for each in range(vectors)]
    sums: list[list[Any]] = []
    for each in range(COLUMNS):
        factor = _spread(builder, builder.load(_shifted(builder, wide, each)))
        products = (builder.fmul(part, factor, flags=_CONTRACTED) for part in of_rows)
        sums.append([builder.fadd(at, product, flags=_CONTRACTED) for at, product in zip(old[each], products, strict=True)])
    following = builder.add(k, ir.Constant(_INDEX, 1))
    for phi, value in ((k, following), (high, builder.gep(high, [apart])), (wide, builder.gep(wide, [apart]))):
        phi.add_incoming(value, loop)
    for phis, values in zip(old, sums, strict=True):
        for phi, value in zip(phis, values, strict=True):
            phi.add_incoming(value, loop)
    builder.cbranch(builder.icmp_signed("<", following, count), loop, after)
    builder.position_at_end(after)
    return sums


def _store(builder: Any, first: Any, apart: Any, sums: list[list[Any]], *, over: bool) -> None:
    """Emit the subtraction of the sums from what stands there, or from nothing."""
    for column in sums:
        for number, part in enumerate(column):
            place = _shifted(builder, first, _VECTOR * number)
            rest = builder.fsub(_load(builder, place) if over else _ZERO, part)
            builder.store(rest, _vector_at(builder, place)).align = _ALIGNED
        first = builder.gep(first, [apart])


def _shifted(builder: Any, pointer: Any, numbers: int) -> Any:
    return builder.gep(pointer, [ir.Constant(_INDEX, numbers)])


def _vector_at(builder: Any, pointer: Any) -> Any:
    return builder.bitcast(pointer, _FOUR.as_pointer())


def _load(builder: Any, pointer: Any) -> Any:
    found = builder.load(_vector_at(builder, pointer))
    found.align = _ALIGNED
    return found


def _spread(builder: Any, number: Any) -> Any:
    """Return the vector of four times the same number."""
    alone = builder.insert_element(ir.Constant(_FOUR, ir.Undefined), number, ir.Constant(_LANE, 0))
    return builder.shuffle_vector(alone, ir.Constant(_FOUR, ir.Undefined), _LANES)


_subtract, _subtract_more = _tile(_ROWS), _tile(_MORE_ROWS)


@numba.njit(cache=True)
def padded(size: int) -> int:
    """Return the rows or columns of the whole tiles that hold so many."""
    return (size + COLUMNS - 1) // COLUMNS * COLUMNS


@numba.njit(cache=True, error_model="numpy", nogil=True)
def subtract_products(
    a: FloatArray, out: FloatArray, first: int, end: int, j: int, to: int, line: int, length: int, across: int, fresh: bool
) -> None:
    """Subtract the sums of a_ik a_jk over k < length, for i from `first` to `end` and four j, from out_im of four m from `to` on.

    a and out (flat): their columns are `line` and `across` numbers apart; up to three rows beyond the end are read and written.
    fresh: from nothing, whatever stands in out. length is one at least.
    """
    i = first
    while i + _ROWS < end:
        _subtract_more(a, out, i, j, to, line, length, across, fresh)
        i += _MORE_ROWS
    if i < end:
        _subtract(a, out, i, j, to, line, length, across, fresh)
