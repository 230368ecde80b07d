"""Processors that this one can stand for: Numba compiles for them, and NumPy leaves out what is newer."""

import platform
from collections.abc import Mapping
from dataclasses import dataclass

import llvmlite.binding as llvm
from numpy._core import _multiarray_umath as numpy_core

# What NumPy reads when it is imported, and Numba.
NUMPY_LEAVES_OUT = "NPY_DISABLE_CPU_FEATURES"
NUMBA_COMPILES_FOR, NUMBA_FEATURES = "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"
_X86 = ("x86_64", "AMD64")

_NEHALEM = ("cx16", "popcnt", "sse4.2", "ssse3")
_HASWELL = (*_NEHALEM, "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")
_SKYLAKE = (*_HASWELL, "adx", "avx512bw", "avx512cd", "avx512dq", "avx512f", "avx512vl", "clflushopt")
_ZEN_4 = (
    *_SKYLAKE, "avx512bf16", "avx512bitalg", "avx512ifma", "avx512vbmi", "avx512vbmi2", "avx512vnni",
    "avx512vpopcntdq", "gfni", "sha", "sse4a", "vaes", "vpclmulqdq",
)  # fmt: skip


@dataclass(frozen=True)
class Processor:
    """One that LLVM knows. ``needs``: of LLVM's features, those whose instructions its code may have."""

    name: str
    needs: tuple[str, ...]

    def lacking(self, features: Mapping[str, bool]) -> list[str]:
        """Which of them are not among the features that hold."""
        return [name for name in self.needs if not features.get(name)]

    def environment(self) -> dict[str, str]:
        """The variables by which a process compiles for it, and NumPy runs its plainest code."""
        features = {NUMBA_COMPILES_FOR: self.name, NUMBA_FEATURES: ""}
        return features | numpy_without_extensions()


# Source: LLVM's X86.td, the features of x86-64, nehalem, haswell, skylake-avx512 and znver4 that its code
# generator chooses by itself.
PROCESSORS = (
    Processor("generic", ()),
    Processor("nehalem", _NEHALEM),
    Processor("haswell", _HASWELL),
    Processor("skylake-avx512", _SKYLAKE),
    Processor("znver4", _ZEN_4),
)


def processors() -> tuple[Processor, ...]:
    """Those that can be asked for on this architecture: LLVM has others' names for others."""
    return PROCESSORS if platform.machine() in _X86 else PROCESSORS[:1]


def processor_features() -> dict[str, bool]:
    """What this processor has, by LLVM's names."""
    return dict(llvm.get_host_cpu_features())


def numpy_extensions() -> list[str]:
    """What NumPy uses of this processor beyond what it was built for, by its names."""
    return [name for name in numpy_core.__cpu_dispatch__ if numpy_core.__cpu_features__.get(name)]


def numpy_without_extensions() -> dict[str, str]:
    """The variable by which a process leaves them out; none where there are none."""
    extensions = numpy_extensions()
    return {NUMPY_LEAVES_OUT: " ".join(extensions)} if extensions else {}
