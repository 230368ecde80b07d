"""Bump_env_lum: a bump texture in every format offsets a checkerboard and scales its luminance.

Source: src/tests/bump_env_lum_tests.cpp of nxdk_pgraph_tests.
"""

from functools import partial

from fixedpipe.effects.conformance import bump_quads
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import SignedComponents

SUITE = "Bump_env_lum"

FORMATS = bump_quads.formats(without=())
VARIED = ("R6G5B5", "X8R8G8B8")
COLORS = (0x7F014500, 0x80034500, 0x7F014500, 0x80034500)
CROSSED = (0x00017F00, 0x00017F00, 0xFF038000, 0xFF038000)
MATRIX, TURNED = (0.3, 0.0, 5.0, 0.0), (0.0, -0.1, 0.0, 0.3)  # columns


def _signs(column, row):
    return SignedComponents(red=column, green=row, blue=column)


def _case(form, crossed=False, turned=False):
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


CASES = {
    **{f"BumpEnvLum_{form}": partial(_case, form) for form in FORMATS},
    **{
        f"BumpEnvLum_{ending}": partial(_case, form, *switches)
        for form in VARIED
        for ending, switches in bump_quads.variants(form).items()
    },
}
