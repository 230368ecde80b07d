"""Float32 arithmetic that cuts: the processor's own rounding toward zero, for kernels that ask for it.

A product, a sum or a conversion rounded so is the exact one cut to 24 significant bits, which is how the chip
computes (docs/numbers.md, N5.1). LLVM takes it that rounding is to nearest. So such code keeps these rules,
and tests/raster/vector/test_rounding.py reads the machine code for them:

- a *leaf* computes, and calls nothing, neither a kernel nor a library: none expects another rounding;
- no leaf has an operation on two constants whose result is not exact, as LLVM would round it to nearest;
- a kernel of its own does nothing but to call the leaf by ``toward_zero``: arithmetic beside the two changes
  of the mode might be moved over one of them.
"""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

# The fields of the rounding mode; all of one set: toward zero.
_MXCSR_ROUNDING = 0x6000  # Source: x86-64's MXCSR.RC
_FPCR_ROUNDING = 0xC00000  # Source: AArch64's FPCR.RMode
_WORD, _LONG = ir.IntType(32), ir.IntType(64)


def is_arm(triple):
    """Whether code is for AArch64, which Apple calls arm64."""
    return triple.startswith(("aarch64", "arm64"))


def cuts(triple, features):
    """Whether code for a processor may use ``toward_zero``: AArch64, or x86-64 with a fused product and sum.

    Without one the rests that leaves compute would be calls of a library. AArch64 always has it.
    """
    return is_arm(triple) or (triple.startswith("x86_64") and "+fma" in features.split(","))


@intrinsic
def can_cut(typing_context):
    """Whether the code's processor ``cuts``: a constant, so that LLVM drops what is not for it."""

    def codegen(context, builder, signature, args):
        triple, _name, features = context.codegen().magic_tuple()
        return ir.Constant(ir.IntType(1), int(cuts(triple, features)))

    return types.boolean(), codegen


@intrinsic
def toward_zero(typing_context, leaf, arguments):
    """``leaf(*arguments)`` with rounding toward zero. The mode is the caller's again when the leaf returns,
    or raises.
    """
    called = leaf.get_call_type(typing_context, tuple(arguments), {})

    def codegen(context, builder, signature, args):
        found = leaf.dispatcher.get_compile_result(called)
        context.add_linking_libs([found.library])
        function = context.declare_function(builder.module, found.fndesc)
        values = [
            context.cast(builder, value, given, wanted)
            for value, given, wanted in zip(
                cgutils.unpack_tuple(builder, args[1]), arguments, called.args, strict=True
            )
        ]
        triple, _name, features = context.codegen().magic_tuple()
        if cuts(triple, features):
            get, set_, rounding = _ON_ARM if is_arm(triple) else _ON_X86
            before = get(builder)
            set_(builder, builder.or_(before, before.type(rounding)))
        status, result = context.call_conv.call_function(
            builder, function, found.fndesc.restype, found.fndesc.argtypes, values
        )
        if cuts(triple, features):
            set_(builder, before)
        with cgutils.if_unlikely(builder, status.is_error):
            context.call_conv.return_status_propagate(builder, status)
        return context.get_dummy_value() if called.return_type == types.void else result

    return called.return_type(leaf, arguments), codegen


def _called(builder, name, returned, *values):
    """What an intrinsic of LLVM returns."""
    function = ir.FunctionType(returned, [value.type for value in values])
    return builder.call(cgutils.get_or_insert_function(builder.module, function, name), values)


def _mxcsr(builder):
    place = cgutils.alloca_once(builder, _WORD)
    _called(builder, "llvm.x86.sse.stmxcsr", ir.VoidType(), builder.bitcast(place, cgutils.voidptr_t))
    return builder.load(place)


def _set_mxcsr(builder, word):
    place = cgutils.alloca_once_value(builder, word)
    _called(builder, "llvm.x86.sse.ldmxcsr", ir.VoidType(), builder.bitcast(place, cgutils.voidptr_t))


def _fpcr(builder):
    return _called(builder, "llvm.aarch64.get.fpcr", _LONG)


def _set_fpcr(builder, word):
    _called(builder, "llvm.aarch64.set.fpcr", ir.VoidType(), word)


# How the control word is read and set, and its field.
_ON_X86 = (_mxcsr, _set_mxcsr, _MXCSR_ROUNDING)
_ON_ARM = (_fpcr, _set_fpcr, _FPCR_ROUNDING)
