"""The coordinates at which a rounded fog factor changes, against OpenGL 1.2.1's equations 3.17 to 3.19."""

from dataclasses import replace
from decimal import Decimal, localcontext

import numpy as np
import pytest

from fixedpipe.pipeline.enums import FogMode
from fixedpipe.pipeline.programs.fog import fog_thresholds
from fixedpipe.pipeline.state import Fog


@pytest.mark.parametrize("one", [255, 4095])
@pytest.mark.parametrize("mode", [FogMode.EXP, FogMode.EXP2])
def test_thresholds_of_exponents_are_the_nearest_floats(mode, one):
    found = fog_thresholds(Fog(mode, density=0.75), one)
    assert found.shape == (one,)
    with localcontext() as context:
        context.prec = 60
        for k in (1, 2, one // 3, one // 2, one - 1, one):
            distance = -((Decimal(k) - Decimal("0.5")) / one).ln()
            distance = distance.sqrt() if mode is FogMode.EXP2 else distance
            assert found[k - 1] == float(distance / Decimal("0.75")), k


def test_thresholds_of_linear_fog_lie_between_end_and_start():
    found = fog_thresholds(Fog(FogMode.LINEAR, start=1.0, end=5.0), 4)
    assert found.tolist() == [4.5, 3.5, 2.5, 1.5]


def test_fog_without_density_never_changes():
    assert (fog_thresholds(Fog(FogMode.EXP2, density=0.0)) == np.inf).all()


def test_thresholds_are_shared_so_they_are_not_written_to():
    found = fog_thresholds(Fog(FogMode.EXP))
    assert found is fog_thresholds(Fog(FogMode.EXP)) and not found.flags.writeable


def test_what_is_no_mode_is_refused():
    with pytest.raises(ValueError, match="'EXP3' is no fog mode"):
        fog_thresholds(replace(Fog(FogMode.EXP), mode="EXP3"))
