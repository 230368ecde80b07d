"""Levels of x86-64 processors: a kernel that is compiled for a level runs on every processor that has it.

Numba compiles for the very processor that it finds. Such kernels cannot be shipped. The bits are the same
on every level.
"""

import platform
from dataclasses import dataclass
from functools import cache

import llvmlite.binding as llvm
import numba

ON_X86 = platform.machine() in ("x86_64", "AMD64")
# Source: LLVM's X86.td, the features of haswell and skylake-avx512 that its code generator chooses by itself.
NEHALEM = ("cx16", "popcnt", "sse4.2", "ssse3")
HASWELL = (*NEHALEM, "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")
SKYLAKE_X = (*HASWELL, "adx", "avx512bw", "avx512cd", "avx512dq", "avx512f", "avx512vl", "clflushopt")


@dataclass(frozen=True)
class Level:
    """What Numba is told to compile for, and the LLVM features that its code may use."""

    name: str
    processor: str
    features: str
    needs: tuple[str, ...]

    def environment(self):
        """The variables by which a process compiles for it."""
        return {"NUMBA_CPU_NAME": self.processor, "NUMBA_CPU_FEATURES": self.features}

    def is_compiled_for(self):
        """Whether this process compiles for it."""
        return (self.processor, self.features) == (numba.config.CPU_NAME, numba.config.CPU_FEATURES)

    def lacking(self):
        """The needed features that this processor has not."""
        has = _features()
        return [name for name in self.needs if not has.get(name)]


# The best first. LLVM would not use the registers of 512 bits of skylake-avx512, which were slow on the first
# processors that had them.
LEVELS = (
    Level("x86-64-v4", "skylake-avx512", "-prefer-256-bit", SKYLAKE_X),
    Level("x86-64-v3", "haswell", "+avx2,+fma", HASWELL),
    Level("x86-64", "generic", "", ()),
)


@cache
def _features():
    return dict(llvm.get_host_cpu_features())


@cache
def levels_here():
    """The levels whose kernels this process may run: the best first; none beside x86-64.

    There is none either where somebody named the processor to compile for. Then its kernels are wanted.
    """
    if not ON_X86 or numba.config.CPU_NAME or numba.config.CPU_FEATURES:
        return ()
    return tuple(level for level in LEVELS if not level.lacking())
