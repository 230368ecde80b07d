"""Kernels that round toward zero call nothing meanwhile, and nobody else meets their rounding."""

import ast
import importlib
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba.core.registry import cpu_target

from fixedpipe.pipeline.commands import Clear, Draw, Mesh
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import PassState, VertexState, Viewport
from fixedpipe.raster import kernel as kernels
from fixedpipe.raster.kernel import kernel, separate_function
from fixedpipe.raster.vector.rounding import cuts, is_arm, toward_zero

RASTER = Path(kernels.__file__).parent
TRIPLE, _NAME, FEATURES = cpu_target.target_context.codegen().magic_tuple()
needs_cutting = pytest.mark.skipif(not cuts(TRIPLE, FEATURES), reason="AArch64 and x86-64 with FMA alone cut")


class Words(NamedTuple):
    """How a processor's machine code is read: patterns of instructions."""

    comment: str
    leaves: str  # a call, a jump out of the kernel, or an interrupt
    calls: str
    sets: str  # the rounding mode
    neither: str  # computes with floats nor reads the rounding mode
    rounds: str  # floats


X86 = Words(
    comment="#",
    leaves=r"call|j\w+\s+[^.]|syscall|int",
    calls="call",
    sets=r".*ldmxcsr",
    neither=r"call|v?mov|lea|push|vzeroupper|add|sub|xor|test",
    rounds=r"v?(add|sub|mul|div|cvt|fm)\w*[sp][sd]$",
)
ARM = Words(
    comment="//",
    leaves=r"blr?\b|br\b|b(\.\w+)?\s+[^.]|svc|brk",
    calls=r"blr?$",
    sets=r"msr\s+FPCR",
    neither=r"blr?$|f?mov[kznip]?$|adrp?$|ldu?[rp]b?$|stu?[rp]b?$|add$|sub$|orr$|cmp$",
    rounds=r"f(add|sub|n?mul|div|cvt|n?madd|n?msub|ml|rint)|[su]cvtf",
)
WORDS = ARM if is_arm(TRIPLE) else X86


def pairs():
    """Each call of ``toward_zero`` in ``raster/``: the module, the kernel that has it, and its leaf."""
    found = []
    for path in kernels.kernel_sources(RASTER):
        module = ".".join(["fixedpipe.raster", *path.with_suffix("").parts])
        for function in ast.walk(ast.parse((RASTER / path).read_text())):
            if not isinstance(function, ast.FunctionDef):
                continue
            for call in ast.walk(function):
                if isinstance(call, ast.Call) and getattr(call.func, "id", None) == "toward_zero":
                    found.append((module, function.name, call.args[0].id))
    return found


PAIRS = pairs()


def instructions(dispatcher):
    """A kernel's own machine code, line by line: not that of the kernels it calls, or of its wrapper."""
    dispatcher.make_ready()
    (signature,) = dispatcher.signatures
    # Compiled once more, as the cache keeps no text.
    with pytest.warns(RuntimeWarning, match="nopython"):
        again = numba.njit(signature, **dispatcher.targetoptions)(dispatcher.py_func)
    (text,) = again.inspect_asm().values()
    if ".Lfunc_end" not in text:
        pytest.skip("only the assembly of ELF objects is read here; this is another system's")
    start = re.search(rf"^_ZN(?!7cpython)\S*{len(again.__name__)}{again.__name__}\S*:$", text, re.MULTILINE)
    body = text[start.end() : text.index(".Lfunc_end", start.end())]
    lines = (line.split(WORDS.comment)[0].strip() for line in body.splitlines())
    return [line for line in lines if line and not line.startswith(".") and not line.endswith(":")]


def test_some_kernels_round_toward_zero():
    assert len(PAIRS) == len({leaf for _, _, leaf in PAIRS}) >= 2


@needs_cutting
@pytest.mark.parametrize(("module", "name", "leaf"), PAIRS, ids=[leaf for _, _, leaf in PAIRS])
def test_a_leaf_calls_nothing(module, name, leaf):
    code = instructions(getattr(importlib.import_module(module), leaf))
    assert len(code) > 20
    assert not [line for line in code if re.match(WORDS.leaves, line)]


