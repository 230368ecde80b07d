"""Alpha-coded shadow maps: every pair of alphas compared, the ramp, what is refused, how many passes."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.passes.combiners import ONE, alpha_of
from fixedpipe.effects.passes.draws import ADD, MARK, MODULATE, NEAREST, REPLACE, SUBTRACT, unit
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, Object, Scene, lamp_around
from fixedpipe.effects.scenes.still_life import LAMP_POSITIONS, still_life, still_life_view
from fixedpipe.effects.shadows import alpha_coded_shadows as alpha
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge
from fixedpipe.pipeline.commands import Clear, CopyTexImage, Draw, TexImage
from fixedpipe.pipeline.enums import ComponentUsage, InternalFormat, Mapping, Register
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import (
    GEFORCE_256,
    IDEAL,
    INFINITE_REALITY,
    MULTITEXTURE,
    OPENGL_1_2,
    OPENGL_1_2_IMAGING,
    PROFILES,
    TEXRAM,
)
from fixedpipe.pipeline.state import CombinerInput, GeneralCombiner, PassState, RegisterCombiners
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState

BLACK = (0.0, 0.0, 0.0)
# Every pair of bytes: the ramp's along x, the map's along y.
OWN, STORED = np.meshgrid(np.arange(256), np.arange(256))
SQUARE = surfaces.plane().mesh(*2 * (surfaces.plane().texture_coordinates,))
PANEL = Panel(0, 0, 256, 256)


def loaded(name, values):
    image = texture_2d(np.repeat((values / 255.0)[..., None], 4, axis=-1), InternalFormat.ALPHA8)
    return TexImage(label=name, texture=name, image=image)


def compared(combiners, environments, test):
    """Two units' alphas at all pairs: marked where the alpha test lets them pass."""
    units = (
        unit("own", NEAREST, environment=environments[0]),
        unit("stored", NEAREST, coordinates=1, environment=environments[1]),
    )
    state = PassState(texture_units=units, register_combiners=combiners, alpha_test=test, stencil_test=MARK)
    draw = Draw(label="compare", mesh=SQUARE, state=state)
    return loaded("own", OWN), loaded("stored", STORED), draw


def passed(commands, profile):
    run = execute_ideal if profile is IDEAL else partial(execute, profile=profile)
    result = run(commands, width=256, height=256)
    return getattr(result, "framebuffer", result).stencil[::-1] == 1


BY_COMBINERS = compared(alpha.difference_combiners(), (MODULATE, MODULATE), alpha.EQUAL_ZERO)
BY_ENVIRONMENTS = compared(None, (REPLACE, alpha.DIFFERENCE_BY_ADD_SIGNED), alpha.AT_MOST_HALF)


@pytest.mark.parametrize("machine", ["GEFORCE_256", "GEFORCE_3", "NV2A", "IDEAL"])
def test_combiners_light_what_is_not_behind_the_map_at_every_pair_of_alphas(machine):
    assert np.array_equal(passed(BY_COMBINERS, PROFILES[machine]), OWN <= STORED)


@pytest.mark.parametrize(("machine", "more"), [("MULTITEXTURE", 1), ("G400", 1), ("IDEAL", 0)])
def test_add_signed_lets_a_difference_of_one_step_pass_where_one_half_is_128(machine, more):
    assert np.array_equal(passed(BY_ENVIRONMENTS, PROFILES[machine]), STORED + more >= OWN)


def test_a_product_with_expand_normal_of_zero_is_a_step_too_low_from_one_half_on():
    """Why the combiners negate the map instead."""
    portion = alpha.difference_combiners().general[0].alpha
    minus_one = CombinerInput(Register.ZERO, Mapping.EXPAND_NORMAL, ComponentUsage.ALPHA)
    texel = CombinerInput(Register.TEXTURE1, usage=ComponentUsage.ALPHA)
    assert portion.d == alpha_of(ONE)
    general = alpha.difference_combiners().general[0]
    changed = GeneralCombiner(general.rgb, replace(portion, c=texel, d=minus_one))
    combiners = RegisterCombiners(general=(changed,), final=alpha.difference_combiners().final)
    commands = compared(combiners, (MODULATE, MODULATE), alpha.EQUAL_ZERO)
    assert np.array_equal(passed(commands, GEFORCE_256), STORED + (STORED >= 128) >= OWN)


@pytest.mark.parametrize(("machine", "subtract"), [("OPENGL_1_2_IMAGING", True), ("OPENGL_1_2", False)])
def test_the_copy_makes_every_pair_of_alphas_zero_or_one(machine, subtract):
    def drawn(name, blending):
        state = PassState(
            texture_units=(unit(name, NEAREST, environment=REPLACE),),
            blending=blending,
            color_mask=alpha.ONLY_ALPHA,
        )
        return Draw(label=name, mesh=SQUARE, state=state)

    commands = (
        loaded("own", OWN),
        loaded("stored", STORED if subtract else 255 - STORED),
        Clear(label="clear", color=(0.2, 0.4, 0.6, 0.3)),
        drawn("own", None),
        drawn("stored", SUBTRACT if subtract else ADD),
        alpha.scale_alpha(PANEL, 8, subtract=subtract),
    )
    color = execute(commands, PROFILES[machine], 256, 256).framebuffer.color[::-1]
    in_shadow = OWN > STORED if subtract else OWN >= STORED
    assert np.array_equal(color[..., 3], np.where(in_shadow, 255, 0))
    assert (color[..., :3] == (51, 102, 153)).all()


