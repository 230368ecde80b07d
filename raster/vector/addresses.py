"""Arrays by address: how one row of integers can name every array of a Draw.

A frame's Draws wait in a queue, each with arrays of its own shapes; a kernel that runs them all takes one
table, and makes arrays of its rows as it goes. An array takes a place for its address and one for each of its
extents; tuples of arrays take their members' places, in order. Whoever fills a row keeps the arrays alive.
"""

from itertools import count

from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array

_INTEGER = ir.IntType(64)


def places(kind):
    """How many places of a row C-contiguous arrays take; ``kind``: the type of one, or of a tuple of some."""
    return 1 + kind.ndim if isinstance(kind, types.Array) else sum([places(member) for member in kind])


def _array(context, builder, kind, data, shape):
    """The C-contiguous array of a type that lies at an address."""
    size = kind.dtype.bitwidth // 8
    strides, stride = [], ir.Constant(_INTEGER, size)
    for extent in reversed(shape):
        strides.insert(0, stride)
        stride = builder.mul(stride, extent)
    made, item = context.make_array(kind)(context, builder), ir.Constant(_INTEGER, size)
    data = builder.inttoptr(data, made.data.type)
    populate_array(made, data=data, shape=shape, strides=strides, itemsize=item, meminfo=None)
    return made._getvalue()


def kept_arrays(kind, first):
    """Two functions for a row int64[:]: ``keep(row, arrays)`` fills in what a tuple of this type takes from
    place ``first`` on, and ``read(row)`` makes the tuple of it again.
    """

    @intrinsic
    def keep(typing_context, row, arrays):
        def codegen(context, builder, signature, args):
            data, place = context.make_array(row)(context, builder, args[0]).data, count(first)

            def fill(kind, value):
                if not isinstance(kind, types.Array):
                    for k, member in enumerate(kind):
                        fill(member, builder.extract_value(value, k))
                    return
                array = context.make_array(kind)(context, builder, value)
                extents = [builder.extract_value(array.shape, k) for k in range(kind.ndim)]
                for number in (builder.ptrtoint(array.data, _INTEGER), *extents):
                    builder.store(number, builder.gep(data, [ir.Constant(_INTEGER, next(place))]))

            fill(kind, args[1])
            return context.get_dummy_value()

        return types.void(row, kind), codegen

    @intrinsic
    def read(typing_context, row):
        def codegen(context, builder, signature, args):
            data, place = context.make_array(row)(context, builder, args[0]).data, count(first)

            def number():
                return builder.load(builder.gep(data, [ir.Constant(_INTEGER, next(place))]))

            def made(kind):
                if isinstance(kind, types.Array):
                    return _array(context, builder, kind, number(), [number() for _ in range(kind.ndim)])
                return context.make_tuple(builder, kind, [made(member) for member in kind])

            return made(kind)

        return kind(row), codegen

    return keep, read


@intrinsic
def words_at(typing_context, address, size):
    """The uint32[size] that lies at an address."""
    kind = types.uint32[::1]

    def codegen(context, builder, signature, args):
        return _array(context, builder, kind, args[0], [args[1]])

    return kind(types.int64, types.int64), codegen
