"""What may be changed of figures: all is declared, and what it cannot be is refused in a sentence."""

import inspect
from dataclasses import fields, replace

import numpy as np
import pytest

from fixedpipe.effects.figures import FIGURES, Figure
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Method
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, IDEAL, OCTANE
from tests.accept import loads_for_each_polygon

WAYS = [pytest.param(f, m, id=f"{f.id}, {m.name}") for f in FIGURES.values() for m in f.methods]
# Neither of a figure's own words is a parameter's: they stand side by side in a call.
ARGUMENTS = {*inspect.signature(Figure.commands).parameters, *inspect.signature(Figure.render).parameters}


@pytest.mark.parametrize(("figure", "method"), WAYS)
def test_every_parameter_is_declared_and_its_default_is_one_that_it_may_have(figure, method):
    assert set(method.values) <= set(figure.parameters)
    for name, parameter in figure.parameters_of(method).items():
        assert name not in ARGUMENTS
        assert parameter.does[0].isupper()
        assert parameter.does.endswith(".")
        accepted = parameter.accept(parameter.default, name)
        assert accepted == parameter.default
        assert type(accepted) is type(parameter.default)
        if parameter.offered:
            assert parameter.parse(parameter.kind.show(parameter.default), name) == parameter.default
            assert parameter.kind.allowed


@pytest.mark.parametrize(("figure", "method"), WAYS)
def test_a_scene_takes_what_is_declared_and_nothing_else(figure, method):
    known = set(figure.parameters_of(method))
    taken = inspect.signature(method.scene).parameters.values()
    assert [p.name for p in taken if p.kind is p.POSITIONAL_OR_KEYWORD] == ["profile", "size"]
    by_name = {p.name for p in taken if p.kind is p.KEYWORD_ONLY}
    assert all(p.default is p.empty for p in taken), "the table has the defaults"
    assert by_name <= known
    # What a scene hands on by ** it takes as well: drawing says so.
    if any(p.kind is p.VAR_KEYWORD for p in taken):
        if not loads_for_each_polygon(figure, method):
            assert figure.commands(IDEAL, 32, method)
    else:
        assert by_name == known