def a_scene(
    size, profile, way, *, moves=True, bias=2.0, shading=SceneShading.MASK, bits=8, lamp=None, **settings
):
    """The still life in one panel: commands of a whole frame; the map's only where something ``moves``."""
    scene = still_life(12)
    lamp = lamp or lamp_around(scene, LAMP_POSITIONS[0])
    coding = alpha.Coding(bits=bits, bias=bias)
    view, edge = still_life_view(Panel(0, 0, size, size)), map_edge(size, 1)
    out = ()
    if moves:
        mapped = {k: v for k, v in settings.items() if k == "subtract"}
        stored = alpha.store_map(scene, lamp, view.panel, edge, profile, coding, **mapped)
        out = coding.ramp(profile, **mapped), *stored
    frame = way(scene, view, lamp, profile, coding, background=BLACK, shading=shading, **settings)
    return *out, *frame


@pytest.mark.parametrize("way", [alpha.with_combiners, alpha.with_environments], ids=lambda w: w.__name__)
def test_marks_of_a_frame_before_are_cleared(way):
    profile = GEFORCE_256 if way is alpha.with_combiners else MULTITEXTURE
    commands = a_scene(48, profile, way)
    marked = (Clear(label="marks of a frame before", stencil=1), *commands)
    before, after = (execute(c, profile, 48, 48).framebuffer.color for c in (commands, marked))
    assert np.array_equal(before, after)
    assert 0.1 < (before[..., 0] > 127).mean() < 0.9


def test_ramp_and_map_are_as_wide_as_the_components():
    formats = {
        (bits, p.name): alpha.Coding(bits).internal_format(p).name
        for bits in (8, 12)
        for p in (INFINITE_REALITY, GEFORCE_256)
    }
    assert formats == {
        (8, INFINITE_REALITY.name): "ALPHA8",
        (12, INFINITE_REALITY.name): "ALPHA12",
        (8, GEFORCE_256.name): "ALPHA8",
        (12, GEFORCE_256.name): "ALPHA8",
    }
    assert (
        alpha.Coding(12, component=alpha.DepthComponent.RED).internal_format(INFINITE_REALITY).name
        == "INTENSITY12"
    )


def test_three_passes_a_frame_and_four_where_something_moves():
    """Erratum E000.8."""
    for way in (alpha.with_combiners, alpha.with_environments):
        assert alpha.passes(a_scene(32, IDEAL, way, moves=False)) == 3
        assert alpha.passes(a_scene(32, IDEAL, way)) == 4
    one_unit = a_scene(32, IDEAL, alpha.with_one_unit, moves=False)
    assert alpha.passes(one_unit) == 5
    assert alpha.passes(a_scene(32, IDEAL, alpha.with_one_unit)) == 6


def test_all_boards_draw_the_same_shadows():
    """ADD_SIGNED's bias one step less, the added map's one more: the pairs above."""
    ways = (
        ("GEFORCE_256", alpha.with_combiners, {}),
        ("MULTITEXTURE", alpha.with_environments, {"bias": 1.0}),
        ("OPENGL_1_2_IMAGING", alpha.with_one_unit, {}),
        ("OCTANE", alpha.with_one_unit, {}),
        ("OPENGL_1_2", alpha.with_one_unit, {"subtract": False}),
    )
    pictures = []
    for machine, way, settings in ways:
        commands = a_scene(96, PROFILES[machine], way, **settings)
        pictures.append(execute(commands, PROFILES[machine], 96, 96).framebuffer.color[..., 0])
    assert set(np.unique(pictures[0])) == {0, 255}
    assert 0.2 < (pictures[0] == 255).mean() < 0.95
    for picture in pictures[1:4]:
        assert np.array_equal(picture, pictures[0])
    # 1 - depth is rounded on its own, a byte apart at a depth of i + 1/2 steps.
    assert (pictures[4] != pictures[0]).sum() <= 2


