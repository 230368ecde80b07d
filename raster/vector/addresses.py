"""Arrays by address: how one row of integers can name every array of a Draw.

A frame's Draws wait in a queue, each with arrays of its own shapes; a kernel that runs them all takes one
table of addresses and lengths, and makes arrays of them as it goes. Whoever fills the table keeps the arrays
alive.
"""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array


def _viewer(dtype, dimensions):
    array = types.Array(dtype, dimensions, "C")
    size = dtype.bitwidth // 8

    @intrinsic
    def view(typing_context, address, shape):
        """The C-contiguous array of this shape, a tuple, that lies at an address."""

        def codegen(context, builder, signature, args):
            integer = ir.IntType(64)
            made = context.make_array(array)(context, builder)
            shape = [builder.extract_value(args[1], k) for k in range(dimensions)]
            strides, stride = [], ir.Constant(integer, size)
            for extent in reversed(shape):
                strides.insert(0, stride)
                stride = builder.mul(stride, extent)
            data = builder.inttoptr(args[0], made.data.type)
            item = ir.Constant(integer, size)
            populate_array(made, data=data, shape=shape, strides=strides, itemsize=item, meminfo=None)
            return made._getvalue()

        return array(types.int64, types.UniTuple(types.int64, dimensions)), codegen

    return view


bytes_at = _viewer(types.uint8, 3)
integers_at, table_at, tables_at = (_viewer(types.int32, n) for n in (1, 2, 3))
longs_at, long_table_at = (_viewer(types.int64, n) for n in (1, 2))
texels_at = _viewer(types.uint32, 1)
floats_at = _viewer(types.float64, 1)
float_tables_at = _viewer(types.float64, 3)
