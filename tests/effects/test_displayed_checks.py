"""What every figure's displayed picture is asked: the panels that are like the reference, parts, letters."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.seen_places import of_reference
from fixedpipe.effects.figures import FIGURES, Renderer
from fixedpipe.effects.figures.displayed_checks import displayed_checks
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import PROFILES

FIGURE = FIGURES["H11"]


def checks_of(figure, machine):
    return list(
        displayed_checks(figure, Renderer(PROFILES[machine], figure.method(machine), execute, execute_ideal))
    )


def test_a_compared_panel_shows_what_the_reference_has():
    found = [check for check in checks_of(FIGURE, "OPENGL_1_2") if "reference" in check.name]
    assert [check.on for check in found] == [Answer.MACHINE, Answer.IDEAL]
    assert all(check.passed for check in found)


def test_another_reference_is_refused():
    def darker(size, **values):
        picture = np.array(FIGURE.reference(size, **values))
        picture[..., :3] *= 0.5
        return picture

    found = checks_of(replace(FIGURE, reference=darker), "OPENGL_1_2")
    assert all(not check.passed for check in found if "reference" in check.name)


def test_compared_panels_are_as_wide_as_the_figure_s_aspect_says():
    figure = FIGURES["F001-11"]
    height, width = 12, figure.panel_width(12)

    def numbered(size, **values):
        row = np.repeat(np.arange(figure.columns), width) / 4.0
        return np.ones((size, len(row), 4)) * np.stack([row, row, row, np.ones(len(row))], axis=-1)

    assert width != height
    small = replace(figure, size=height, reference=numbered)
    (where, colors), *others = of_reference(small, small.methods[0]).values()
    assert where.shape == (height, width) and not others
    assert np.unique(colors).tolist() == [(figure.compared[0] - 1) / 4.0]


def test_parts_are_left_out_on_the_first_machine_of_a_method_alone():
    first, *others = FIGURE.method("OPENGL_1_2").machines
    assert any("parts" in check.name for check in checks_of(FIGURE, first))
    assert not any("parts" in check.name for check in checks_of(FIGURE, others[0]))


def test_a_reference_is_computed_once_and_not_written_to():
    counted = []

    def reference(size, **values):
        counted.append(size)
        return FIGURE.reference(size, **values)

    figure = replace(FIGURE, reference=reference)
    pictures = [figure.reference_picture(16), figure.reference_picture(16), figure.reference_picture(8)]
    assert counted == [16, 8]
    assert pictures[0] is pictures[1]
    with pytest.raises(ValueError, match="read-only"):
        pictures[0][:] = 0.0


def test_a_reference_with_other_values_is_computed_each_time():
    name, *_ = (name for name, parameter in FIGURE.parameters.items() if parameter.offered)
    value = FIGURE.values[name]
    pictures = [FIGURE.reference_picture(16, **{name: value}) for _ in range(2)]
    assert pictures[0] is not pictures[1]
    np.testing.assert_array_equal(*pictures)


@pytest.mark.parametrize("compared", [(0,), (5,), (1, 5)])
def test_a_panel_that_is_not_there_cannot_be_compared(compared):
    with pytest.raises(ValueError, match="name panels from 1 to 4"):
        replace(FIGURE, compared=compared)


def test_without_a_reference_nothing_can_be_compared():
    with pytest.raises(ValueError, match="give it a reference"):
        replace(FIGURE, reference=None)
