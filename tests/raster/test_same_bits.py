"""One digest for any processor, thread count and batch size; and no fused multiply-add in any kernel
that does not ask for one.
"""

import platform

import numpy as np
import pytest

from tests.support.processes import output_of

ON_X86 = platform.machine().lower() in ("x86_64", "amd64")
# NumPy's loops for newer processors; disabling them leaves the plain ones (their sin, exp and pow may
# differ).
_CORE = np._core._multiarray_umath
NUMPY_EXTRAS = " ".join(f for f in _CORE.__cpu_dispatch__ if _CORE.__cpu_features__.get(f))


CHOICES = "1:1024", "2:1024", "3:17"  # threads and batches


def run(*options, **environment):
    """The lines that ``python -m tests.support.bits`` prints."""
    return output_of("tests.support.bits", *options, **environment).split("\n")


@pytest.fixture(scope="module")
def found():
    """The digests of CHOICES: by one process, which makes meshes and textures once for all of them."""
    return run(*CHOICES)[0].split()


@pytest.fixture(scope="module")
def native(found):
    """The digest on this processor."""
    return found[0]


def test_threads_and_batches_do_not_change_a_bit(found):
    assert found == [found[0]] * len(CHOICES)


# Each of the next two compiles every kernel, for a minute or more. That AVX2's code gives the same bits, and
# fuses what kernels ask for alone, is looked at every time; the code for any processor where all is.


@pytest.mark.slow
def test_a_plain_processor_gives_the_same_bits(native):
    generic = {
        "NUMBA_CPU_NAME": "generic",
        "NUMBA_CPU_FEATURES": "",
        "NPY_DISABLE_CPU_FEATURES": NUMPY_EXTRAS,
    }
    assert run("1:1024", **generic)[0] == native


@pytest.mark.skipif(not ON_X86, reason="AVX2 is an x86 feature")
def test_avx2_gives_the_same_bits_and_kernels_fuse_only_what_they_ask_for(native, tmp_path):
    # A folder of its own: machine code can be read back only where this very process made it.
    haswell = {
        "NUMBA_CPU_NAME": "haswell",
        "NUMBA_CPU_FEATURES": "+avx2,+fma",
        "NUMBA_CACHE_DIR": str(tmp_path),
    }
    digest, counts, *_ = run("2:256", "--assembly", **haswell)
    kernels, lines, fused, asked = map(int, counts.split())
    assert digest == native
    assert kernels >= 50
    assert lines >= 10_000
    assert fused == 0
    assert asked >= 3
