"""Arrays by address: how one row of integers can name every array of a Draw.

A frame's Draws wait in a queue, each with arrays of its own shapes; a kernel that runs them all takes one
table, and makes arrays of its rows as it goes. An array takes a place for its address and one for each of its
extents; tuples of arrays take their members' places, in order. Whoever fills a row keeps the arrays alive.
"""

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


@intrinsic
def keep_arrays(typing_context, row, place, arrays):
    """Fill in a row int64[:] from ``place`` on: the addresses and shapes of a tuple's arrays."""

    def codegen(context, builder, signature, args):
        data = context.make_array(row)(context, builder, args[0]).data
        place = args[1]

        def keep(kind, value):
            nonlocal place
            if not isinstance(kind, types.Array):
                for k, member in enumerate(kind):
                    keep(member, builder.extract_value(value, k))
                return
            array = context.make_array(kind)(context, builder, value)
            extents = [builder.extract_value(array.shape, k) for k in range(kind.ndim)]
            for number in (builder.ptrtoint(array.data, _INTEGER), *extents):
                builder.store(number, builder.gep(data, [place]))
                place = builder.add(place, ir.Constant(_INTEGER, 1))

        keep(arrays, args[2])
        return context.get_dummy_value()

    return types.void(row, types.int64, arrays), codegen


def reader(kind):
    """The function that makes a tuple of this type of what ``keep_arrays`` left in a row, from a place on."""

    @intrinsic
    def arrays_of(typing_context, row, place):
        """The arrays whose addresses and shapes are in a row from ``place`` on."""

        def codegen(context, builder, signature, args):
            data = context.make_array(row)(context, builder, args[0]).data
            place = args[1]

            def following():
                nonlocal place
                number = builder.load(builder.gep(data, [place]))
                place = builder.add(place, ir.Constant(_INTEGER, 1))
                return number

            def read(kind):
                if isinstance(kind, types.Array):
                    return _array(
                        context, builder, kind, following(), [following() for _ in range(kind.ndim)]
                    )
                return context.make_tuple(builder, kind, [read(member) for member in kind])

            return read(kind)

        return kind(row, types.int64), codegen

    return arrays_of


@intrinsic
def words_at(typing_context, address, count):
    """The uint32[count] that lies at an address."""
    kind = types.uint32[::1]

    def codegen(context, builder, signature, args):
        return _array(context, builder, kind, args[0], [args[1]])

    return kind(types.int64, types.int64), codegen
