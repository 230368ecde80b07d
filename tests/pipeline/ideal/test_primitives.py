"""The guided ideal evaluates the machine's own primitives, and refuses a frame of others."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    PolygonMode,
    PrimitiveType,
    TexGenMode,
    WindowOrigin,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal import evaluate, primitives
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.ideal.primitives import primitives_of
from fixedpipe.pipeline.inspection.stage_errors import stage_errors
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, NV2A, OCTANE
from fixedpipe.pipeline.state import (
    DepthTest,
    Fog,
    Light,
    Lighting,
    PassState,
    PolygonState,
    TexGen,
    TextureUnit,
    VertexState,
    Viewport,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.vertices.stage import process

SIZE = 32


def far_floor(x=0.0, z=0.25, primitive=PrimitiveType.QUADS):
    """A floor whose near corners lie 16,000 pixels to the side: the NV2A leaves it whole; machines with a
    guard band of 8192 pixels clip it.
    """
    near = 0.002  # w of the near corners
    corners = [
        [-2 + x, -near, z * near, near],
        [2 + x, -near, z * near, near],
        [1 + x, 0.5, z, 1],
        [x - 1, 0.5, z, 1],
    ]
    colors = [[0.2, 0.4, 0.9], [0.9, 0.1, 0.3], [0.5, 1.0, 0.2], [0.1, 0.6, 0.7]]
    mesh = Mesh(corners, primitive, colors=colors)
    return (Clear(label="black", color=(0, 0, 0, 0)), Draw(label="floor", mesh=mesh, state=PassState()))


def triangles_of(commands, profile):
    draw = commands[1]
    return len(process(draw.mesh, draw.state, profile, SIZE, SIZE).triangles)


def test_the_ideal_takes_triangles_that_only_the_machine_leaves_whole():
    commands = far_floor()
    assert triangles_of(commands, NV2A) < triangles_of(commands, IDEAL)
    machine = execute(commands, NV2A, SIZE, SIZE, record=True)
    ideal = execute_ideal(commands, SIZE, SIZE, guide=machine)
    assert machine.fragments > SIZE
    # Vertex colours to bytes, and what weights and products leave: not another triangle's colour.
    assert np.abs(255.0 * ideal.color - machine.framebuffer.color).max() < 2.0


@pytest.mark.parametrize("machine", [NV2A, GEFORCE_256], ids=lambda machine: machine.name)
def test_the_ideal_s_triangles_are_the_machine_s(machine):
    draw = far_floor()[1]
    own = process(draw.mesh, draw.state, machine, SIZE, SIZE)
    ideal = primitives_of(draw, machine, SIZE, SIZE)
    assert ideal.colors.dtype == np.float64
    for name in ("x", "y", "z", "inverse_w", "triangles"):
        np.testing.assert_array_equal(getattr(ideal, name), getattr(own, name))
    assert own.places() == ideal.places()


def test_rows_are_counted_from_where_the_machine_counts_them():
    machine = GEFORCE_256.changed(device_origin=WindowOrigin.LOWER_LEFT)
    rows = Mesh([[-1, -1, 0], [0.7, -0.3, 0], [0.1, 0.123, 0]])
    draw = Draw(label="a triangle", mesh=rows, state=PassState())
    own = process(rows, draw.state, machine, SIZE, SIZE)
    assert own.places() != process(rows, draw.state, IDEAL, SIZE, SIZE).places()
    assert own.places() == primitives_of(draw, machine, SIZE, SIZE).places()


@pytest.mark.parametrize(
    "other",
    [
        {"x": 0.125},  # as many triangles, one pixel and more to the side
        {"z": 0.5},  # in the same pixels, at another depth
    ],
)
def test_a_guide_of_another_view_is_refused(other):
    guide = execute(far_floor(), GEFORCE_256, SIZE, SIZE, record=True)
    with pytest.raises(ValueError, match=r"floor: the guide's primitives are at other places"):
        execute_ideal(far_floor(**other), SIZE, SIZE, guide=guide)


def test_a_guide_of_another_viewport_is_refused():
    clear, draw = far_floor()
    state = PassState(vertex=VertexState(viewport=Viewport(0, 0, SIZE // 2, SIZE)))
    guide = execute((clear, replace(draw, state=state)), GEFORCE_256, SIZE, SIZE, record=True)
    with pytest.raises(ValueError, match="same meshes in the same views"):
        execute_ideal((clear, draw), SIZE, SIZE, guide=guide)


@pytest.mark.parametrize("engine", [None, "columns"])
def test_every_engine_records_the_same_places(engine):
    guide = execute(far_floor(), NV2A, SIZE, SIZE, record=True, engine=engine)
    draw = far_floor()[1]
    assert guide.records[0].places == process(draw.mesh, draw.state, NV2A, SIZE, SIZE).places()


def wholes(count, seed=2):
    """A mesh inside the view with all that vertices have, and its Draw's state."""
    random = np.random.default_rng(seed)
    corners = np.column_stack([random.uniform(-0.5, 0.5, (count, 3)), np.ones(count)])
    return Mesh(
        corners,
        colors=random.uniform(-0.2, 1.2, (count, 4)),
        secondary_colors=random.random((count, 3)),
        normals=random.normal(0, 1, (count, 3)),
        texture_coordinates=(random.uniform(0, 3, (count, 2)),),
        fog_coordinates=random.random(count),
    )


