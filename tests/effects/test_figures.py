"""Every figure on its machines: valid, alike for the machine and the ideal, its acceptance checks, the same
input bits everywhere.
"""

import hashlib
import os
import shutil
import subprocess
import sys
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.must_see import is_named
from fixedpipe.effects.figures import FIGURES, Figure, Method, Renderer
from fixedpipe.effects.figures.costs import SECONDS
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.ideal.primitives import primitives_of
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, PROFILES
from fixedpipe.pipeline.state import ColorTable, DepthTest
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.vertices.stage import process
from tests.accept import loads_for_each_polygon
from tests.support.sample import sampled_figures, slow_unless

ROOT = Path(__file__).parents[2]
# Figures keep their bits (tests/golden) after every change. Of the rest a share of them is looked at after
# each, and all by `make test-all`.
SAMPLE = sampled_figures()
# Each figure on the first machine of each of its methods.
DRAWN = [(f.id, method.machines[0]) for f in FIGURES.values() for method in f.methods]
VALID = [
    pytest.param(
        f.id,
        method.machines[0],
        marks=slow_unless(f.id in SAMPLE and not loads_for_each_polygon(f, method)),
    )
    for f in FIGURES.values()
    for method in f.methods
]
# Each figure on each of its machines; all but its own take minutes together.
EVERYWHERE = [
    pytest.param(f.id, machine, marks=slow_unless(f.id in SAMPLE and machine == f.machines[0]))
    for f in FIGURES.values()
    for machine in f.machines
]


@pytest.mark.parametrize(("figure_id", "machine"), VALID)
def test_every_figure_is_valid_on_the_machine_and_on_the_ideal(figure_id, machine):
    figure = FIGURES[figure_id]
    for profile in (PROFILES[machine], IDEAL):
        commands = figure.commands(profile, 32, figure.method(machine))
        validate(commands, profile, *figure.dimensions(32))
        assert all(command.label for command in commands)


COMBINERS = [figure.id for figure in FIGURES.values() if figure.methods[0].name == "register combiners"]


@pytest.mark.parametrize("figure_id", COMBINERS)
def test_register_combiners_take_textures_loaded_once_and_later_passes_keep_depth(figure_id):
    commands = FIGURES[figure_id].commands(GEFORCE_256, 32)
    loaded = [c.texture for c in commands if isinstance(c, TexImage)]
    assert len(loaded) == len(set(loaded))
    for draw in (c for c in commands if isinstance(c, Draw)):
        if draw.state.blending is not None:
            assert draw.state.depth_test == DepthTest(draw.state.depth_test.function, write=False)
            assert draw.state.depth_test.function.name == "EQUAL"


def has_own_places(machine):
    """Whether a machine's triangles may lie elsewhere, or be others, than the ideal's own."""
    own, its = IDEAL.arithmetic, PROFILES[machine].arithmetic
    return (its.guard_band, its.device_origin) != (own.guard_band, own.device_origin)


# Each figure with its machines that have places of their own, and with its others. Most of the time goes into
# textures, so the long proofs alone have the others, and the figures that take longest.
_LONG = 15  # seconds of a figure with its checks
PLACED = [
    pytest.param(
        f.id,
        tuple(m for m in f.machines if has_own_places(m) is own),
        marks=slow_unless(own and f.id in SAMPLE and SECONDS.get(f.id, 0.0) <= _LONG),
    )
    for own in (True, False)
    for f in FIGURES.values()
    if any(has_own_places(m) is own for m in f.machines)
]


@pytest.mark.parametrize(("figure_id", "machines"), PLACED)
def test_in_its_own_size_the_ideal_takes_the_machine_s_triangles(figure_id, machines):
    figure = FIGURES[figure_id]
    width, height = figure.dimensions(figure.size)
    for machine in machines:
        profile = PROFILES[machine]
        frames = figure.commands(profile), figure.commands(IDEAL, None, figure.method(machine))
        # What a HostStep draws is known when pixels have been read: execute_ideal refuses it then.
        drawn, meant = ([c for c in frame if isinstance(c, Draw)] for frame in frames)
        for own, ideal in zip(drawn, meant, strict=True):
            machines_own = process(own.mesh, own.state, profile, width, height)
            taken = primitives_of(ideal, profile, width, height)
            assert machines_own.places() == taken.places(), f"{own.label}, on the {profile.name}"


