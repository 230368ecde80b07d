"""Short vectors of numbers as values in kernels: the one place that knows how they become machine code.

A ``Vector`` is so many lanes of one element type; Numba keeps it in registers like a number. Every operation
lowers to LLVM's own vector instructions, which exist for any number of lanes: LLVM splits or widens them to
what the processor has, so the same source gives the same bits with AVX-512, AVX2, SSE2 or NEON. Nothing here
reorders, fuses or approximates.

``a + b`` and the like take two vectors of one type, or a vector and a number that becomes its element type
and fills every lane. Integers wrap. ``>>`` keeps the sign (``shift_right`` does not); shifting by the
element's width or more is undefined, as is converting a float that the integer cannot hold: callers see to
it. Comparisons give masks for ``select``.

Vectors are loaded from and stored to one-dimensional arrays, at any index. No index is checked, unless
Numba's bounds checking is on: then leaving an array raises IndexError.
"""

import operator

from llvmlite import ir
from numba import types
from numba.core import cgutils, config
from numba.core.extending import lower_builtin, models, register_model, type_callable
from numba.extending import intrinsic

_ELEMENTS = {
    types.boolean: ir.IntType(1),
    types.uint8: ir.IntType(8),
    types.int16: ir.IntType(16),
    types.int32: ir.IntType(32),
    types.int64: ir.IntType(64),
    types.float32: ir.FloatType(),
    types.float64: ir.DoubleType(),
}
_LETTERS = {
    types.uint8: "i8",
    types.int16: "i16",
    types.int32: "i32",
    types.int64: "i64",
    types.float32: "f32",
    types.float64: "f64",
}
_REAL = (types.float32, types.float64)


class Vector(types.Type):
    """``lanes`` numbers of the Numba type ``element``."""

    def __init__(self, element, lanes):
        self.element, self.lanes = element, lanes
        super().__init__(name=f"Vector({element}, {lanes})")

    @property
    def key(self):
        """What tells two types apart."""
        return self.element, self.lanes

    @property
    def ir(self):
        """The LLVM type."""
        return ir.VectorType(_ELEMENTS[self.element], self.lanes)

    @property
    def suffix(self):
        """How LLVM's intrinsics name the type."""
        return f"v{self.lanes}{_LETTERS[self.element]}"

    def of(self, element):
        """The type of as many lanes of another element."""
        return Vector(element, self.lanes)


@register_model(Vector)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, manager, vector):
        super().__init__(manager, vector, vector.ir)


# The types that kernels use, by element and lanes.
U8X4, U8X16, U8X32 = (Vector(types.uint8, lanes) for lanes in (4, 16, 32))
I16X4, I16X16, I16X32 = (Vector(types.int16, lanes) for lanes in (4, 16, 32))
I32X8, I32X16, I32X32 = Vector(types.int32, 8), Vector(types.int32, 16), Vector(types.int32, 32)
I64X8 = Vector(types.int64, 8)
F32X16 = Vector(types.float32, 16)
F64X8, F64X16 = Vector(types.float64, 8), Vector(types.float64, 16)


def _all(vector, value):
    """A constant in every lane."""
    return ir.Constant(vector.ir, [value] * vector.lanes)


def _splat(builder, vector, value):
    undefined = ir.Constant(vector.ir, ir.Undefined)
    first = builder.insert_element(undefined, value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), vector.lanes), [0] * vector.lanes)
    return builder.shuffle_vector(first, undefined, zeros)


def _call(builder, name, result, args):
    function = ir.FunctionType(result, [a.type for a in args])
    return builder.call(cgutils.get_or_insert_function(builder.module, function, name), args)


# ------------------------------------------------------------------------------------------- operators


def _operands(context, builder, signature, args):
    """Both operands as vectors of the vector operand's type."""
    vector = next(t for t in signature.args if isinstance(t, Vector))
    values = []
    for given, value in zip(signature.args, args, strict=True):
        if not isinstance(given, Vector):
            value = _splat(builder, vector, context.cast(builder, value, given, vector.element))
        values.append(value)
    return vector, values