def changed(figure_id="F004-4", machine="GEFORCE_3", size=16, **changes):
    return FIGURES[figure_id].commands(machine, size, **changes)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"alphax": 0.1}, r"F004-4 has no parameter 'alphax'\. Did you mean alpha_x\? There are: slices, "),
        ({"zzz": 1}, r"F004-4 has no parameter 'zzz'\. There are: slices, .*, background\.$"),
        ({"alpha_x": "wide"}, r"F004-4's alpha_x is 'wide'; give a number from 0.05 to 1, as 0.25\."),
        ({"alpha_x": float("nan")}, "alpha_x is nan; give a number"),
        ({"alpha_x": float("inf")}, "alpha_x is inf; give a number"),
        ({"alpha_x": 1.5}, "alpha_x is 1.5; give a number from 0.05 to 1"),
        ({"alpha_x": True}, "alpha_x is True; give a number"),
        ({"alpha_x": None}, "alpha_x is None; give a number"),
        ({"alpha_x": 1j}, "alpha_x is 1j; give a number"),
        ({"slices": 50.0}, "slices is 50.0; give a whole number from 3 to 256, as 50"),
        ({"slices": 10**400}, "slices is 1000.*…; give a whole number"),
        ({"map_rows": 100}, "map_rows is 100; give a power of two from 4 to 1024, as 256"),
        ({"light": (1, 1)}, r"light is \(1, 1\); give three numbers from -1000 to 1000, not all zero, as "),
        ({"light": (0, 0, 0)}, r"light is \(0, 0, 0\); give three numbers"),
        ({"light": 5}, "light is 5; give three numbers"),
        ({"light": "1,1,1"}, "light is '1,1,1'; give three numbers"),
        ({"light": [1, 1, "a"]}, r"light is \[1, 1, 'a'\]; give three numbers"),
        ({"light": np.ones((3, 3))}, r"light is an array of shape \(3, 3\), float64; give three numbers"),
        ({"light": np.array(3.0)}, r"light is array\(3.\); give three numbers"),
        ({"diffuse": (1, 2, 3)}, r"diffuse is \(1, 2, 3\); give three numbers from 0 to 1, red, green, blue"),
        ({"figure_id": "K04", "single_pass": 1}, "K04's single_pass is 1; give True or False, as True"),
        ({"figure_id": "K04", "model": "best"}, r"K04's model is 'best'; give exact or R\*, as 'exact'"),
        ({"figure_id": "K02", "cells": 5}, "K02's cells is 5; give an even number from 2 to 64"),
        ({"figure_id": "F003-2", "maps": 3}, "maps is 3; give a power of two from 4 to 1024, or None"),
        ({"figure_id": "F003-17", "alpha_x": 1}, "F003-17 has no parameters, so 'alpha_x' cannot be changed"),
        (
            {"figure_id": "F003-10", "machine": "OPENGL_1_2", "texels": 2},
            "F003-10 has no parameter 'texels' on OPENGL_1_2; it has on GEFORCE_3, INFINITE_REALITY",
        ),
        (
            {"figure_id": "F003-10", "machine": "OPENGL_1_2", "positions": ((0.0, 1.0, 0.5),) * 3},
            "F003-10 with positions=.*: The lamp at .* is not in front of the whole scene",
        ),
        ({"machine": "G400"}, "F004-4 cannot be drawn on G400; it can on GEFORCE_256, GEFORCE_3, "),
        ({"machine": "GEFORCE3"}, r"There is no machine 'GEFORCE3'. Did you mean GEFORCE_3\? F004-4 can be "),
        ({"machine": 3}, "The machine is 3; give its name or its Profile. F004-4 can be drawn on G"),
        ({"method": "GEFORCE_3"}, "The method is 'GEFORCE_3'; leave it out, and F004-4 is drawn as "),
        ({"size": "16"}, "The size of F004-4 is '16'; give a panel's height in whole pixels, from 1"),
        ({"size": 0}, "The size of F004-4 is 0; give"),
        ({"size": 1.5}, "The size of F004-4 is 1.5; give"),
        ({"size": True}, "The size of F004-4 is True; give"),
    ],
)
def test_what_a_parameter_or_a_machine_cannot_be_is_refused_in_a_sentence(changes, sentence):
    with pytest.raises(ValueError, match=sentence):
        changed(**changes)


def test_numbers_of_numpy_lists_and_names_of_members_are_taken_as_they_are_meant():
    drawn = changed(slices=8, stacks=4, light=(1.0, 1.0, 1.0))
    again = changed(slices=np.int64(8), stacks=4, light=np.ones(3))
    assert [c.label for c in drawn] == [c.label for c in again]
    mesh, other = (next(c.mesh for c in cs if isinstance(c, Draw)) for cs in (drawn, again))
    np.testing.assert_array_equal(mesh.positions, other.positions)
    shading = FIGURES["F003-12"].parameters["shading"]
    assert shading.accept("MASK", "it") is shading.parse("mask", "it")
    assert shading.accept(shading.default, "it") is shading.default


def methods_of(*profiles):
    """What draws F004-4 on each: its combiners, or the imaging subset's polygons."""
    commands = [FIGURES["F004-4"].commands(p, 16, slices=6, stacks=4) for p in profiles]
    return ["combiners" if len(cs) < 20 else "polygons" for cs in commands]


def test_a_machine_is_drawn_in_its_own_way_and_a_changed_one_in_its_origin_s():
    changed_twice = OCTANE.with_precision(combiner_bits=10).without_clamps()
    renamed = OCTANE.changed(max_lights=4, name="mine")
    of_a_user = OCTANE.descendant(name="another", description="as the Octane")
    profiles = (OCTANE, "OCTANE", changed_twice, renamed, of_a_user)
    assert set(methods_of(*profiles)) == {"polygons"}
    assert set(methods_of(GEFORCE_256, GEFORCE_3.changed(max_lights=4), IDEAL, "IDEAL")) == {"combiners"}
    # A machine changed to be no other is a machine of the same values.
    assert OCTANE.changed(max_lights=OCTANE.vertices.max_lights) is not OCTANE


