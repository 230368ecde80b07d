"""Bump_env_lum: a bump texture in every format offsets a checkerboard and scales its luminance.

Source: src/tests/bump_env_lum_tests.cpp of nxdk_pgraph_tests.
"""

from fixedpipe.effects.conformance import bump_quads
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import SignedComponents

SUITE = "Bump_env_lum"

FORMATS = bump_quads.formats(without=())
VARIED = ("R6G5B5", "X8R8G8B8")
CASES = {
    **{f"BumpEnvLum_{name}": (name, False, False) for name in FORMATS},
    **{
        f"BumpEnvLum_{ending}": (name, *switches)
        for name in VARIED
        for ending, switches in bump_quads.variants(name).items()
    },
}
COLORS = (0x7F014500, 0x80034500, 0x7F014500, 0x80034500)
CROSSED = (0x00017F00, 0x00017F00, 0xFF038000, 0xFF038000)
MATRIX, TURNED = (0.3, 0.0, 5.0, 0.0), (0.0, -0.1, 0.0, 0.3)  # columns


def names():
    """Every case of the suite."""
    return list(CASES)


def _signs(column, row):
    return SignedComponents(red=column, green=row, blue=column)


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in CASES:
        return None
    form, crossed, turned = CASES[name]
    return bump_quads.offset_case(
        CROSSED if crossed else COLORS,
        FORMATS[form],
        Operation.OFFSET_TEXTURE_2D_SCALE,
        TURNED if turned else MATRIX,
        _signs,
        (0x7F0000FE, 0x7F202122),
        offset_texture_scale=0.7,
        offset_texture_bias=0.3,
    )