@pytest.mark.parametrize(("figure_id", "machine"), EVERYWHERE)
def test_every_acceptance_check_of_a_figure_passes(figure_id, machine):
    figure = FIGURES[figure_id]
    renderer = Renderer(PROFILES[machine], figure.method(machine), execute, execute_ideal)
    checks = figure.checks(renderer)
    assert checks
    assert {c.on for c in checks} <= set(Answer)
    failed = [
        f"{c.name} on the {c.on.value}: {c.value:.4g}, not {c.relation} {c.bound:g}"
        for c in checks
        if not c.passed
    ]
    assert not failed
    if machine == figure.machines[0]:
        named = {name for names in figure.shown_by for name in names}
        assert [name for name in named if not any(is_named(c.name, name) for c in checks)] == []


def test_a_machine_that_cannot_draw_a_figure_is_refused_with_those_that_can():
    with pytest.raises(ValueError, match=r"F004-4 cannot be drawn on G400; it can on GEFORCE_256, "):
        FIGURES["F004-4"].method("G400")


@pytest.mark.parametrize("machines", [("NV2A", "NV2A"), ("NV3",)])
def test_a_figure_with_a_machine_twice_or_unknown_is_refused(machines):
    figure = FIGURES["K14"]
    values = {f.name: getattr(figure, f.name) for f in fields(Figure)}
    values["methods"] = (Method("a way", figure.methods[0].scene, machines),)
    with pytest.raises(ValueError, match="K14 names a machine twice, or one that is not known"):
        Figure(**values)


def test_checks_are_said_for_each_sentence_of_a_must_see_or_for_none():
    values = {f.name: getattr(FIGURES["K14"], f.name) for f in fields(Figure)} | {"must_see": "One. Two."}
    assert Figure(**values | {"shown_by": (("a",), ())}).shown_by == (("a",), ())
    with pytest.raises(
        ValueError, match="K14 says for 1 sentences which checks show them, and its must-see has 2"
    ):
        Figure(**values | {"shown_by": (("a",),)})


def test_a_check_has_one_bound_and_an_answer():
    most = Check("x", 1.0, at_most=1.0, on=Answer.IDEAL, reason="y")
    least = Check("x", 1.0, at_least=2.0, on=Answer.MACHINE, reason="y")
    assert (most.relation, most.bound, most.passed) == ("<=", 1.0, True)
    assert (least.relation, least.bound, least.passed) == (">=", 2.0, False)
    with pytest.raises(ValueError, match=r"'x' has no bound; give one, at_most or at_least"):
        Check("x", 1.0, on=Answer.IDEAL, reason="y")
    with pytest.raises(ValueError, match=r"'x' has the bounds 1.0 and 0.0; give one"):
        Check("x", 1.0, at_most=1.0, at_least=0.0, on=Answer.IDEAL, reason="y")
    with pytest.raises(ValueError, match=r"'x' is on 'ideal'; give an Answer: Answer.IDEAL, Answer.MACHINE"):
        Check("x", 1.0, at_most=1.0, on="ideal", reason="y")


def test_a_check_is_written_in_the_words_of_the_json_files():
    check = Check("x", np.float64(1.5), at_most=2, on=Answer.MACHINE, reason="y")
    assert list(check.record().items()) == [
        ("name", "x"), ("value", 1.5), ("relation", "<="), ("bound", 2), ("on", "machine"), ("reason", "y"),
        ("passed", True),
    ]  # fmt: skip


