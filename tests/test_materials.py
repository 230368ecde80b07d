"""Material textures and their authoring functions (K21)."""

from dataclasses import replace

import numpy as np
import pytest

from effects import anisotropic_blinn_phong, material_textures
from pipeline.profiles import GEFORCE_256, IDEAL

# ---------------------------------------------------------------------------------------------- the exponent


def test_the_exponent_is_stored_in_the_binormals_alpha():
    flat = material_textures.isotropic(4, 2, 0.5)
    assert (flat.exponent == 2.0).all()
    assert (flat.binormal_texture(GEFORCE_256).levels[0][0, ..., 3] == 4).all()
    exponent = np.array([[1.0, 2.0, 64.0, 128.0]] * 2)
    varied = replace(flat, exponent=exponent)
    stored = varied.binormal_texture(GEFORCE_256).levels[0][0, ..., 3]
    assert stored[0].tolist() == [2, 4, 128, 255]
    assert (varied.binormal_texture(IDEAL).ideal[0][0, ..., 3] == exponent / 128.0).all()


@pytest.mark.parametrize("exponent", [0.5, 129.0, np.nan])
def test_an_exponent_outside_its_range_is_refused(exponent):
    with pytest.raises(ValueError, match="give values from 1 to 128"):
        replace(material_textures.isotropic(4, 4, 0.5), exponent=exponent)


def test_baking_keeps_the_exponent():
    flat = replace(material_textures.isotropic(2, 2, 0.5), exponent=9.0)
    axes = (np.broadcast_to(row, (2, 2, 3)) for row in np.eye(3)[[2, 0, 1]])
    assert (anisotropic_blinn_phong.bake(flat, *axes).exponent == 9.0).all()