def _binary(operation, emit, result=None):
    @type_callable(operation)
    def type_of(context):
        def typer(a, b):
            vector = a if isinstance(a, Vector) else b
            if not isinstance(vector, Vector):
                return None
            if not all(t == vector or isinstance(t, types.Number) for t in (a, b)):
                return None
            return vector if result is None else vector.of(result)

        return typer

    def lower(context, builder, signature, args):
        vector, values = _operands(context, builder, signature, args)
        return emit(builder, vector, *values)

    for pair in ((Vector, Vector), (Vector, types.Number), (types.Number, Vector)):
        lower_builtin(operation, *pair)(lower)


def _arithmetic(operation, integer, real):
    def emit(builder, vector, a, b):
        return getattr(builder, real if vector.element in _REAL else integer)(a, b)

    _binary(operation, emit)


def _comparison(operation, symbol):
    def emit(builder, vector, a, b):
        if vector.element not in _REAL:
            return builder.icmp_signed(symbol, a, b)
        # What is not a number differs from everything and compares with nothing, as in Python.
        return (builder.fcmp_unordered if symbol == "!=" else builder.fcmp_ordered)(symbol, a, b)

    _binary(operation, emit, types.boolean)


_arithmetic(operator.add, "add", "fadd")
_arithmetic(operator.sub, "sub", "fsub")
_arithmetic(operator.mul, "mul", "fmul")
_arithmetic(operator.truediv, None, "fdiv")
_arithmetic(operator.and_, "and_", None)
_arithmetic(operator.or_, "or_", None)
_arithmetic(operator.xor, "xor", None)
_arithmetic(operator.lshift, "shl", None)
_arithmetic(operator.rshift, "ashr", None)
for _operation, _symbol in (
    (operator.lt, "<"),
    (operator.le, "<="),
    (operator.gt, ">"),
    (operator.ge, ">="),
    (operator.eq, "=="),
    (operator.ne, "!="),
):
    _comparison(_operation, _symbol)


@intrinsic
def shift_right(typing_context, a, count):
    """``a >> count`` with zeros from the left; ``count``: a number for all lanes."""

    def codegen(context, builder, signature, args):
        amount = context.cast(builder, args[1], signature.args[1], a.element)
        return builder.lshr(args[0], _splat(builder, a, amount))

    return a(a, count), codegen


def _extreme(symbol, doc):
    @intrinsic
    def extreme(typing_context, a, b):
        if not (isinstance(a, Vector) and (a == b or isinstance(b, types.Number))):
            raise TypeError(f"two vectors of one type, or a vector and a number, not {a} and {b}")

        def codegen(context, builder, signature, args):
            vector, (x, y) = _operands(context, builder, signature, args)
            compare = builder.fcmp_ordered if vector.element in _REAL else builder.icmp_signed
            return builder.select(compare(symbol, x, y), x, y)

        return a(a, b), codegen

    extreme.__doc__ = doc
    return extreme


@intrinsic
def fused(typing_context, a, b, c):
    """``a b + c``, rounded once, of three vectors of floats."""

    def codegen(context, builder, signature, args):
        return _call(builder, f"llvm.fma.{a.suffix}", a.ir, args)

    return a(a, a, a), codegen


minimum = _extreme("<", "The smaller of each two lanes; the second where one is not a number.")
maximum = _extreme(">", "The larger of each two lanes; the second where one is not a number.")


@intrinsic
def select(typing_context, mask, a, b):
    """``a`` where the mask is set, else ``b``."""

    def codegen(context, builder, signature, args):
        return builder.select(*args)

    return a(mask, a, a), codegen


@intrinsic
def any_lane(typing_context, mask):
    """Whether a mask is set in any lane."""

    def codegen(context, builder, signature, args):
        bits = ir.IntType(mask.lanes)
        return builder.icmp_unsigned("!=", builder.bitcast(args[0], bits), ir.Constant(bits, 0))

    return types.boolean(mask), codegen


@intrinsic
def all_lanes(typing_context, mask):
    """Whether a mask is set in every lane."""

    def codegen(context, builder, signature, args):
        bits = ir.IntType(mask.lanes)
        return builder.icmp_unsigned("==", builder.bitcast(args[0], bits), ir.Constant(bits, -1))

    return types.boolean(mask), codegen