def test_a_check_that_was_not_computed_does_not_pass():
    assert not Check("x", float("nan"), at_most=1.0, on=Answer.IDEAL, reason="").passed
    assert not Check("x", float("nan"), at_least=1.0, on=Answer.IDEAL, reason="").passed
    assert Check("x", 1.0, at_most=1.0, on=Answer.IDEAL, reason="").passed
    assert Check("x", 1.0, at_least=1.0, on=Answer.IDEAL, reason="").passed


def test_checks_fail_on_a_broken_picture():
    """Spheres with each other's textures must not pass for F004-4."""

    def swapped(commands, profile, width, height):
        other = {"longitudinal": "latitudinal", "latitudinal": "longitudinal"}
        out = []
        for command in commands:
            if isinstance(command, TexImage):
                direction, _, rest = command.texture.partition(" ")
                command = replace(command, texture=f"{other[direction]} {rest}")
            out.append(command)
        # Loading goes first, so that every name is known when it is read.
        out.sort(key=lambda command: not isinstance(command, TexImage))
        return execute(tuple(out), profile, width, height)

    checks = FIGURES["F004-4"].checks(
        Renderer(GEFORCE_256, FIGURES["F004-4"].methods[0], swapped, execute_ideal)
    )
    assert not all(c.passed for c in checks if c.on is Answer.MACHINE)


def bits_of(value):
    """Every number and name in a command, in order, as bytes; the functions of HostSteps are none."""
    if isinstance(value, np.ndarray):
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, ColorTable):
        yield np.array(value.entries).tobytes()
    elif is_dataclass(value):
        for f in fields(value):
            yield from bits_of(getattr(value, f.name))
    elif isinstance(value, tuple):
        for item in value:
            yield from bits_of(item)
    elif not callable(value):
        yield repr(value).encode()


def digest_of_inputs(ids):
    """One digest of all that figures hand to machines, textures, tables, vertices, matrices, for each way of
    drawing them. Of a figure that is drawn polygon by polygon, some of its thousands of commands.
    """
    state = hashlib.sha256()
    for figure, machine in DRAWN:
        if figure not in ids:
            continue
        commands = FIGURES[figure].commands(PROFILES[machine], 32, FIGURES[figure].method(machine))
        for command in commands[:: len(commands) // 500 + 1]:
            for bits in bits_of(command):
                state.update(bits)
    return state.hexdigest()


def other_processor_and_python(folder):
    """Without NumPy's loops for newer processors, and with products of its BLAS as an old one has them."""
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    disabled = " ".join(name for name in __cpu_dispatch__ if __cpu_features__.get(name))
    return {
        "NPY_DISABLE_CPU_FEATURES": disabled,
        "OPENBLAS_CORETYPE": "Prescott",
        "OPENBLAS_NUM_THREADS": "1",
    }


def other_libm(folder):
    """Sines, exponentials and the like are one last bit larger. NumPy's own loops would not call them."""
    if not sys.platform.startswith("linux") or not shutil.which("cc"):
        pytest.skip("no C compiler here, or no Linux, whose libraries can be preloaded")
    source, library = ROOT / "tests" / "support" / "other_libm.c", folder / "other_libm.so"
    command = ["cc", "-O1", "-fno-builtin", "-shared", "-fPIC", "-o", library, source, "-ldl", "-lm"]
    subprocess.run(command, check=True)
    return {**other_processor_and_python(folder), "LD_PRELOAD": str(library)}


@pytest.mark.parametrize(
    "sample", [True, pytest.param(False, marks=pytest.mark.slow)], ids=["some", "others"]
)
@pytest.mark.parametrize("elsewhere", [other_processor_and_python, other_libm])
def test_figures_hand_the_same_bits_to_the_machine_elsewhere(sample, elsewhere, tmp_path):
    ids = sorted(SAMPLE if sample else FIGURES.keys() - SAMPLE)
    code = (
        "import builtins; from tests.support.other_sum import other_sum; builtins.sum = other_sum; "
        f"from tests.effects.test_figures import digest_of_inputs; print(digest_of_inputs({ids}))"
    )
    there = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, **elsewhere(tmp_path)},
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert there.stdout.split()[-1] == digest_of_inputs(ids)
