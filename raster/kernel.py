"""The one decorator of every kernel, and the two promises that a loop kernel can make to the compiler.

Numba's on-disk cache watches only the file a kernel is written in, not the kernels it calls in other files,
so an edit could go unnoticed. The cache folder is therefore named after a digest of every source in
``raster/`` that a kernel may be made of (and of the settings that change the code but not the sources).
"""

import hashlib
import inspect
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import llvmlite
import numba
from llvmlite import ir
from numba import types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.runtime import rtsys
from numba.extending import intrinsic

from fixedpipe.raster.kernel_files import KernelCache
from fixedpipe.raster.kernel_folder import kernel_folder, mirror_folder, other_folders
from fixedpipe.raster.kernel_packs import packs_in

try:
    import fcntl
except ImportError:  # where files are locked in another way
    fcntl = None

_SOURCES = Path(__file__).parent
# Pure NumPy code, the tracing hooks, and the places of kernels' files. No kernel is made of them, so an edit
# of these makes none stale.
_WITHOUT_KERNELS = {
    *("columns", "pixels", "observer.py"),
    *("kernel_files.py", "kernel_folder.py", "kernel_levels.py", "kernel_packs.py"),
}


def kernel_sources(folder):
    """Paths of all sources whose edit may change a kernel: relative to their folder, in the same order on
    every machine.
    """
    paths = (path.relative_to(folder) for path in folder.rglob("*.py"))
    return sorted((path for path in paths if path.parts[0] not in _WITHOUT_KERNELS), key=Path.as_posix)


def source_digest(folder):
    """The name of the cache folder for kernels that are made from a folder of sources."""
    digest = hashlib.sha256(f"{numba.__version__} {llvmlite.__version__}".encode())
    for path in kernel_sources(folder):
        digest.update(path.as_posix().encode())
        digest.update((folder / path).read_bytes())
    digest.update(repr((numba.config.BOUNDSCHECK, numba.config.OPT)).encode())
    return digest.hexdigest()[:16]


STATE = source_digest(_SOURCES)
CACHE_FOLDER = kernel_folder(STATE)
_OTHERS = tuple(folder for folder in other_folders(STATE) if folder != CACHE_FOLDER)
_MIRROR = mirror_folder(STATE, CACHE_FOLDER)
# Where packs lie: beside kernels, and in an installed package that was shipped with them.
_PACKS = (CACHE_FOLDER, *_OTHERS, *((_SOURCES / "packs",) if _OTHERS else ()))
_of_one_signature = []  # kernels of the modules that are imported
_caches = []  # of all kernels of the modules that are imported


def kernel(signature=None, *, allocates=False, inlined=False, in_loops=False):
    """Compile to machine code: ``@kernel`` or ``@kernel("signature")``.

    No ``fastmath``: it would let LLVM reorder sums and fuse multiply-adds, and either changes bits. ``numpy``
    error model: a division by zero gives infinity instead of raising. ``nogil``: bands run in threads.
    Only a kernel that makes arrays (``allocates``) counts references: the others borrow what they are given,
    and the atomic counting of every slice would cost a batch more than its arithmetic.
    ``inlined``: a step of the kernels that call it. Numba copies its statements into each of them and never
    compiles it alone. So a long kernel is written as short steps, and its machine code is that of one.
    ``in_loops``: a function of numbers for loops over arrays. LLVM puts its code into each loop, however long
    it is, because a loop with a call is not vectorized.
    """
    options = {"fastmath": False, "error_model": "numpy", "nogil": True, "_nrt": allocates}
    options["inline"] = "always" if inlined else "never"
    options["forceinline"] = in_loops
    if inspect.isfunction(signature):
        return _compiled_by_one_process(numba.njit(signature, **options))

    def decorate(function):
        dispatcher = _compiled_by_one_process(numba.njit(function, **options))
        return dispatcher if signature is None else _compiled_when_called(dispatcher, signature)

    return decorate


def _compiled_by_one_process(dispatcher):
    """A kernel that one process compiles at a time. The others wait, and then read it from the cache.

    No process waits forever. While it compiles a kernel, it waits only for the kernels that this one calls,
    and no kernel calls itself, directly or through others. A process that ends releases its locks.
    """
    compile_it, function = dispatcher.compile, dispatcher.py_func
    dispatcher._cache = KernelCache(function, CACHE_FOLDER, _OTHERS, _MIRROR, packs)
    _caches.append(dispatcher._cache)
    lock = CACHE_FOLDER / f"{function.__module__}.{function.__qualname__}.lock"

    def compile_alone(signature):
        """As ``Dispatcher.compile``, which looks into the cache first: under the lock."""
        with global_compiler_lock, _locked(lock):
            return compile_it(signature)

    dispatcher.compile = compile_alone
    return dispatcher


@contextmanager
def _locked(path):
    """One process at a time is inside for each path; any number where files cannot be locked."""
    with ExitStack() as held:
        with suppress(OSError):  # a file system without locks, or a file of another user
            if fcntl is not None:
                fcntl.flock(held.enter_context(path.open("w")), fcntl.LOCK_EX)
        yield