def test_a_machine_made_from_none_that_is_known_needs_a_method():
    figure = FIGURES["F004-4"]
    stranger = replace(GEFORCE_3, name="stranger", ancestor=None, changed_from=None)
    with pytest.raises(ValueError, match="stranger is made from no machine that is known, so F004-4 "):
        figure.commands(stranger, 16)
    assert figure.commands(stranger, 16, figure.methods[0])


def test_a_parameter_of_checks_alone_is_not_for_users():
    figure = FIGURES["F003-15"]
    with pytest.raises(ValueError, match="F003-15's measured is for its checks alone: It shows a plate"):
        figure.render("OPENGL_1_2", 16, measured=True)


def test_a_number_that_is_not_declared_is_refused_where_the_figure_is_made():
    figure = FIGURES["K14"]
    values = {f.name: getattr(figure, f.name) for f in fields(Figure)}
    values["parameters"] = {"depth": 0.5}
    with pytest.raises(ValueError, match=r"K14's parameter depth is 0.5; declare what it is by a word of "):
        Figure(**values)


@pytest.mark.parametrize("other", [{}, {"gloss": word.SHARE(0.5, "How glossy it is.")}])
def test_a_scene_that_takes_other_parameters_is_refused_where_the_figure_is_made(other):
    figure = FIGURES["K14"]
    less = {name: parameter for name, parameter in figure.parameters.items() if other or name != "light"}
    with pytest.raises(
        ValueError, match=r"^K14's parameters are .*'(light|gloss)'\)\. Declare each that the"
    ):
        replace(figure, parameters={**less, **other})


def test_a_way_s_own_values_and_parameters_stand_over_the_figure_s():
    def scene(profile, size, *, more, **others):
        return FIGURES["K14"].methods[0].scene(profile, size, **others)

    method = Method("a way", scene, ("NV2A",), {"cells": 8}, {"more": word.COUNT(3, "How many more.")})
    figure = replace(FIGURES["K14"], methods=(method,))
    assert figure.values_of(method) == {**figure.values, "cells": 8, "more": 3}
    assert figure.parameters_of(method)["cells"].kind == figure.parameters["cells"].kind


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        (word.Number(0.0, 1.0), " .5 ", 0.5),
        (word.Whole(1, 4), "3", 3),
        (word.Flag(), "Yes", True),
        (word.Flag(), "off", False),
        (word.COLOR_KIND, "0, .5 ,1", (0.0, 0.5, 1.0)),
        (word.Several(word.COLOR_KIND, 1, 2), "0,0,0/1,1,1", ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))),
        (word.Several((word.Several((word.OFFSET_KIND,) * 2),) * 1), "1,2/3,4", (((1.0, 2.0), (3.0, 4.0)),)),
        (word.Maybe(word.Whole(1, 4), "none"), "None", None),
        (word.Maybe(word.Whole(1, 4), "none"), "2", 2),
    ],
)
def test_values_are_read_from_the_texts_of_options_and_written_as_such(kind, text, value):
    assert kind.parse(text) == value
    assert kind.parse(kind.show(value)) == value


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        (word.Number(0.0, 1.0), "1,2"),
        (word.Number(0.0, 1.0, above=True), "0"),
        (word.Number(), "nan"),
        (word.Number(), "1e999"),
        (word.Whole(1, 4), "2.0"),
        (word.Whole(1, 4), "5"),
        (word.Flag(), "maybe"),
        (word.COLOR_KIND, "0,0"),
        (word.COLOR_KIND, "0,0,0,0"),
        (word.COLOR_KIND, "0,0,0/0,0,0"),
        (word.DIRECTION_KIND, "0,0,0"),
        (word.Several(word.Flag(), 1, 2), ""),
        (word.Internal(), "1"),
    ],
)
def test_a_text_that_says_no_value_is_refused(kind, text):
    with pytest.raises(ValueError):
        kind.parse(text)