@intrinsic
def mask_bits(typing_context, mask):
    """A mask of up to 63 lanes as an int64, lane 0 in the lowest bit."""

    def codegen(context, builder, signature, args):
        return builder.zext(builder.bitcast(args[0], ir.IntType(mask.lanes)), ir.IntType(64))

    return types.int64(mask), codegen


def _reduction(name, doc):
    @intrinsic
    def reduction(typing_context, a):
        def codegen(context, builder, signature, args):
            return _call(builder, f"llvm.vector.reduce.{name}.{a.suffix}", _ELEMENTS[a.element], args)

        return a.element(a), codegen

    reduction.__doc__ = doc
    return reduction


smallest_lane = _reduction("smin", "The smallest of an integer vector's lanes.")
largest_lane = _reduction("smax", "The largest of an integer vector's lanes.")


@intrinsic
def lowest_bit(typing_context, bits):
    """The number of zeros below the lowest set bit of an int64; 64 for 0."""

    def codegen(context, builder, signature, args):
        return _call(builder, "llvm.cttz.i64", ir.IntType(64), [args[0], ir.Constant(ir.IntType(1), 0)])

    return types.int64(types.int64), codegen


@intrinsic
def count_bits(typing_context, bits):
    """How many bits of an int64 are set."""

    def codegen(context, builder, signature, args):
        return _call(builder, "llvm.ctpop.i64", ir.IntType(64), [args[0]])

    return types.int64(types.int64), codegen


def _unary(name, integer=None):
    @intrinsic
    def unary(typing_context, a):
        def codegen(context, builder, signature, args):
            return _call(builder, f"llvm.{name}.{a.suffix}", a.ir, args)

        return a(a), codegen

    return unary


@intrinsic
def below(typing_context, a, b):
    """Where ``a < b``, both taken as unsigned; ``b``: a vector, or a number for all lanes."""

    def codegen(context, builder, signature, args):
        return builder.icmp_unsigned("<", *_operands(context, builder, signature, args)[1])

    return a.of(types.boolean)(a, b), codegen


@intrinsic
def minimum_unsigned(typing_context, a, b):
    """The smaller of each two lanes, both taken as unsigned; ``b``: a vector, or a number for all lanes."""

    def codegen(context, builder, signature, args):
        _, (x, y) = _operands(context, builder, signature, args)
        return builder.select(builder.icmp_unsigned("<", x, y), x, y)

    return a(a, b), codegen


@intrinsic
def add_saturated(typing_context, a, b):
    """``a + b`` of unsigned lanes; what exceeds the element is its largest."""

    def codegen(context, builder, signature, args):
        return _call(builder, f"llvm.uadd.sat.{a.suffix}", a.ir, args)

    return a(a, a), codegen