def _compiled_when_called(dispatcher, signature):
    """A kernel of one signature that is compiled, or read from the cache, when Python or the compilation of
    another kernel first calls it. A kernel that only cached kernels call is never looked at.

    ``is_ready()`` tells whether a call would wait for a compiler; ``make_ready()`` compiles it.
    """

    def read():
        if not dispatcher.overloads and _was_read(dispatcher, signature):
            dispatcher.disable_compile()
        return bool(dispatcher.overloads)

    def is_ready():
        """Whether it can be called without a compiler: it was, or the cache has it."""
        with global_compiler_lock:
            return read()

    def compiled():
        with global_compiler_lock:
            if not read():
                dispatcher.compile(signature)
                dispatcher.disable_compile()

    def get_call_template(args, keywords):
        compiled()
        return type(dispatcher).get_call_template(dispatcher, args, keywords)

    def compile_for_args(*args):
        """The entry point, as Numba asks for it when no compiled kernel takes the arguments of a call."""
        compiled()
        (found,) = dispatcher.overloads.values()
        given = [dispatcher.typeof_pyval(a) for a in args]
        converts = dispatcher.typingctx.can_convert
        wanted = found.signature.args
        if len(given) != len(wanted) or None in map(converts, given, wanted):
            raise TypeError(f"{dispatcher.py_func.__name__} takes {wanted}, not {tuple(given)}.")
        return found.entry_point

    dispatcher.get_call_template, dispatcher._compile_for_args = get_call_template, compile_for_args
    dispatcher.is_ready, dispatcher.make_ready = is_ready, compiled
    _of_one_signature.append(dispatcher)
    return dispatcher


def make_all_ready():
    """Compile each kernel of one signature that the cache lacks, of the modules that are imported, and all
    that they call.
    """
    for dispatcher in _of_one_signature:
        dispatcher.make_ready()


def _was_read(dispatcher, signature):
    """Give a dispatcher its kernel from the cache; returns whether the cache has it.

    As ``Dispatcher.compile`` does, but Numba's implementations of Python's and NumPy's functions, which only
    compiling needs, are not imported first: they are half as much again as Numba itself.
    """
    target, cache = dispatcher.targetctx, dispatcher._cache
    rtsys.initialize(target)
    found = cache._load_overload(signature, target)
    if found is None:
        return False
    target.insert_user_function(found.entry_point, found.fndesc, [found.library])
    dispatcher.add_overload(found)
    return True


def packs():
    """The packs of kernels that fit here."""
    return packs_in(_PACKS, STATE)[0]


def refused_packs():
    """A sentence for each pack that lies where packs are looked for, and is of no use here."""
    return packs_in(_PACKS, STATE)[1]


def compiled_for(level):
    """(name, key, pickled bytes) of each kernel of the imported modules that is kept for a Level."""
    return [
        (cache.name, key, data)
        for cache in _caches
        for key, data in cache.kept_for(level.processor, level.features)
    ]


def is_cold():
    """Whether the kernels of these sources have never been compiled on this machine, nor shipped to it."""
    return not packs() and not any(any(folder.rglob("*.nbc")) for folder in (CACHE_FOLDER, *_OTHERS))


@intrinsic
def separate_loop(typing_context):
    """Promise, as a kernel's first statement: no two of its array arguments overlap; keep it a function.

    Without the promise LLVM gives up on loops over many arrays; without the second part every caller would
    compile the loop again.
    """

    def codegen(context, builder, signature, args):
        function = builder.function
        function.attributes.add("noinline")
        for argument in function.args[2:]:  # 0 and 1: return value and exception
            if isinstance(argument.type, ir.PointerType):
                argument.add_attribute("noalias")
        return context.get_dummy_value()

    return types.void(), codegen


@intrinsic
def separate_function(typing_context):
    """Promise, as a kernel's first statement: keep it a function of its own (compile time)."""

    def codegen(context, builder, signature, args):
        builder.function.attributes.add("noinline")
        return context.get_dummy_value()

    return types.void(), codegen


@intrinsic
def bits_of(typing_context, value):
    """The bit pattern of a float64 as int64."""
    if value != types.float64:
        raise TypeError("bits_of takes a float64")

    def codegen(context, builder, signature, args):
        return builder.bitcast(args[0], ir.IntType(64))

    return types.int64(types.float64), codegen


@intrinsic
def float_of(typing_context, value):
    """The float64 with the bit pattern of an int64."""
    if value != types.int64:
        raise TypeError("float_of takes an int64")

    def codegen(context, builder, signature, args):
        return builder.bitcast(args[0], ir.DoubleType())

    return types.float64(types.int64), codegen


@intrinsic
def next_of(typing_context, counter):
    """Take the number in ``counter`` int64[1] and leave the next one; threads never take the same."""

    def codegen(context, builder, signature, args):
        data = context.make_array(counter)(context, builder, args[0]).data
        return builder.atomic_rmw("add", data, ir.Constant(ir.IntType(64), 1), "seq_cst")

    return types.int64(counter), codegen
