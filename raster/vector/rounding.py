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

_ROUNDING = 0x6000  # of MXCSR: the field of the rounding mode; all of it set: toward zero


def cuts(triple, features):
    """Whether code for a processor may use ``toward_zero``: x86-64 with a fused product and sum.

    Without one the rests that leaves compute would be calls of a library, and elsewhere than on x86-64 the
    mode is set in another way.
    """
    return triple.startswith("x86_64") and "+fma" in features.split(",")


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
            before, during = (cgutils.alloca_once(builder, ir.IntType(32)) for _ in range(2))
            _control(builder, "llvm.x86.sse.stmxcsr", before)
            mode = builder.or_(builder.load(before), ir.Constant(ir.IntType(32), _ROUNDING))
            builder.store(mode, during)
            _control(builder, "llvm.x86.sse.ldmxcsr", during)
        status, result = context.call_conv.call_function(
            builder, function, found.fndesc.restype, found.fndesc.argtypes, values
        )
        if cuts(triple, features):
            _control(builder, "llvm.x86.sse.ldmxcsr", before)
        with cgutils.if_unlikely(builder, status.is_error):
            context.call_conv.return_status_propagate(builder, status)
        return context.get_dummy_value() if called.return_type == types.void else result

    return called.return_type(leaf, arguments), codegen


def _control(builder, name, word):
    """Store the mode in a word, or take it from there."""
    pointer = builder.bitcast(word, ir.IntType(8).as_pointer())
    function = ir.FunctionType(ir.VoidType(), [pointer.type])
    builder.call(cgutils.get_or_insert_function(builder.module, function, name), [pointer])
