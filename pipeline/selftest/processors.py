"""Processors that this one can imitate: Numba compiles for them, and NumPy omits newer extensions."""

from collections.abc import Mapping
from dataclasses import dataclass

import llvmlite.binding as llvm
from numpy._core import _multiarray_umath as numpy_core

from fixedpipe.raster.kernel_levels import HASWELL, NEHALEM, ON_X86, SKYLAKE_X

# The variables that NumPy and Numba read when they are imported.
NUMPY_LEAVES_OUT = "NPY_DISABLE_CPU_FEATURES"
NUMBA_COMPILES_FOR, NUMBA_FEATURES = "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"

_ZEN_4 = (
    *SKYLAKE_X,
    *("avx512bf16", "avx512bitalg", "avx512ifma", "avx512vbmi", "avx512vbmi2", "avx512vnni"),
    *("avx512vpopcntdq", "gfni", "sha", "sse4a", "vaes", "vpclmulqdq"),
)


@dataclass(frozen=True)
class Processor:
    """A processor that LLVM knows. ``needs``: the LLVM features whose instructions its code may use."""

    name: str
    needs: tuple[str, ...]

    def lacking(self, features: Mapping[str, bool]) -> list[str]:
        """The needed features that are not available."""
        return [name for name in self.needs if not features.get(name)]

    def environment(self) -> dict[str, str]:
        """The variables by which a process compiles for it, and NumPy runs its plainest code."""
        features = {NUMBA_COMPILES_FOR: self.name, NUMBA_FEATURES: ""}
        return features | numpy_without_extensions()


# Source: LLVM's X86.td, the features of x86-64, nehalem, haswell, skylake-avx512 and znver4 that its code
# generator chooses by itself.
PROCESSORS = (
    Processor("generic", ()),
    Processor("nehalem", NEHALEM),
    Processor("haswell", HASWELL),
    Processor("skylake-avx512", SKYLAKE_X),
    Processor("znver4", _ZEN_4),
)


def processors() -> tuple[Processor, ...]:
    """The processors that can be imitated here; beside x86 only the first, for LLVM has other names there."""
    return PROCESSORS if ON_X86 else PROCESSORS[:1]


def processor_features() -> dict[str, bool]:
    """The features of this processor, by LLVM's names."""
    return dict(llvm.get_host_cpu_features())


def numpy_extensions() -> list[str]:
    """The extensions of this processor that NumPy uses beyond its build, by its names."""
    return [name for name in numpy_core.__cpu_dispatch__ if numpy_core.__cpu_features__.get(name)]


def numpy_without_extensions() -> dict[str, str]:
    """The variable by which a process omits them; empty where there are none."""
    extensions = numpy_extensions()
    return {NUMPY_LEAVES_OUT: " ".join(extensions)} if extensions else {}
