"""The pictures of a figure's passes: which commands are looked at, and which pictures stay."""

import numpy as np
import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.reports.figure_passes import MOST, Passes
from fixedpipe.pipeline.commands import Clear, ReadPixels, TexImage
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_256

SIZE = 8


def clear(grey, label=None):
    return Clear(label=label or f"to {grey}", color=(grey / 255,) * 3 + (1.0,))


def passes_of(commands, size=SIZE):
    passes = Passes(commands, (size, size))
    taken = []

    def watch(command, take):
        passes(command, lambda: taken.append(command.label) or take())

    result = execute(commands, GEFORCE_256, size, size, trace=watch)
    return passes.passes(result.image()), taken, result


def greys(passes):
    return [int(one.picture[0, 0, 0]) for one in passes]


def test_every_pass_that_shows_something_has_a_picture_and_the_last_is_the_finished_one():
    commands = (clear(0, "first"), clear(9), clear(9, "again"), clear(50), clear(50, "end"))
    passes, taken, result = passes_of(commands)
    assert [(p.number, p.label, p.commands) for p in passes] == [
        (1, "to 9", ("Clear: first", "Clear: to 9")),
        (3, "to 50", ("Clear: again", "Clear: to 50", "Clear: end")),
    ]
    assert greys(passes) == [9, 50] and taken == ["first", "to 9", "again", "to 50", "end"]
    np.testing.assert_array_equal(passes[-1].picture, result.image())


def test_of_many_those_stay_that_change_most():
    """Twelve large steps, and steps of one level between them: what comes before a large step stays."""
    large = [20 * n for n in range(1, MOST + 1)]
    passes, _, _ = passes_of(tuple(clear(level + small) for level in large for small in (0, 1, 2)))
    assert greys(passes) == [level + 2 for level in large]


def test_thousands_of_commands_are_looked_at_a_few_times():
    """Two thousand draws; the finished picture is the last though it is not looked at."""
    commands = tuple(clear(n % 200 + 20) for n in range(2001))
    passes, taken, result = passes_of(commands)
    assert len(taken) <= 48 and len(passes) == MOST
    assert passes[-1].number == 2000
    np.testing.assert_array_equal(passes[-1].picture, result.image())
    assert all(len(one.commands) <= 25 for one in passes)


def test_what_draws_nothing_is_named_and_has_no_picture():
    figure = FIGURES["K14"]
    passes = []

    def watch(commands):
        passes.append(Passes(commands, (32, 32)))
        return passes[0]

    drawn = figure.render("GEFORCE_256", 32, watch=watch)
    np.testing.assert_array_equal(drawn.image(), figure.render("GEFORCE_256", 32).image())
    found = passes[0].passes(drawn.image())
    kinds = [type(command) for command in figure.commands("GEFORCE_256", 32)]
    assert TexImage in kinds and all(kinds[one.number] not in (TexImage, ReadPixels) for one in found)
    assert any("TexImage: " in line for one in found for line in one.commands)


@pytest.mark.parametrize("grey", [0, 70])
def test_one_pass_is_the_finished_picture(grey):
    passes, _, _ = passes_of((clear(grey),))
    assert greys(passes) == [grey]