@needs_cutting
@pytest.mark.parametrize(("module", "name", "leaf"), PAIRS, ids=[name for _, name, _ in PAIRS])
def test_while_the_mode_is_set_nothing_but_the_leaf_computes(module, name, leaf):
    code = instructions(getattr(importlib.import_module(module), name))
    set_, restored = (k for k, line in enumerate(code) if re.match(WORDS.sets, line))
    between = [line.split()[0] for line in code[set_ + 1 : restored]]
    assert sum(bool(re.match(WORDS.calls, word)) for word in between) == 1
    assert not [word for word in between if not re.match(WORDS.neither, word)]
    assert not [word for word in between if re.match(WORDS.rounds, word)]


def modes():
    """Whether NumPy and a processor's float64 in this thread round to nearest, up and down alike."""
    one, parts = np.ones(3, np.float32), np.array([3, 5, 7], np.float32)
    nearest = np.array([0x3EAAAAAB, 0x3E4CCCCD, 0x3E124925], np.uint32)
    exact = ((one / parts).view(np.uint32) == nearest).all()
    return bool(exact) and 2.0 / 3.0 == 0.6666666666666666 and 1.0 / 10.0 == 0.1 and 0.1 + 0.2 > 0.3


@kernel("f4(f4,f4)")
def quotient(a, b):
    if b == 0.0:
        raise ZeroDivisionError("asked for")
    return a / b


@kernel("f4(f4,f4)")
def cut_quotient(a, b):
    separate_function()
    return toward_zero(quotient, (a, b))


@kernel("UniTuple(f4,3)(f4,f4)")
def three_quotients(a, b):
    separate_function()
    return quotient(a, b), cut_quotient(a, b), quotient(a, b)


@needs_cutting
def test_a_leaf_cuts_and_its_caller_rounds_to_nearest():
    one, three = np.float32(1), np.float32(3)
    below, nearest = np.uint32(0x3EAAAAAA).view(np.float32), np.uint32(0x3EAAAAAB).view(np.float32)
    assert three_quotients(one, three) == (nearest, below, nearest)
    assert modes()


def test_a_leaf_that_raises_leaves_the_callers_mode():
    for _ in range(3):
        with pytest.raises(ZeroDivisionError, match="asked for"):
            cut_quotient(np.float32(1), np.float32(0))
        assert modes()


def a_frame(seed):
    """A Clear and a Draw of large triangles in perspective, textured by nothing and coloured."""
    random = np.random.default_rng(seed)
    corners = np.concatenate([random.uniform(-1, 1, (60, 3)), np.exp(random.normal(size=(60, 1)))], axis=1)
    corners[:, :3] *= corners[:, 3:]
    mesh = Mesh(corners, indices=np.arange(60), colors=random.uniform(0, 1, (60, 4)))
    state = PassState(vertex=VertexState(viewport=Viewport(0, 0, 128, 128)))
    return Clear(label="clear", color=(0.2, 0.4, 0.6, 0.8)), Draw(label="draw", mesh=mesh, state=state)


def drawn(seed, **options):
    """The bytes of a frame, and whether the thread that drew it rounds to nearest before and after."""
    before = modes()
    result = Machine(GEFORCE_256, 128, 128, **options).run(a_frame(seed))
    return result.framebuffer.color.tobytes(), before and modes()


def test_threads_that_draw_round_to_nearest_and_agree():
    expected = [drawn(seed, engine="portable") for seed in range(4)]
    assert [rounds for _, rounds in expected] == [True] * 4
    for threads in (1, 2):
        with ThreadPoolExecutor(4) as pool:
            assert list(pool.map(lambda seed, n=threads: drawn(seed, threads=n), range(4))) == expected
            assert all(pool.map(lambda _: modes(), range(16)))
    assert modes()


@pytest.mark.parametrize(
    ("triple", "features", "may"),
    [
        ("x86_64-unknown-linux-gnu", "+avx2,+fma", True),
        ("x86_64-unknown-linux-gnu", "", False),
        ("x86_64-unknown-linux-gnu", "+avx,-fma,+fma4", False),
        ("aarch64-unknown-linux-gnu", "-aes,-sve", True),
        ("arm64-apple-darwin", "+neon", True),
        ("riscv64-unknown-linux-gnu", "+fma", False),
    ],
)
def test_processors_that_cut(triple, features, may):
    assert cuts(triple, features) is may