@intrinsic
def join_i32(typing_context, low, high):
    """32 bits a lane from two vectors of 16: ``low | high << 16``."""
    result = low.of(types.int32)

    def codegen(context, builder, signature, args):
        order = [k // 2 + (k % 2) * low.lanes for k in range(2 * low.lanes)]
        mask = ir.Constant(ir.VectorType(ir.IntType(32), 2 * low.lanes), order)
        return builder.bitcast(builder.shuffle_vector(*args, mask), result.ir)

    return result(low, low), codegen


@intrinsic
def magnitude(typing_context, a):
    """The absolute value of integer lanes; the least integer stays."""

    def codegen(context, builder, signature, args):
        false = ir.Constant(ir.IntType(1), 0)
        return _call(builder, f"llvm.abs.{a.suffix}", a.ir, [args[0], false])

    return a(a), codegen


def _extended(builder, vector, value, bits, extend):
    """Lanes of more bits."""
    return getattr(builder, extend)(value, ir.VectorType(ir.IntType(bits), vector.lanes))


@intrinsic
def upper_half(typing_context, a, b):
    """The upper 16 bits of each product of 16-bit lanes without sign; ``b``: a vector, or a number."""

    def codegen(context, builder, signature, args):
        vector, values = _operands(context, builder, signature, args)
        x, y = (_extended(builder, vector, value, 32, "zext") for value in values)
        sixteen = ir.Constant(x.type, [16] * vector.lanes)
        return builder.trunc(builder.lshr(builder.mul(x, y), sixteen), vector.ir)

    return a(a, b), codegen


# Of (a b + 2**14) >> 15 in signed 16-bit lanes: an instruction by the feature that has it and the number of
# lanes. Nothing in LLVM's own language becomes it.
_ROUNDED_PRODUCTS = (
    ("+avx512bw", 32, "llvm.x86.avx512.pmul.hr.sw.512"),
    ("+avx2", 16, "llvm.x86.avx2.pmul.hr.sw"),
)


@intrinsic
def mixed_bytes(typing_context, p, q, weight):
    """``(p (256 - weight) + q weight + 128) >> 8`` in 16-bit lanes, all three in 0..255.

    Where the processor multiplies and rounds at once, it is ``p + ((q - p) (128 weight) + 2**14 >> 15)``: the
    same, as a multiple of 256 passes through the shift, and a factor of 128 through its rounding. Elsewhere
    the sum has no sign, and at most 255 * 256 + 128 < 65536.
    """

    def codegen(context, builder, signature, args):
        a, b, w = args
        features = context.codegen().magic_tuple()[2].split(",")
        for feature, lanes, name in _ROUNDED_PRODUCTS:
            if feature not in features or p.lanes % lanes:
                continue
            part = ir.VectorType(ir.IntType(16), lanes)
            x, y = builder.sub(b, a), builder.shl(w, _all(p, 7))
            found = None
            for first in range(0, p.lanes, lanes):
                pair = [_shuffle(builder, v, v, range(first, first + lanes)) for v in (x, y)]
                product = _call(builder, name, part, pair)
                order = range(first + lanes)
                found = product if found is None else _shuffle(builder, found, product, order)
            return builder.add(a, found)
        total = builder.add(builder.mul(a, builder.sub(_all(p, 256), w)), builder.mul(b, w))
        return builder.lshr(builder.add(total, _all(p, 128)), _all(p, 8))

    return p(p, p, p), codegen


truncated = _unary("trunc")  # toward zero, still a float
floored = _unary("floor")
absolute = _unary("fabs")


# ------------------------------------------------------------------------------- making and converting


def _maker(vector, doc):
    @intrinsic
    def make(typing_context, value):
        def codegen(context, builder, signature, args):
            return _splat(builder, vector, args[0])

        return vector(vector.element), codegen

    make.__doc__ = doc
    return make


i16x4 = _maker(I16X4, "A number in all lanes, as the following.")
i16x16 = _maker(I16X16, "")
i16x32 = _maker(I16X32, "")
i32x8 = _maker(I32X8, "")
i32x16 = _maker(I32X16, "")
i64x8 = _maker(I64X8, "")
f32x16 = _maker(F32X16, "")
f64x8 = _maker(F64X8, "")
f64x16 = _maker(F64X16, "")


def _ramp(vector, doc):
    @intrinsic
    def ramp(typing_context):
        def codegen(context, builder, signature, args):
            return ir.Constant(vector.ir, list(range(vector.lanes)))

        return vector(), codegen

    ramp.__doc__ = doc
    return ramp


ramp_i32x16 = _ramp(I32X16, "0, 1, 2, ..., as the following.")
ramp_i32x8 = _ramp(I32X8, "")
ramp_f64x8 = _ramp(F64X8, "")
ramp_f64x16 = _ramp(F64X16, "")


def _converter(element, emit, doc):
    @intrinsic
    def convert(typing_context, a):
        result = a.of(element)

        def codegen(context, builder, signature, args):
            return getattr(builder, emit)(args[0], result.ir)

        return result(a), codegen

    convert.__doc__ = doc
    return convert


to_int32 = _converter(types.int32, "fptosi", "A float's integer part; undefined beyond int32.")
to_float64 = _converter(types.float64, "sitofp", "An integer as a float.")
to_float32 = _converter(types.float32, "sitofp", "An integer as a float32, rounded as the processor is told.")
narrow_i32 = _converter(types.int32, "trunc", "The lower 32 bits.")
narrow_i16 = _converter(types.int16, "trunc", "The lower 16 bits.")
narrow_u8 = _converter(types.uint8, "trunc", "The lower 8 bits.")
widen_i32 = _converter(types.int32, "sext", "The same integer in 32 bits.")
widen_unsigned_i16 = _converter(types.int16, "zext", "The bits as an unsigned integer in 16 bits.")
widen_unsigned_i32 = _converter(types.int32, "zext", "The bits as an unsigned integer in 32 bits.")


def _reinterpreter(element, factor, doc):
    @intrinsic
    def reinterpret(typing_context, a):
        result = Vector(element, int(a.lanes * factor))

        def codegen(context, builder, signature, args):
            return builder.bitcast(args[0], result.ir)

        return result(a), codegen

    reinterpret.__doc__ = doc
    return reinterpret


halves_of_lanes = _reinterpreter(types.int16, 2, "The lower, then the upper 16 bits of each 32-bit lane.")
lanes_of_halves = _reinterpreter(types.int32, 1 / 2, "The 32-bit lanes that ``halves_of_lanes`` took apart.")
bytes_of_lanes = _reinterpreter(types.uint8, 4, "The four bytes of each 32-bit lane, the lowest first.")
lanes_of_bytes = _reinterpreter(types.int32, 1 / 4, "The 32-bit lanes that ``bytes_of_lanes`` took apart.")


def _scalar_reinterpreter(source, target, doc):
    @intrinsic
    def reinterpret(typing_context, a):
        def codegen(context, builder, signature, args):
            return builder.bitcast(args[0], context.get_value_type(target))

        return target(source), codegen

    reinterpret.__doc__ = doc
    return reinterpret


bits_of_single = _scalar_reinterpreter(types.float32, types.int32, "The bit pattern of a float32.")
bytes_of = _scalar_reinterpreter(types.uint32, U8X4, "The four bytes of a uint32, the lowest first.")
packed_of = _scalar_reinterpreter(U8X4, types.uint32, "The uint32 that ``bytes_of`` took apart.")
quarters_of = _scalar_reinterpreter(types.int64, I16X4, "The 16-bit quarters of an int64, the lowest first.")


bits_of_lanes = _converter(types.int64, "bitcast", "The bit patterns of float64 lanes.")
floats_of_lanes = _converter(types.float64, "bitcast", "The float64 with each bit pattern.")
narrow_f32 = _converter(types.float32, "fptrunc", "A float64 as a float32, rounded as the processor is told.")
to_doubles = _converter(types.float64, "fpext", "The same float32 in 64 bits.")
bits_of_singles = _converter(types.int32, "bitcast", "The bit patterns of float32 lanes.")
singles_of_bits = _converter(types.float32, "bitcast", "The float32 with each bit pattern.")


# ---------------------------------------------------------------------------------- loading and storing


def _address(context, builder, array, value, index, vector):
    """Pointer to ``lanes`` elements of a one-dimensional array from ``index`` on."""
    struct = context.make_array(array)(context, builder, value)
    if config.BOUNDSCHECK:
        size = cgutils.unpack_tuple(builder, struct.shape, 1)[0]
        end = builder.add(index, ir.Constant(index.type, vector.lanes))
        outside = builder.or_(
            builder.icmp_signed("<", index, ir.Constant(index.type, 0)), builder.icmp_signed(">", end, size)
        )
        with builder.if_then(outside, likely=False):
            context.call_conv.return_user_exc(builder, IndexError, ("a vector leaves its array",))
    return builder.bitcast(builder.gep(struct.data, [index]), vector.ir.as_pointer())


def _check(array, vector):
    ok = isinstance(array, types.Array) and array.ndim == 1 and array.layout == "C"
    if not (ok and array.dtype.bitwidth == vector.element.bitwidth):
        raise TypeError(f"a contiguous array of {vector.element} with one dimension, not {array}")


def _loader(vector):
    @intrinsic
    def load(typing_context, array, index):
        """The lanes from ``array[index]`` on."""
        _check(array, vector)

        def codegen(context, builder, signature, args):
            pointer = _address(context, builder, array, args[0], args[1], vector)
            loaded = builder.load(pointer)
            loaded.align = vector.element.bitwidth // 8
            return loaded

        return vector(array, types.int64), codegen

    return load


load_u8x16, load_u8x32 = _loader(U8X16), _loader(U8X32)
load_i16x16, load_i16x32 = _loader(I16X16), _loader(I16X32)
load_i32x8, load_i32x16, load_i32x32 = _loader(I32X8), _loader(I32X16), _loader(I32X32)
load_f32x16 = _loader(F32X16)
load_f64x8, load_f64x16 = _loader(F64X8), _loader(F64X16)


@intrinsic
def store(typing_context, array, index, value):
    """Lanes to ``array[index]`` and what follows."""
    _check(array, value)

    def codegen(context, builder, signature, args):
        pointer = _address(context, builder, array, args[0], args[1], value)
        stored = builder.store(args[2], pointer)
        stored.align = value.element.bitwidth // 8
        return context.get_dummy_value()

    return types.void(array, types.int64, value), codegen


@intrinsic
def load_i32x16_where(typing_context, array, index, mask):
    """Those lanes from ``array[index]`` on that a mask names; zeros, and nothing is read, in the others."""
    _check(array, I32X16)

    def codegen(context, builder, signature, args):
        struct = context.make_array(array)(context, builder, args[0])
        pointer = builder.bitcast(builder.gep(struct.data, [args[1]]), I32X16.ir.as_pointer())
        alignment, zeros = ir.Constant(ir.IntType(32), 4), _all(I32X16, 0)
        return _call(builder, "llvm.masked.load.v16i32.p0", I32X16.ir, [pointer, alignment, args[2], zeros])

    return I32X16(array, types.int64, mask), codegen


@intrinsic
def store_where(typing_context, array, index, value, mask):
    """Those lanes that a mask names, to ``array[index]`` and what follows."""
    _check(array, value)

    def codegen(context, builder, signature, args):
        struct = context.make_array(array)(context, builder, args[0])
        pointer = builder.bitcast(builder.gep(struct.data, [args[1]]), value.ir.as_pointer())
        alignment = ir.Constant(ir.IntType(32), value.element.bitwidth // 8)
        letters = _ELEMENTS[value.element].intrinsic_name
        name = f"llvm.masked.store.v{value.lanes}{letters}.p0"
        _call(builder, name, ir.VoidType(), [args[2], pointer, alignment, args[3]])
        return context.get_dummy_value()

    return types.void(array, types.int64, value, mask), codegen


# ------------------------------------------------------------------------------------- moving lanes about


def _shuffle(builder, a, b, lanes):
    mask = ir.Constant(ir.VectorType(ir.IntType(32), len(lanes)), list(lanes))
    return builder.shuffle_vector(a, b, mask)


def _every_second(first, doc):
    @intrinsic
    def every_second(typing_context, a, b):
        def codegen(context, builder, signature, args):
            return _shuffle(builder, *args, range(first, 2 * a.lanes, 2))

        return a(a, a), codegen

    every_second.__doc__ = doc
    return every_second


even_lanes = _every_second(0, "Lanes 0, 2, 4, ... of one vector, then of another.")
odd_lanes = _every_second(1, "Lanes 1, 3, 5, ... of one vector, then of another.")


@intrinsic
def twice(typing_context, a):
    """Every lane two times."""
    result = Vector(a.element, 2 * a.lanes)

    def codegen(context, builder, signature, args):
        return _shuffle(builder, args[0], args[0], [k // 2 for k in range(2 * a.lanes)])

    return result(a), codegen


@intrinsic
def next_lanes(typing_context, a):
    """Each lane's successor; the last lane's is itself."""

    def codegen(context, builder, signature, args):
        return _shuffle(builder, args[0], args[0], [*range(1, a.lanes), a.lanes - 1])

    return a(a), codegen


@intrinsic
def distinct_lanes(typing_context, a):
    """Whether no two lanes hold the same integer."""

    def codegen(context, builder, signature, args):
        equal = None
        for distance in range(1, a.lanes // 2 + 1):
            order = [(lane + distance) % a.lanes for lane in range(a.lanes)]
            found = builder.icmp_signed("==", args[0], _shuffle(builder, args[0], args[0], order))
            equal = found if equal is None else builder.or_(equal, found)
        bits = ir.IntType(a.lanes)
        return builder.icmp_unsigned("==", builder.bitcast(equal, bits), ir.Constant(bits, 0))

    return types.boolean(a), codegen


def _index(context, builder, array, args, at, lane):
    """An element of an int32 array as an int64 that is not negative."""
    struct = context.make_array(array)(context, builder, args)
    address = builder.gep(struct.data, [builder.add(at, ir.Constant(at.type, lane))])
    return builder.zext(builder.load(address), ir.IntType(64))


def _checked_array(context, builder, array, value, at, vector):
    """As ``_address`` checks it; the array's data."""
    _address(context, builder, array, value, at, vector)
    return context.make_array(array)(context, builder, value).data


def _each_loader(vector):
    single = Vector(vector.element, 1)

    @intrinsic
    def load_each(typing_context, array, indices, at):
        """The elements at the indices (int32, not negative) from ``indices[at]`` on."""
        _check(array, vector)
        places = vector.of(types.int32)
        _check(indices, places)

        def codegen(context, builder, signature, args):
            _checked_array(context, builder, indices, args[1], args[2], places)
            found = ir.Constant(vector.ir, ir.Undefined)
            for lane in range(vector.lanes):
                index = _index(context, builder, indices, args[1], args[2], lane)
                element = builder.load(_address(context, builder, array, args[0], index, single))
                element = builder.extract_element(element, ir.Constant(ir.IntType(32), 0))
                found = builder.insert_element(found, element, ir.Constant(ir.IntType(32), lane))
            return found

        return vector(array, indices, types.int64), codegen

    return load_each


load_each_i32x8, load_each_i32x16 = _each_loader(I32X8), _each_loader(I32X16)
load_each_i64x8 = _each_loader(I64X8)


@intrinsic
def load_quads(typing_context, array, indices, at):
    """Four consecutive 32-bit elements at each of sixteen indices (as ``load_each_i32x16``), every second one
    from ``indices[at]`` on: vectors of the first elements, the second, the third and the fourth.

    Sixteen loads of 128 bits and a transposition in those lanes: less than half the time of 64 loads, or of
    the processor's own gathering.
    """
    _check(array, I32X16)
    _check(indices, I32X16)
    result = types.UniTuple(I32X16, 4)

    def codegen(context, builder, signature, args):
        _checked_array(context, builder, indices, args[1], args[2], I32X16)
        quad = Vector(types.int32, 4)
        quads = []
        for lane in range(16):
            index = _index(context, builder, indices, args[1], args[2], 2 * lane)
            loaded = builder.load(_address(context, builder, array, args[0], index, quad))
            loaded.align = 4
            quads.append(loaded)
        # Fragments 0, 4, 8, 12 side by side, then 1, 5, 9, 13 and so on: transposing in lanes of 128 bits
        # then leaves all sixteen in order.
        rows = []
        for k in range(4):
            low, high = (_shuffle(builder, quads[k + j], quads[k + j + 4], range(8)) for j in (0, 8))
            rows.append(_shuffle(builder, low, high, range(16)))

        def in_lanes(a, b, pattern):
            lanes = [4 * lane + (k if k < 4 else 12 + k) for lane in range(4) for k in pattern]
            return _shuffle(builder, a, b, lanes)

        low01, high01 = in_lanes(*rows[:2], (0, 4, 1, 5)), in_lanes(*rows[:2], (2, 6, 3, 7))
        low23, high23 = in_lanes(*rows[2:], (0, 4, 1, 5)), in_lanes(*rows[2:], (2, 6, 3, 7))
        columns = [
            in_lanes(*pair, pattern)
            for pair in ((low01, low23), (high01, high23))
            for pattern in ((0, 1, 4, 5), (2, 3, 6, 7))
        ]
        return context.make_tuple(builder, result, columns)

    return result(array, indices, types.int64), codegen
