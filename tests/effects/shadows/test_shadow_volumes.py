"""Shadow volumes: silhouettes that close, volumes that count what rays count, and the same bits as the
specification where polygons reach to infinity.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.effects.acceptance.agreement import compare, lit_mask, truth_of
from fixedpipe.effects.acceptance.ray_caster import RayCaster, to_light
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import cross, dot
from fixedpipe.effects.geometry.views import Panel, orthographic_view, perspective_view
from fixedpipe.effects.scenes import objects_and_lamps
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, lamp_around
from fixedpipe.effects.scenes.still_life import LAMP_POSITIONS, still_life, still_life_view
from fixedpipe.effects.shadows import shadow_volumes
from fixedpipe.effects.shadows.lit_scene import SceneShading
from fixedpipe.pipeline.commands import Clear, Draw, ReadPixels
from fixedpipe.pipeline.enums import StencilOperation
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL, PROFILES
from fixedpipe.pipeline.state import DepthTest, PassState, Scissor
from fixedpipe.pipeline.validation.validate import validate
from tests.support.run_reference import run_reference

GL = PROFILES["OPENGL_1_2"]
SHAPES = {thing.name: thing.surface for thing in still_life(12).objects if thing.closed}
SURFACES = {
    "cube": surfaces.box(),
    "torus": surfaces.torus(12, 8),
    "tetrahedron": surfaces.lathe(((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)), 3),
    "sphere": surfaces.sphere(8, 6),
}
lights = st.one_of(
    st.tuples(*[st.integers(-40, 40).map(lambda v: v / 8)] * 3, st.just(1.0)),
    st.tuples(*[st.integers(-3, 3).map(float)] * 3, st.just(0.0)).filter(lambda v: any(v[:3])),
)


def perturbed(name, seed, size):
    """A surface with every welded vertex moved at random; ``size`` 0: its own, flat faces and all."""
    surface = SURFACES[name]
    vertices, number = np.unique(surface.positions + 0.0, axis=0, return_inverse=True)
    moved = vertices + np.random.default_rng(seed).uniform(-size, size, vertices.shape)
    return replace(surface, positions=moved[number.reshape(-1)])


def directed_edges(triangles):
    return np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])


@pytest.mark.parametrize("name", SHAPES)
def test_the_still_lifes_objects_are_closed(name):
    closed = shadow_volumes.closed_surface(SHAPES[name])
    edges = len(closed.edges)
    assert 2 * edges == 3 * len(closed.triangles)
    # Euler's formula: a torus has one hole, the others none.
    assert len(closed.vertices) - edges + len(closed.triangles) == (0 if name == "ring" else 2)


def test_open_and_branching_surfaces_are_refused_with_the_number_of_edges():
    with pytest.raises(ValueError, match=r"The floor is not closed: it has 8 open edges.*first from \(-1"):
        shadow_volumes.closed_surface(surfaces.plane(2, 2), "The floor")
    cube = surfaces.box()
    with pytest.raises(ValueError, match="3 open edges"):
        shadow_volumes.closed_surface(replace(cube, triangles=cube.triangles[1:]))
    # A face twice: each of its edges has three triangles.
    doubled = replace(cube, triangles=np.concatenate([cube.triangles, cube.triangles[:1]]))
    with pytest.raises(ValueError, match="does not bound a volume: it has 3 non-manifold edges"):
        shadow_volumes.closed_surface(doubled)
    turned = replace(cube, triangles=np.concatenate([cube.triangles[1:], cube.triangles[:1, ::-1]]))
    with pytest.raises(ValueError, match="3 non-manifold edges"):
        shadow_volumes.closed_surface(turned)


@settings(max_examples=60)
@given(
    name=st.sampled_from(sorted(SURFACES)),
    seed=st.integers(0, 99),
    size=st.sampled_from([0.0, 0.02, 0.3]),
    light=lights,
    length=st.sampled_from([None, 3.0]),
)
def test_silhouettes_are_closed_loops_and_volumes_are_closed(name, seed, size, light, length):
    surface = perturbed(name, seed, size)
    try:
        volume = shadow_volumes.shadow_volume(surface, light, length)
    except ValueError as error:
        assert "at a vertex" in str(error)
        return
    starts, ends = volume.silhouette.T
    count = len(volume.positions)
    # As many edges of the silhouette leave a vertex as reach it.
    assert (np.bincount(starts, minlength=count) == np.bincount(ends, minlength=count)).all()
    edges = directed_edges(volume.triangles())
    there = np.sort(edges[:, 0] * count + edges[:, 1])
    back = np.sort(edges[:, 1] * count + edges[:, 0])
    if length is None and not light[3]:
        # All of infinity is one vertex, from and to which edges run.
        there, back = (k[(k // count != count - 1) & (k % count != count - 1)] for k in (there, back))
    assert (there == back).all()


@settings(max_examples=60)
@given(
    corners=st.lists(st.tuples(*[st.integers(-2, 2)] * 3), min_size=3, max_size=3),
    place=st.tuples(*[st.integers(-2, 2)] * 3),
    w=st.sampled_from([0.0, 1.0]),
)
def test_facing_is_the_sign_of_the_determinant(corners, place, w):
    if not w and not any(place):
        return
    a, b, c, p = (np.array(v, dtype=object) for v in (*corners, place))
    u, v, d = b - a, c - a, p - a if w else p
    exact = (u[1] * v[2] - u[2] * v[1]) * d[0] + (u[2] * v[0] - u[0] * v[2]) * d[1]
    exact += (u[0] * v[1] - u[1] * v[0]) * d[2]
    light = (*map(float, place), w)
    assert shadow_volumes.facing(np.array(corners, float), np.arange(3)[None], light)[0] == (exact > 0)


def test_facing_is_exact_where_float64_is_not():
    # The light lies a last bit above and below the plane through three far corners.
    corners = np.array([[0.1, 0.1, 0.1], [1e5, 0.3, 0.1], [0.7, 1e5, 0.1]])
    for z, expected in ((np.nextafter(0.1, 1), True), (0.1, False), (np.nextafter(0.1, 0), False)):
        assert shadow_volumes.facing(corners, np.arange(3)[None], (3e4, 3e4, z, 1.0))[0] == expected
    # Turned, so that no coordinate is shared: float64 alone gives noise here.
    random = np.random.default_rng(1)
    for _ in range(50):
        a, b, c = random.uniform(-1, 1, (3, 3))
        light = (*(a + 0.3 * (b - a) + 0.4 * (c - a)), 1.0)
        exact = shadow_volumes._exact(np.stack([a, b, c]), light)
        assert shadow_volumes.facing(np.stack([a, b, c]), np.arange(3)[None], light)[0] == (exact > 0)


def test_loops_go_round_each_silhouette_once():
    light = (-1.9, 5.9, -1.8, 1.0)
    torus = surfaces.torus(24, 12).rotated(rotation("x", 34.0))
    for surface, number in ((surfaces.box(), 1), (torus, 2)):
        volume = shadow_volumes.shadow_volume(surface, light)
        loops = shadow_volumes.silhouette_loops(volume)
        assert len(loops) == number
        assert all(loop[0] == loop[-1] for loop in loops)
        edges = {edge for loop in loops for edge in pairwise(loop.tolist())}
        assert edges == {tuple(edge) for edge in volume.silhouette.tolist()}


def test_counts_are_shown_by_colours_where_something_is_seen():
    panel = Panel(0, 0, 8, 8)
    colors = ((1.0, 1.0, 1.0), (1.0, 0.5, 0.25), (0.5, 0.25, 1.0))
    wall = surfaces.plane().mesh(colors=np.full((4, 4), 1.0))
    for count in range(4):
        commands = (
            Clear(label="clear", color=(0.2, 0.2, 0.2, 0.0), depth=1.0, stencil=count),
            Draw(
                label="wall in the left half",
                mesh=wall,
                state=PassState(scissor=Scissor(0, 0, 4, 8), depth_test=DepthTest()),
            ),
            *shadow_volumes.show_counts(panel, colors),
        )
        color = execute(commands, GL, 8, 8).framebuffer.color[..., :3]
        assert (color[:, 4:] == 51).all()
        expected = np.round(255.0 * np.array(colors[min(count, 2)]))
        assert (np.abs(color[:, :4] - expected) <= 1).all()


def test_without_volumes_nothing_is_counted_and_nothing_can_be_drawn():
    points = [[1.0, 1.0, 1.0], [0.0, 2.0, 0.0]]
    assert shadow_volumes.ray_counter((), (0.0, 0.0, 5.0), points).tolist() == [0, 0]
    with pytest.raises(ValueError, match="no shadow volume to draw"):
        shadow_volumes.volume_mesh(())


def test_a_scene_with_nothing_closed_is_refused():
    scene = still_life(8)
    bare = objects_and_lamps.Scene(scene.objects[:1])
    with pytest.raises(ValueError, match="No object of the scene is closed: floor"):
        shadow_volumes.shadow_volumes(bare, (0.0, 5.0, 0.0, 1.0))


@pytest.mark.parametrize("light", [(1.0, 2.0, 3.0, 0.5), (0.0, 0.0, 0.0, 0.0), (np.nan, 0.0, 0.0, 1.0)])
def test_what_is_no_light_is_refused(light):
    with pytest.raises(ValueError, match="The light is at"):
        shadow_volumes.shadow_volume(surfaces.box(), light)


@settings(max_examples=15)
@given(
    name=st.sampled_from(sorted(SURFACES)),
    seed=st.integers(0, 99),
    size=st.sampled_from([0.0, 0.1]),
    infinite=st.booleans(),
)
def test_the_counter_counts_the_lit_surfaces_between_a_point_and_the_light(name, seed, size, infinite):
    surface = perturbed(name, seed, size)
    random = np.random.default_rng(seed)
    position = random.uniform(-1, 1, 3)
    position *= 6.0 / np.sqrt(dot(position, position))
    lamp = Lamp(tuple(position), (0.0, 0.0, 0.0), 1.0, 9.0, infinite=infinite)
    volume = shadow_volumes.shadow_volume(surface, lamp.homogeneous)
    points = random.uniform(-3, 3, (200, 3))
    eye = tuple(position + np.array([0.1, 0.2, 0.3]))  # by the light: outside every volume
    counts = shadow_volumes.ray_counter([volume], eye, points)
    corners = surface.positions[surface.triangles]
    directions, longest = to_light(points, lamp)
    towards = position if infinite else position - corners[:, 0]
    lit = dot(cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), towards)
    crossed = np.zeros(len(points), int)
    for triangle in corners[lit > 0.0]:
        crossed += RayCaster(triangle[None]).occluded(points, directions, longest=longest)
    assert (counts == crossed).all()
    assert (counts > 0).any()


def masks(scene, view, lamp, profile=GL, **settings):
    """Lit masks of z-pass and z-fail, bottom row first, with their stencil counts."""
    out = []
    for passes in (shadow_volumes.z_pass, shadow_volumes.z_fail):
        commands = (
            # Whatever a frame before has left in the stencil.
            replace(view.panel.clear((0.0, 0.0, 0.0)), stencil=3),
            *passes(scene, view, lamp, profile, SceneShading.MASK, **settings),
        )
        result = execute(commands, profile, view.panel.width, view.panel.height)
        assert result.dropped == 0
        picture = result.framebuffer.color[::-1, :, :3] / 255.0
        out.append((lit_mask(picture), result.framebuffer.stencil[::-1].astype(int)))
    return out


@pytest.mark.parametrize("infinite", [False, True])
@pytest.mark.parametrize("position", LAMP_POSITIONS)
def test_both_algorithms_draw_the_shadows_that_rays_cast(position, infinite):
    scene, view = still_life(24), still_life_view(Panel(0, 0, 160, 160))
    lamp = lamp_around(scene, position, infinite=infinite)
    truth = truth_of(scene, view, lamp)
    volumes = shadow_volumes.shadow_volumes(scene, lamp.homogeneous)
    seen = truth.shown.something
    points = truth.shown.points[seen]
    counts = np.zeros(seen.shape, int)
    counts[seen] = shadow_volumes.ray_counter(volumes, view.eye, points + 1e-9 * (view.eye - points))
    assert ((counts == 0) == truth.lit)[seen].all()
    for mask, stencil in masks(scene, view, lamp):
        agreement = compare(mask, truth)
        assert agreement.agreeing >= 0.997, str(agreement)  # at 160 pixels; what differs is on edges
        assert agreement.other == 0, str(agreement)
        assert (stencil == counts)[seen].mean() >= 0.996


def test_kernels_and_specification_agree_where_polygons_reach_infinity():
    scene, panel = still_life(8), Panel(0, 0, 16, 16)
    # Near enough for walls of shadow on every side of the camera, behind it too.
    view = perspective_view(panel, (-0.4, 0.9, 2.6), (0.0, 0.6, 0.0), field_of_view=70.0, radius=2.5)
    stencil = ReadPixels(label="stencil", name="stencil", format="STENCIL_INDEX")
    z_pass, z_fail = shadow_volumes.z_pass, shadow_volumes.z_fail
    for infinite, passes in ((False, z_pass), (False, z_fail), (True, z_fail)):
        lamp = lamp_around(scene, LAMP_POSITIONS[0], infinite=infinite)
        commands = (panel.clear((0.0, 0.0, 0.0)), *passes(scene, view, lamp, GL), stencil)
        expected = run_reference(commands, GL, 16, 16, 24)
        for engine in (None, "portable"):
            result = execute(commands, GL, 16, 16, engine=engine)
            assert result.dropped == 0
            assert (result.pixels["stencil"] == np.array(expected.pixels["stencil"])).all()
            assert (result.framebuffer.depth == np.array(expected.target.depth)).all()
            assert (result.framebuffer.color == np.array(expected.target.color)).all()
        assert np.unique(result.pixels["stencil"]).size > 2


def test_polygons_at_infinity_have_depth_one_and_are_not_clipped():
    """Back caps alone, seen from the light: where nothing is drawn they fail the depth test, and count."""
    scene = still_life(12)
    lamp = lamp_around(scene, LAMP_POSITIONS[1])
    volumes = shadow_volumes.shadow_volumes(scene, lamp.homogeneous)
    caps = [replace(v, sides=v.sides[:0], front_cap=v.front_cap[:0]) for v in volumes]
    view = lamp.view(Panel(0, 0, 64, 64))
    infinite = shadow_volumes.infinite_view(view)
    clear = view.panel.clear((0.0, 0.0, 0.0))
    for profile in (GL, IDEAL):
        # Seen from the light, a cap at infinity hides behind its object, pixel for pixel.
        counts = []
        for seen, of in ((infinite, caps), (view, caps)):
            commands = (clear, *shadow_volumes.z_fail_counts(of, seen))
            run = (
                execute_ideal
                if profile.arithmetic.exact
                else lambda c, w, h: execute(c, GL, w, h).framebuffer
            )
            counts.append(run(commands, 64, 64).stencil > 0)
        assert not counts[1].any()  # the lamp's own far plane clips them
        hidden = truth_of(objects_and_lamps.Scene(tuple(o for o in scene.objects if o.closed)), view, lamp)
        covered = hidden.shown.something[::-1]
        assert (counts[0] == covered).mean() > 0.97


def test_z_pass_fails_with_the_eye_in_shadow_and_z_fail_does_not():
    scene = still_life(12)
    lamp = lamp_around(scene, LAMP_POSITIONS[0])
    view = perspective_view(Panel(0, 0, 96, 96), (0.7, 0.5, -0.75), (0.4, 0.0, 2.0), 60.0, radius=8.0)
    truth = truth_of(scene, view, lamp)
    for operations in (shadow_volumes.CLAMPED, shadow_volumes.WRAPPING):
        profile = PROFILES["GEFORCE_256"]
        (wrong, counts), (right, _) = masks(scene, view, lamp, profile, operations=operations)
        # Measured: 0.72; what is right lies in no shadow but the eye's own.
        assert compare(wrong, truth).agreeing < 0.75
        # The volume that the eye is in is left, never entered: counts below zero, held there or going round.
        assert (counts == 255).any() == (operations == shadow_volumes.WRAPPING)
        agreement = compare(right, truth)
        assert agreement.agreeing > 0.99 and agreement.other == 0, str(agreement)


@pytest.mark.parametrize("light", [(2.0, 5.0, 1.0, 1.0), (2.0, 5.0, 1.0, 0.0)])
def test_a_volume_of_a_length_ends_so_far_behind_each_vertex(light):
    volume = shadow_volumes.shadow_volume(surfaces.box(), light, 3.0)
    vertices, thrown = np.split(volume.positions[:, :3], 2)
    away = thrown - vertices
    assert dot(away, away) == pytest.approx(9.0)
    to_light = np.array(light[:3]) - light[3] * vertices
    assert np.abs(cross(away, to_light)).max() < 1e-12 and (dot(away, to_light) < 0.0).all()


def test_the_figure_of_both_algorithms_draws_both():
    """Their pictures are alike: no picture tells whether one of them is drawn twice."""
    size, ways = (
        16,
        {
            "before": "count volumes entered: front faces",
            "behind": "count volumes left behind it: back faces",
        },
    )
    for name, expected in (
        ("Z23", ("before", "before", "behind", "behind")),
        ("F003-26", ("before", "before", "before", "before", "behind")),
    ):
        commands = FIGURES[name].commands(GL, size)
        for k, way in enumerate(expected):
            labels = {
                c.label for c in commands if isinstance(c, Draw) and c.state.vertex.viewport.x == k * size
            }
            assert {key for key, label in ways.items() if label in labels} == {way}


def test_volumes_of_a_length_need_no_infinite_camera():
    scene = still_life(12)
    lamp = lamp_around(scene, LAMP_POSITIONS[2])
    view = orthographic_view(Panel(0, 0, 96, 96), half_height=3.0, depth=60.0)
    truth = truth_of(scene, view, lamp)
    for mask, _ in masks(scene, view, lamp, length=20.0):
        agreement = compare(mask, truth)
        assert agreement.agreeing > 0.99 and agreement.other == 0, str(agreement)
    with pytest.raises(ValueError, match="orthographic camera cannot be moved to infinity; give the volumes"):
        shadow_volumes.z_fail(scene, view, lamp, GL)
    # Shorter than the way to the floor, they miss shadows.
    (short, _), _ = masks(scene, view, lamp, length=0.05)
    assert compare(short, truth).agreeing < 0.95


def test_the_infinite_projection_is_the_limit_of_the_finite():
    view = still_life_view(Panel(0, 0, 8, 8))
    infinite = shadow_volumes.infinite_projection(view.projection)
    near = view.projection[2][3] / (view.projection[2][2] - 1.0)
    assert infinite[2] == (0.0, 0.0, -1.0, pytest.approx(-2.0 * near))
    # At the near plane depth is -1, as before.
    assert (near + infinite[2][3]) / near == pytest.approx(-1.0)


def test_machines_count_with_the_operations_that_they_have():
    scene, panel = still_life(12), Panel(0, 0, 32, 32)
    lamp, view = lamp_around(scene, LAMP_POSITIONS[0]), still_life_view(panel)
    wrapping = {"GEFORCE_256", "GEFORCE_3", "NV2A", "FUTURE", "IDEAL"}
    for name, profile in PROFILES.items():
        up, _ = shadow_volumes.counting_operations(profile)
        assert (up == StencilOperation.INCR_WRAP) == (name in wrapping)
        for passes in (shadow_volumes.z_pass, shadow_volumes.z_fail):
            validate(passes(scene, view, lamp, profile), profile, 32, 32)
