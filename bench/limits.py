"""``--cpu``: both parties as on a processor with fewer vector extensions than this one has.

Numba reads its variables when it is imported, and Mesa when it starts, so a limited run is a process of its
own; its kernels lie in a folder of their own beside the others.
"""

import os
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[1]
# Says in a limited process which limit it runs under.
VARIABLE = "FIXEDPIPE_BENCH_CPU"


@dataclass(frozen=True)
class Limit:
    """What a name of ``--cpu`` means.

    needs       of ``processor.LEVELS``, what the processor must have
    ours        the variables by which Numba compiles for it; empty: for the processor as it is
    peer        the variables by which Mesa does
    beyond      how the names of NumPy's dispatched features begin that are switched off for ours
    means       a sentence about each party
    """

    needs: str
    ours: Mapping[str, str]
    peer: Mapping[str, str]
    beyond: tuple[str, ...]
    means: str


# Measured: what Mesa 22.3.6's llvmpipe compiled for scene c, disassembled. On a processor with AVX-512 it
# takes 256 bits by itself, with AVX-512's masks and registers 16 to 31; "avx" leaves AVX2 and FMA without
# these, "sse2" leaves SSE2. With 512 bits its process ends by a signal.
LIMITS = {
    "avx512": Limit(
        "AVX-512",
        {},
        {"LP_NATIVE_VECTOR_WIDTH": "256"},
        (),
        "Ours: all that the processor has, vectors of 512 bits. llvmpipe: vectors of 256 bits, as by itself, "
        "with AVX-512's masks and registers (Mesa 22.3 cannot draw with 512).",
    ),
    "avx2": Limit(
        "AVX2",
        {"NUMBA_CPU_NAME": "haswell", "NUMBA_CPU_FEATURES": "+avx2,+fma"},
        {"LP_NATIVE_VECTOR_WIDTH": "256", "GALLIUM_OVERRIDE_CPU_CAPS": "avx"},
        ("AVX512", "X86_V4"),
        "Ours: code for Haswell, which has AVX2 and no more. llvmpipe: 256 bits, AVX2 and no more.",
    ),
    "generic": Limit(
        "SSE2",
        {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
        {"LP_NATIVE_VECTOR_WIDTH": "128", "GALLIUM_OVERRIDE_CPU_CAPS": "sse2"},
        ("",),
        "Ours: code for every x86-64, which has SSE2 and no more. llvmpipe: 128 bits, SSE2 and no more.",
    ),
}


def refusal(name, processor):
    """Why this processor cannot run under a limit, a sentence; None where it can."""
    needed = LIMITS[name].needs
    if needed in processor.extensions:
        return None
    has = ", ".join(processor.extensions) or "none of them, as far as the system says"
    can = [other for other, limit in LIMITS.items() if limit.needs in processor.extensions]
    rest = f"give {' or '.join(can)}" if can else "leave it out"
    return f"--cpu {name} needs {needed}, and {processor.name} has {has}; {rest}."


def current():
    """The name of the limit that this process runs under, or None."""
    return os.environ.get(VARIABLE) or None


def _dispatched():
    """The features of this processor that NumPy would use beyond its baseline."""
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    return [name for name in __cpu_dispatch__ if __cpu_features__.get(name)]


def variables(name):
    """What a process limited by ``name`` has in its environment; its children inherit it."""
    limit = LIMITS[name]
    off = [feature for feature in _dispatched() if limit.beyond and feature.startswith(limit.beyond)]
    base = os.environ.get("NUMBA_CACHE_DIR") or _ROOT / ".cache"
    found = {VARIABLE: name, "NUMBA_CACHE_DIR": str(Path(base) / f"cpu-{name}"), **limit.ours}
    return found | ({"NPY_DISABLE_CPU_FEATURES": " ".join(off)} if off else {})


def peer_variables():
    """What Mesa's process has in its environment besides, by this process's limit."""
    return dict(LIMITS[current()].peer) if current() else {}


def run_again(name, arguments):
    """Run the same command line limited by ``name``, in a process of its own; returns its exit status."""
    environment = os.environ | variables(name)
    return subprocess.run([sys.executable, "-m", "bench", *arguments], env=environment).returncode
