"""The guided ideal evaluates the machine's own primitives, and refuses a frame of others."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType, WindowOrigin
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.ideal.primitives import primitives_of
from fixedpipe.pipeline.inspection.stage_errors import stage_errors
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, NV2A
from fixedpipe.pipeline.state import PassState, VertexState, Viewport
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