@pytest.mark.parametrize("corrected", [True, False])
def test_the_corrected_ramp_is_the_depth_itself(corrected):
    """A plane seen along the light, slanted from its near to its far plane; at the ends s is half a texel
    off.
    """
    surface = surfaces.plane(1, 1, 1.0, 1.0)
    tilted = replace(surface, positions=surface.positions * 1.0 + surface.positions[:, :1] * (0.0, 0.0, 0.5))
    lamp = Lamp((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 0.5, 1.5, infinite=True)
    coding = alpha.Coding(texels=16, bias=0.0, corrected=corrected)
    scene, panel = Scene((Object("plane", tilted, (1.0, 1.0, 1.0)),)), Panel(0, 0, 64, 64)
    commands = (coding.ramp(IDEAL), *alpha.store_map(scene, lamp, panel, 64, IDEAL, coding))
    read = execute_ideal(commands, 64, 64).color[32, :, 3]
    depth = 1.0 - (np.arange(64) + 0.5) / 64.0
    error = np.abs(read - depth).max()
    if corrected:
        assert error <= 1e-12
    else:
        assert 0.7 / 32 <= error <= 1.0 / 32


def test_the_bias_moves_the_map_by_whole_steps():
    stored = []
    for bias in (0.0, 3.0):
        commands = a_scene(64, GEFORCE_256, alpha.with_combiners, bias=bias)
        (copy,) = [c for c in commands if isinstance(c, CopyTexImage)]
        stored.append(execute(commands, GEFORCE_256, 64, 64).textures[copy.texture].levels[0][0, ..., 3])
    seen = stored[0] < 252
    assert seen.mean() > 0.2
    assert (stored[1][seen].astype(int) - stored[0][seen] == 3).all()
    assert (stored[1][stored[0] == 255] == 255).all()


def test_without_destination_alpha_the_depth_goes_through_red():
    """What study P36 then draws on a surface that keeps none: the same shadows."""
    scene = still_life(12)
    lamp, view = lamp_around(scene, LAMP_POSITIONS[0]), still_life_view(Panel(0, 0, 64, 64))
    pictures = []
    for component in alpha.DepthComponent:
        coding = alpha.Coding(component=component)
        commands = (
            coding.ramp(GEFORCE_256),
            *alpha.store_map(scene, lamp, view.panel, 64, GEFORCE_256, coding),
            *alpha.with_combiners(scene, view, lamp, GEFORCE_256, coding, background=BLACK),
        )
        pictures.append(execute(commands, GEFORCE_256, 64, 64).framebuffer.color)
    assert np.array_equal(*pictures)


def test_twelve_bits_draw_the_shadows_of_eight_with_the_same_bias_in_the_world():
    """A step of twelve bits is a sixteenth of one of eight: with what eight bits need in world units, the
    masks agree.
    """
    wide = a_scene(48, INFINITE_REALITY, alpha.with_one_unit, bits=12, bias=32.0, alpha_bits=12)
    narrow = a_scene(48, OPENGL_1_2_IMAGING, alpha.with_one_unit)
    a = execute(wide, INFINITE_REALITY, 48, 48).framebuffer.color[..., 0] > 2047
    b = execute(narrow, OPENGL_1_2_IMAGING, 48, 48).framebuffer.color[..., 0] > 127
    assert 0.98 <= (a == b).mean() < 1.0


def test_what_a_board_lacks_is_refused():
    with pytest.raises(UnsupportedState, match="FUNC_REVERSE_SUBTRACT"):
        validate(a_scene(32, OPENGL_1_2, alpha.with_one_unit), OPENGL_1_2, 32, 32)
    with pytest.raises(UnsupportedState, match="COMBINE"):
        validate(a_scene(32, TEXRAM, alpha.with_environments), TEXRAM, 32, 32)
    with pytest.raises(UnsupportedState, match="combiner"):
        validate(a_scene(32, MULTITEXTURE, alpha.with_combiners), MULTITEXTURE, 32, 32)
    with pytest.raises(ValueError, match="this window has none"):
        a_scene(32, OPENGL_1_2_IMAGING, alpha.with_one_unit, alpha_bits=0)


def test_wrong_codings_and_maps_are_refused():
    with pytest.raises(
        ValueError,
        match=r"The component of depths is 'blue'; give one of DepthComponent.ALPHA, DepthComponent.RED",
    ):
        alpha.Coding(component="blue")
    with pytest.raises(ValueError, match="Depths of 3 bits"):
        alpha.Coding(bits=3)
    scene = still_life(12)
    lamp = lamp_around(scene, LAMP_POSITIONS[0])
    with pytest.raises(ValueError, match="The map's edge is 48 texels; give a power of two"):
        alpha.store_map(scene, lamp, PANEL, 48, IDEAL, alpha.Coding())


def test_a_map_larger_than_its_panel_is_drawn_part_by_part():
    scene, coding = still_life(12), alpha.Coding()
    lamp, stored = lamp_around(scene, LAMP_POSITIONS[2]), []
    for panel in (PANEL, Panel(5, 3, 80, 100)):
        commands = coding.ramp(GEFORCE_256), *alpha.store_map(scene, lamp, panel, 256, GEFORCE_256, coding)
        stored.append(execute(commands, GEFORCE_256, 256, 256).textures[alpha.MAP].levels[0])
        assert alpha.passes(commands) == 1
    # Coordinates interpolated from other window coordinates: some depths half a step between two.
    difference = np.abs(np.subtract(*stored, dtype=np.int64))
    assert difference.max() <= 1
    assert difference.sum() <= 8
