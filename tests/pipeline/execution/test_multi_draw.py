"""A MultiDraw draws what its Draws draw, bit for bit, whichever rows kernels take together."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline import (
    GEFORCE_3,
    GEFORCE_256,
    INFINITE_REALITY,
    NV2A,
    OCTANE,
    OPENGL_1_2,
    Blending,
    Clear,
    DepthTest,
    Draw,
    HostStep,
    Machine,
    Mesh,
    MultiDraw,
    PassState,
    TexImage,
    TextureUnit,
    UnsupportedState,
    VertexState,
    describe,
    execute,
    execute_ideal,
    inspect,
    parse_program,
    texture_2d,
    validate,
)
from fixedpipe.pipeline.enums import (
    BlendFactor,
    ComparisonFunction,
    PrimitiveType,
    ProvokingVertex,
    ShadeModel,
)
from fixedpipe.pipeline.native import state_records
from fixedpipe.pipeline.state import Fog, Light, Lighting, PolygonState

WIDTH, HEIGHT = 48, 40
CLEAR = Clear(label="all", color=(0.2, 0.3, 0.4, 0.0), depth=1.0)
PROGRAM = parse_program(
    "!!RC1.0 { rgb { spare0 = col0 * const0; } alpha { spare0 = const1; } } "
    "out.rgb = spare0; out.a = spare0.a;"
).combiners
STATE = PassState(depth_test=DepthTest(ComparisonFunction.LEQUAL))
MODULATED = replace(STATE, register_combiners=PROGRAM)
POLYGONS = [primitive for primitive in PrimitiveType if primitive.is_polygons]


def texels(random, name):
    image = texture_2d(random.integers(0, 256, (8, 8, 4), dtype=np.uint8), mipmaps=True)
    return TexImage(label=name, texture=name, image=image)


def random_mesh(random, primitive, *, indexed, projective=False):
    counts = tuple(random.integers(0, 13, random.integers(1, 7)).tolist())
    total = sum(counts)
    count = max(total // 2, 3) if indexed else total
    q = random.uniform(0.5, 2.0, (count, 1)) if projective else np.ones((count, 1))
    colors = random.uniform(0, 1, (count, 4)) if random.random() < 0.7 else np.full((count, 4), 0.6)
    return Mesh(
        random.uniform(-1.1, 1.1, (count, int(random.integers(2, 4)))),
        primitive,
        indices=random.integers(0, count, total) if indexed else None,
        counts=counts,
        colors=colors,
        texture_coordinates=(np.concatenate([random.uniform(-1, 2, (count, 3)), q], axis=1),),
    )


def random_matrix(random):
    """A matrix whose zeros and ones lie elsewhere from kind to kind; one of them leads behind the eye."""
    matrix = np.eye(4)
    kind = random.integers(4)
    if kind >= 1:
        matrix[:3, 3] = random.uniform(-0.5, 0.5, 3)
    if kind >= 2:
        matrix[:3, :3] = random.uniform(-1, 1, (3, 3))
    if kind == 3:
        matrix[3, :3] = random.uniform(-1.5, 1.5, 3)
    return matrix


def random_multi_draw(random):
    primitive = POLYGONS[random.integers(len(POLYGONS))]
    mesh = random_mesh(random, primitive, indexed=random.random() < 0.5, projective=random.random() < 0.3)
    combined, textured = random.random() < 0.5, random.random() < 0.5
    unit = TextureUnit(str(random.choice(["one", "other"])))
    first = replace(MODULATED if combined else STATE, texture_units=(unit,) if textured else ())
    flat = PolygonState(shade_model=ShadeModel.FLAT, provoking_vertex=ProvokingVertex.LAST)
    states = (
        first,
        replace(first, polygon=flat),
        replace(first, blending=Blending(BlendFactor.ONE, BlendFactor.ONE)),
    )
    rows = int(random.integers(1, 20))
    return MultiDraw(
        label="many",
        mesh=mesh,
        states=states,
        runs=random.integers(0, len(mesh.counts), rows),
        state_numbers=np.sort(random.integers(0, 3, rows)),
        modelview=[random_matrix(random) for _ in range(rows)] if random.random() < 0.8 else None,
        constant_color0=random.uniform(-0.2, 1.2, (rows, 4)) if combined and random.random() < 0.8 else None,
        constant_color1=random.uniform(-0.2, 1.2, (rows, 4)) if combined and random.random() < 0.5 else None,
    )


def drawn(commands, profile, textures, **settings):
    machine = Machine(profile, WIDTH, HEIGHT, **settings)
    machine.run(textures)
    result = machine.run((CLEAR, *commands))
    buffer = result.framebuffer
    return buffer.color.tobytes(), buffer.depth.tobytes(), result.fragments, result.dropped


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3, NV2A])
def test_random_multi_draws_draw_what_their_draws_draw(profile, request):
    for seed in range(60 // request.config.getoption("examples")):
        random = np.random.default_rng([seed, 71])
        textures = texels(random, "one"), texels(random, "other")
        commands = random_multi_draw(random), random_multi_draw(random)
        draws = *commands[0].draws(), *commands[1].draws()
        assert drawn(commands, profile, textures) == drawn(draws, profile, textures), seed


def grid(rows=30):
    """A square for each row, at places of its own, as MultiDraw."""
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.9
    mesh = Mesh(
        np.tile(square, (rows, 1)),
        PrimitiveType.QUADS,
        counts=(4,) * rows,
        colors=np.random.default_rng(1).uniform(0, 1, (4 * rows, 3)),
    )
    modelview = np.tile(np.diag([0.1, 0.1, 1.0, 1.0]), (rows, 1, 1))
    modelview[:, 0, 3], modelview[:, 1, 3] = np.linspace(-0.8, 0.8, rows), np.sin(np.arange(rows)) * 0.7
    return mesh, modelview


def squares(rows=30, state=MODULATED, **given):
    mesh, modelview = grid(rows)
    if state.register_combiners is not None:
        given.setdefault("constant_color0", np.random.default_rng(2).uniform(0, 1, (rows, 4)))
    return MultiDraw(label="squares", mesh=mesh, states=(state,), modelview=modelview, **given)


@pytest.fixture
def one_by_one(monkeypatch):
    """The rows that a machine draws as Draws, in a list that grows."""
    rows, draw = [], Machine._draw
    monkeypatch.setattr(Machine, "_draw", lambda *given: rows.append(given) or draw(*given))
    return rows


def test_kernels_take_rows_together(one_by_one):
    assert drawn((squares(),), GEFORCE_3, ())[2] > 0 and not one_by_one


OTHERS = {
    "fog": replace(STATE, fog=Fog(color=(0.1, 0.2, 0.3, 1.0))),
    "lit": replace(STATE, vertex=VertexState(lighting=Lighting())),
    "points": STATE,
}


@pytest.mark.parametrize("name", OTHERS)
@pytest.mark.parametrize("profile", [GEFORCE_256, NV2A, OCTANE, OPENGL_1_2])
def test_what_kernels_do_not_take_together_is_drawn_too(name, profile):
    given = squares(6, OTHERS[name])
    if name == "points":
        mesh = Mesh(given.mesh.positions, PrimitiveType.POINTS, counts=given.mesh.counts)
        given = MultiDraw(label="points", mesh=mesh, states=given.states, modelview=given.modelview)
    found = drawn((given,), profile, ())
    assert found == drawn(given.draws(), profile, ()) and found[2] > 0


@pytest.mark.parametrize(
    ("profile", "settings"),
    [
        (INFINITE_REALITY, {"samples": 4}),
        (GEFORCE_3, {"engine": "portable"}),
        (GEFORCE_3, {"engine": "columns"}),
        (GEFORCE_3, {"threads": 1}),
    ],
)
def test_machines_of_any_settings_draw_it(profile, settings):
    given = squares(8, STATE if profile is INFINITE_REALITY else MODULATED)
    assert drawn((given,), profile, (), **settings) == drawn(given.draws(), profile, (), **settings)


def test_one_that_is_repeated_in_a_frame_is_drawn_again():
    given = squares(5, replace(MODULATED, blending=Blending(BlendFactor.ONE, BlendFactor.ONE)))
    assert drawn((given, given), GEFORCE_3, ()) == drawn(given.draws() * 2, GEFORCE_3, ())


def test_more_rows_than_one_call_takes():
    given = squares(2500)
    assert drawn((given,), GEFORCE_3, ()) == drawn(given.draws(), GEFORCE_3, ())


@pytest.mark.parametrize("most", [1, 6, 7, 100])
def test_rows_of_many_vertices_are_drawn_by_several_calls(monkeypatch, one_by_one, most):
    expected = drawn(squares().draws(), GEFORCE_3, ())
    monkeypatch.setattr(state_records, "_MOST_TOGETHER", most)
    one_by_one.clear()
    assert drawn((squares(),), GEFORCE_3, ()) == expected and not one_by_one


def test_rows_that_are_clipped_among_others_are_drawn_one_by_one(one_by_one):
    mesh, modelview = grid()
    modelview[::7, 3, 0] = 3.0
    given = MultiDraw(label="squares", mesh=mesh, states=(STATE,), modelview=modelview)
    assert drawn((given,), GEFORCE_3, ()) == drawn(given.draws(), GEFORCE_3, ())
    assert len(one_by_one) == 5


def test_everything_else_takes_it_for_its_draws():
    given = squares(3)
    frame, draws = (CLEAR, given), (CLEAR, *given.draws())
    size = WIDTH, HEIGHT
    assert describe(frame) == describe(draws)
    ours, theirs = execute_ideal(frame, *size).color, execute_ideal(draws, *size).color
    np.testing.assert_array_equal(ours, theirs)
    assert len(execute(frame, GEFORCE_3, *size, record=True).records) == 3
    assert len(execute(frame, GEFORCE_3, *size, trace=True).trace) == 4
    asked = [str(inspect(one, GEFORCE_3, *size, (24, 20))) for one in (frame, draws)]
    assert asked[0] == asked[1]
    step = HostStep(label="step", reads=(), commands=lambda pixels: (given,))
    assert drawn((step,), GEFORCE_3, ()) == drawn((given,), GEFORCE_3, ())


def test_what_a_machine_lacks_is_refused_in_the_words_of_its_first_row():
    refused = []
    for frame in ((CLEAR, squares(4)), (CLEAR, *squares(4).draws())):
        with pytest.raises(UnsupportedState, match=r'Command 1, "squares": .*no register combiners') as found:
            validate(frame, OPENGL_1_2, WIDTH, HEIGHT)
        refused.append(str(found.value))
    assert refused[0] == refused[1]
    unknown = replace(STATE, texture_units=(TextureUnit("missing"),))
    given = squares(4)
    given = MultiDraw(
        label="two states", mesh=given.mesh, states=(STATE, unknown), state_numbers=[0, 0, 1, 1]
    )
    for frame in ((CLEAR, given, CLEAR), (CLEAR, *given.draws())):
        with pytest.raises(UnsupportedState, match='Command 3, "two states": '):
            validate(frame, GEFORCE_3, WIDTH, HEIGHT)
    later = Draw(label="later", mesh=given.mesh, state=unknown)
    with pytest.raises(UnsupportedState, match='Command 5, "later": '):
        validate((CLEAR, squares(4), later), GEFORCE_3, WIDTH, HEIGHT)


def test_a_matrix_without_an_inverse_is_refused_where_normals_need_one():
    mesh, modelview = grid(3)
    modelview[2] *= 1e200
    lit = PassState(vertex=VertexState(lighting=Lighting(lights=(Light(),))))
    given = MultiDraw(label="lit", mesh=mesh, states=(lit,), modelview=modelview)
    with pytest.raises(UnsupportedState, match='Command 2, "lit"'):
        validate((given,), GEFORCE_256, WIDTH, HEIGHT)
    validate((MultiDraw(label="unlit", mesh=mesh, states=(STATE,), modelview=modelview),), GEFORCE_256, 4, 4)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"mesh": None}, "give a Mesh"),
        ({"states": (None,)}, r"states\[0\] is no PassState"),
        ({"states": ()}, "there are 0 states"),
        ({"runs": [0, 3]}, r"runs\[1\] is 3; there are 3 runs: give 0 to 2"),
        ({"runs": [-1]}, r"runs\[0\] is -1"),
        ({"runs": [0.5]}, "give a list of integers"),
        ({"state_numbers": [0, 0]}, "one for each of 3 runs"),
        ({"state_numbers": [0, 0, 1]}, r"state_numbers\[2\] is 1"),
        ({"modelview": np.eye(4)}, r"modelview has shape \(4, 4\); give \(3, 4, 4\)"),
        ({"modelview": "matrices"}, "modelview is no array of numbers"),
        ({"modelview": np.full((3, 4, 4), np.nan)}, r"modelview\[0\] holds a number that is not finite"),
        ({"constant_color1": np.zeros((3, 3))}, "constant_color1 has shape"),
        ({"states": (STATE,), "constant_color0": np.zeros((3, 4))}, r"states\[0\] has no register_combiners"),
    ],
)
def test_wrong_arrays_are_refused(wrong, said):
    mesh, _ = grid(3)
    given = {"label": "wrong", "mesh": mesh, "states": (MODULATED,)} | wrong
    with pytest.raises(ValueError, match=said):
        MultiDraw(**given)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"counts": (4, 4, 4)}, "whose sum is 8"),
        ({"counts": (4.5, 3.5)}, "give integers"),
        ({"counts": (9, -1)}, "none negative"),
        ({"counts": 8}, "give integers"),
        ({"colors": np.ones((9, 3))}, r"colors has shape \(9, 3\) but positions has 8"),
        ({"texture_coordinates": (np.ones((7, 2)),)}, "texture coordinate set 0 has shape"),
    ],
)
def test_a_mesh_that_cannot_be_cut_into_runs_is_refused(given, said):
    mesh = Mesh(np.zeros((8, 3)), PrimitiveType.QUADS, **given)
    with pytest.raises(ValueError, match=said):
        MultiDraw(label="wrong", mesh=mesh, states=(STATE,))


def test_an_empty_one_draws_nothing():
    mesh, _ = grid(2)
    assert len(MultiDraw(label="none", mesh=mesh, states=(), runs=[])) == 0
    none = MultiDraw(label="none", mesh=mesh, states=(), runs=[])
    assert drawn((none,), GEFORCE_3, ()) == drawn((), GEFORCE_3, ())


def test_its_arrays_cannot_be_changed():
    given = squares(2)
    for array in (given.runs, given.state_numbers, given.modelview, given.constant_color0):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_constants_of_stages_stay_and_the_programs_own_change():
    own = replace(PROGRAM.general[0], constant_color0=(0.25, 0.5, 0.75, 1.0))
    other = replace(PROGRAM, general=(*PROGRAM.general, own))
    given = squares(4, replace(STATE, register_combiners=other), constant_color1=np.full((4, 4), 0.5))
    assert drawn((given,), GEFORCE_3, ()) == drawn(given.draws(), GEFORCE_3, ())
