"""One digest for any processor, thread count and batch size; and no fused multiply-add in any kernel
that does not ask for one.
"""

import os
from pathlib import Path

import numpy as np
import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.raster.kernel_levels import LEVELS, ON_X86
from tests.support.processes import output_of
from tests.support.sample import sampled_figures

ROOT = Path(__file__).parents[2]
AVX2 = LEVELS[1].environment()
# NumPy's loops for newer processors; disabling them leaves the plain ones (their sin, exp and pow may
# differ).
_CORE = np._core._multiarray_umath
NUMPY_EXTRAS = " ".join(f for f in _CORE.__cpu_dispatch__ if _CORE.__cpu_features__.get(f))


CHOICES = "1:1024", "2:1024", "3:17"  # threads and batches


def run(*options, **environment):
    """The lines that ``python -m tests.support.bits`` prints."""
    return output_of("tests.support.bits", *options, **environment).split("\n")


@pytest.fixture(scope="module", params=["some", pytest.param("others", marks=pytest.mark.slow)])
def figures(request):
    """The ids of a share of the figures, another with each change; of all others, where all is proved."""
    some = sampled_figures()
    return sorted(some if request.param == "some" else FIGURES.keys() - some)


@pytest.fixture(scope="module")
def found(figures):
    """The digests of CHOICES: by one process, which makes meshes and textures once for all of them."""
    return run(*CHOICES, *figures)[0].split()


@pytest.fixture(scope="module")
def native(found):
    """The digest on this processor."""
    return found[0]


def test_threads_and_batches_do_not_change_a_bit(found):
    assert found == [found[0]] * len(CHOICES)


# Machine code for another processor is compiled once for a state of raster/, and kept beside the native one.
# The code for any processor, and the instructions of every kernel, are looked at where all is.


def often_beside_avx512(test):
    """Every time on a processor with AVX-512. Where there is none, the native code has AVX2's instructions
    already, and the test is slow.
    """
    return pytest.mark.slow(test) if LEVELS[0].lacking() else test


@pytest.mark.slow
def test_a_plain_processor_gives_the_same_bits(figures, native):
    generic = {**LEVELS[-1].environment(), "NPY_DISABLE_CPU_FEATURES": NUMPY_EXTRAS}
    assert run("1:1024", *figures, **generic)[0] == native


@often_beside_avx512
@pytest.mark.skipif(not ON_X86, reason="AVX2 is an x86 feature")
def test_avx2_gives_the_same_bits(figures, native):
    assert run("2:256", *figures, **AVX2)[0] == native


@pytest.mark.slow
@pytest.mark.skipif(not ON_X86, reason="AVX2 is an x86 feature")
def test_kernels_fuse_only_what_they_ask_for(tmp_path):
    # A folder of its own: machine code can be read back only where this very process made it.
    _, counts, *_ = run("2:256", *FIGURES, "--assembly", **AVX2, NUMBA_CACHE_DIR=str(tmp_path))
    kernels, lines, fused, asked = map(int, counts.split())
    assert kernels >= 50
    assert lines >= 10_000
    assert fused == 0
    assert asked >= 3


FUSING = """
from fixedpipe.raster.kernel import kernel
from tests.support.bits import FUSED

@kernel(in_loops=True)
def longer(a, b, c):
    return a * b + c

@kernel(inlined=True)
def copied(a, b, c):
    return a * b - c

@kernel("f8(f8[::1],f8,f8)")
def added(x, b, c):
    total = 0.0
    for k in range(x.size):
        total += longer(x[k], b, c) * copied(x[k], b, c) + x[k] * x[k]
    return total

added.make_ready()
(text,) = added.inspect_asm().values()
print(text.count("vmulsd") + text.count("vmulpd") > 0, len(FUSED.findall(text)))
"""


@pytest.mark.skipif(not ON_X86, reason="AVX2 is an x86 feature")
def test_no_way_to_write_a_kernel_lets_the_compiler_fuse_a_product_and_a_sum(tmp_path):
    """One small kernel of all ways, whose settings are those of every other."""
    (tmp_path / "fusing.py").write_text(FUSING)
    folders = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}"}
    assert output_of("fusing", **AVX2, **folders).split() == ["True", "0"]