def counted_processing(monkeypatch):
    """How often the ideal transforms vertices itself."""
    calls = []

    def counted(*given):
        calls.append(given)
        return process(*given)

    monkeypatch.setattr(primitives, "process", counted)
    return calls


SHEAR = ((1.0, 0.5, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.5))
SPHERES = (TexGen(TexGenMode.SPHERE_MAP),) * 2 + (TexGen(),) * 2
TAKEN = {
    "as given": (PassState(), True),
    "transformed": (PassState(vertex=VertexState(modelview=SHEAR)), True),
    "texture matrix": (PassState(texture_units=(TextureUnit("t", matrix=SHEAR),)), True),
    "depth test": (PassState(depth_test=DepthTest(ComparisonFunction.LESS)), True),
    "lit": (PassState(vertex=VertexState(lighting=Lighting(lights=(Light(),)))), False),
    "fog": (PassState(fog=Fog()), False),
    "sphere map": (PassState(texture_units=(TextureUnit("t", gen=SPHERES),)), False),
    "outlines": (
        PassState(polygon=PolygonState(front_mode=PolygonMode.LINE, back_mode=PolygonMode.LINE)),
        False,
    ),
}


@pytest.mark.parametrize("machine", [NV2A, GEFORCE_256, OCTANE], ids=lambda machine: machine.name)
@pytest.mark.parametrize(("state", "taken"), TAKEN.values(), ids=TAKEN)
def test_the_ideal_takes_the_machine_s_primitives_where_colours_alone_differ(
    monkeypatch, machine, state, taken
):
    calls = counted_processing(monkeypatch)
    image = texture_2d(np.random.default_rng(3).random((8, 8, 4)), mipmaps=True)
    commands = (
        TexImage(label="t", texture="t", image=image),
        Clear(label="black", color=(0, 0, 0, 0), depth=1.0),
        Draw(label="all of it", mesh=wholes(60), state=state),
    )
    guide = execute(commands, machine, SIZE, SIZE, record=True)
    assert guide.records[0].passed.any()
    ideal = execute_ideal(commands, SIZE, SIZE, guide=guide)
    assert len(calls) == (not taken)
    anew = (*commands[:2], replace(commands[2]))  # an equal Draw, but no more the one that was drawn
    expected = execute_ideal(anew, SIZE, SIZE, guide=guide)
    assert len(calls) == (not taken) + 1
    np.testing.assert_array_equal(ideal.color, expected.color)
    draw, record = commands[2], guide.records[0]
    made, own = primitives_of(draw, machine, SIZE, SIZE, record), primitives_of(draw, machine, SIZE, SIZE)
    for name in ("x", "y", "z", "inverse_w", "colors", "coordinates", "fog", "triangles", "strokes"):
        one, other = getattr(made, name), getattr(own, name)
        assert one.dtype == other.dtype and one.tobytes() == other.tobytes(), name
    assert (made.two_side, made.dropped) == (own.two_side, own.dropped)


def test_clipped_triangles_and_other_grids_are_made_anew(monkeypatch):
    calls = counted_processing(monkeypatch)
    for commands, machine in (
        (far_floor(), GEFORCE_256),
        (far_floor(), GEFORCE_256.with_precision(subpixel_bits=8)),
        (
            (Clear(label="c"), Draw(label="d", mesh=wholes(9), state=PassState())),
            GEFORCE_256.with_precision(subpixel_bits=8),
        ),
    ):
        guide = execute(commands, machine, SIZE, SIZE, record=True)
        execute_ideal(commands, SIZE, SIZE, guide=guide)
    assert len(calls) == 3


def test_a_draw_of_which_nothing_passed_is_not_shaded(monkeypatch):
    monkeypatch.setattr(evaluate, "shade", lambda *_: pytest.fail("it was shaded"))
    never = PassState(depth_test=DepthTest(ComparisonFunction.NEVER))
    commands = (Clear(label="c", color=(0.25, 0, 0, 0)), Draw(label="d", mesh=wholes(30), state=never))
    guide = execute(commands, NV2A, SIZE, SIZE, record=True)
    assert len(guide.records[0].x) and not guide.records[0].passed.any()
    assert (execute_ideal(commands, SIZE, SIZE, guide=guide).color == (0.25, 0, 0, 0)).all()


def test_on_another_subpixel_grid_depths_and_w_are_compared():
    finer = GEFORCE_256.with_precision(subpixel_bits=8)
    guide = execute(far_floor(), finer, SIZE, SIZE, record=True)
    assert execute_ideal(far_floor(), SIZE, SIZE, guide=guide).color.any()
    with pytest.raises(ValueError, match="at other places"):
        execute_ideal(far_floor(z=0.5), SIZE, SIZE, guide=guide)


def test_a_guide_of_lines_is_no_guide_of_polygons():
    line = far_floor(primitive=PrimitiveType.LINES)
    guide = execute(line, GEFORCE_256, SIZE, SIZE, record=True)
    with pytest.raises(ValueError, match="at other places"):
        execute_ideal(far_floor(), SIZE, SIZE, guide=guide)


def test_the_maps_of_stages_are_of_the_machine_s_triangles_too():
    clear, draw = far_floor()
    own_color = parse_program("!!RC1.0 { rgb { spare0 = col0; } } out.rgb = spare0; out.a = col0.a;")
    state = PassState(register_combiners=own_color.combiners)
    maps = stage_errors((clear, replace(draw, state=state)), NV2A, SIZE, SIZE)
    assert maps
    for errors in maps.values():
        assert np.nanmax(errors) < 2.0
