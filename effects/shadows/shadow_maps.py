"""Shadow maps with depth textures: H34, H35 of document 000 and Z10, Z12, Z17 to Z20 of document 003.

P0      the scene's depths seen from the light, moved away from it by PolygonOffset (Z12), copied to a depth
        texture (``store_map``); once where only the eye moves, for every frame where lights or objects do
        (H35)
H34     P1 the scene without the light, P2 the comparison into the stencil through the alpha test, P3 the
        light where the stencil is marked (``stencil_passes``); where a machine puts what shadows keep into
        the comparison (SGIX_shadow_ambient), one pass does all three (``ambient_form_pass``)
Z10     P1 the scene without the light, P2 the light, multiplied by the comparison (``modulated_passes``;
        Z19's texture matrix, Z20's product); with a LINEAR filter the comparisons of 2x2 texels are weighted
        (Z17); k x k of them, with the map moved from texel to texel, one or four in a pass, in the
        accumulation buffer (Z18, ``accumulated_passes``)

A camera is an object with ``view(panel)`` and ``texture_matrix``: a ``Lamp`` or a part of one.

SGIX_shadow names its operators by the texel: TEXTURE_LEQUAL_R is 1 if texel <= r, in shadow. ARB_shadow names
r first. So LEQUAL here is 1 if r <= texel, in the light: SGIX_shadow's TEXTURE_GEQUAL_R.

Source: Heidrich 2001, section 2 (after Segal and others 1992); Zwicker 2016; SGIX_shadow, SGIX_depth_texture,
SGIX_shadow_ambient, ARB_shadow, ARB_depth_texture.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.geometry.matrices import eye_plane
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    PRIMARY,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    TEXTURE2,
    TEXTURE3,
    final,
    product,
    program,
    scaled,
    total,
)
from fixedpipe.effects.passes.draws import (
    FIRST_PASS,
    LATER_PASS,
    MARK,
    MARKED,
    MODULATE,
    REPLACE,
    at_pixel,
    copy_of_panel,
)
from fixedpipe.effects.shadows.lit_scene import (
    NO_COLOR,
    SceneShading,
    depth_pass,
    draw_object,
    lit_lighting,
    lit_pass,
    marking_pass,
    unlit_lighting,
    unlit_pass,
)
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import (
    Accum,
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    HostStep,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    AccumOperation,
    BaseFormat,
    ComparisonFunction,
    InternalFormat,
    TexGenMode,
    TextureCompareMode,
    TextureFilter,
    WrapMode,
)
from fixedpipe.pipeline.pixel_transfer import PixelImage, PixelTransfer
from fixedpipe.pipeline.state import (
    IDENTITY,
    AlphaTest,
    PassState,
    Sampler,
    TexGen,
    TextureUnit,
)

TECHNIQUES = (
    Technique("H34", "shadow maps by the shadow extension: a depth texture and the stencil", "2"),
    Technique("H35", "a map once while only the eye moves, or a map for every frame", "2"),
    Technique("Z10", "shadow mapping: depths from the light, then a comparison", "Shadow mapping"),
    Technique("Z12", "a bias when the map is drawn: too small, right, too large", "Bias"),
    Technique("Z17", "2 x 2 comparisons filtered by the texture unit", "Percentage closer filtering"),
    Technique("Z18", "k x k comparisons, for softer edges", "Percentage closer filtering"),
    Technique("Z19", "a depth texture read through a projective matrix", "Shadow mapping with OpenGL"),
    Technique("Z20", "the light multiplied by the comparison's result", "GLSL specifics"),
)

# PolygonOffset for the map. Source: the catalogue's choice (A-H34); P22 sweeps both.
OFFSET_FACTOR, OFFSET_UNITS = 1.1, 4.0
MAP_FORMAT = InternalFormat.DEPTH_COMPONENT24
# What a texture coordinate of a depth of one is where coordinates are in depth units.
_FARTHEST = 2.0**24 - 1.0
# More than a half passes: the comparison is one where the light comes, zero elsewhere.
_LIT = AlphaTest(ComparisonFunction.GREATER, 0.5)
_ALPHA_FROM_RED = ((1.0, 0.0, 0.0, 0.0),) * 4


def tiles(edge, window):
    """The pieces (x, y, width, height) in which a map of ``edge`` texels is drawn in a window (width,
    height), by rows from the lower left.
    """
    if edge < 1 or min(window) < 1:
        raise ValueError(f"A map of {edge} texels in a window of {window}; give both one or more.")
    width, height = (min(edge, extent) for extent in window)
    return tuple(
        (x, y, min(width, edge - x), min(height, edge - y))
        for y in range(0, edge, height)
        for x in range(0, edge, width)
    )


def store_map(
    scene,
    camera,
    name,
    edge,
    window,
    *,
    factor=OFFSET_FACTOR,
    units=OFFSET_UNITS,
    label="depths seen from the light",
):
    """P0: the scene's depths from ``camera`` as the depth texture ``name`` of ``edge`` by ``edge`` texels.

    ``window``: (width, height) of the framebuffer. The map is drawn from the window's lower left corner on,
    and overwrites the depths there. A map too large for the window is drawn piece by piece, with the viewport
    moved so that each piece lies at that corner.
    """
    pieces = tiles(edge, window)
    out = []
    if len(pieces) > 1:
        room = PixelImage(np.ones((edge, edge)), "DEPTH_COMPONENT")
        out.append(
            TexImage(label="room for the shadow map", texture=name, pixels=room, internal_format=MAP_FORMAT)
        )
    for x, y, width, height in pieces:
        piece = Panel(0, 0, width, height).scissor
        out.append(Clear(label="clear depth", depth=1.0, scissor=piece))
        view = camera.view(Panel(-x, -y, edge, edge))
        drawn = depth_pass(scene, view, factor=factor, units=units, label=label)
        out += (replace(draw, state=replace(draw.state, scissor=piece)) for draw in drawn)
        copied = {"label": "copy depths to the shadow map", "texture": name, "width": width, "height": height}
        if len(pieces) > 1:
            out.append(CopyTexSubImage(x_offset=x, y_offset=y, **copied))
        else:
            out.append(CopyTexImage(internal_format=MAP_FORMAT, **copied))
    return tuple(out)


def moved(texture_matrix, s, t):
    """A texture matrix whose projected coordinates are larger by (s, t)."""
    rows = [list(row) for row in texture_matrix]
    for row, by in zip(rows, (s, t), strict=False):
        row[:] = (value + by * last for value, last in zip(row, texture_matrix[3], strict=True))
    return tuple(map(tuple, rows))


def map_sampler(
    *, filtered=False, function=ComparisonFunction.LEQUAL, fail_value=0.0, depth_texture_mode=None
):
    """Parameters of a map: compared, then NEAREST or, ``filtered`` (Z17), LINEAR.

    ``function``: of "r function texel", LEQUAL where lit. ``fail_value``: SHADOW_AMBIENT's.
    """
    filter_ = TextureFilter.LINEAR if filtered else TextureFilter.NEAREST
    return Sampler(
        filter_,
        filter_,
        WrapMode.CLAMP_TO_EDGE,
        WrapMode.CLAMP_TO_EDGE,
        compare_mode=TextureCompareMode.COMPARE_R_TO_TEXTURE,
        compare_function=function,
        compare_fail_value=fail_value,
        depth_texture_mode=depth_texture_mode,
    )


def map_unit(texture_matrix, name, profile, *, view=None, environment=MODULATE, **sampling):
    """A texture unit that compares with the map ``name``.

    ``texture_matrix``: world coordinates to (s, t, r, q) of the map. ``view`` None: it is the unit's texture
    matrix behind generated object coordinates, which are the world's (Z19); else its rows are planes that
    generate eye coordinates in that view (A-H34). ``sampling``: of ``map_sampler``.
    """
    rows = [tuple(row) for row in texture_matrix]
    if profile.textures.depth_units_in_coordinates:
        rows[2] = tuple(_FARTHEST * value for value in rows[2])
    if view is None:
        planes, mode, matrix = IDENTITY, TexGenMode.OBJECT_LINEAR, tuple(rows)
    else:
        planes, mode, matrix = (
            (eye_plane(row, view.modelview) for row in rows),
            TexGenMode.EYE_LINEAR,
            IDENTITY,
        )
    return TextureUnit(
        name,
        map_sampler(**sampling),
        gen=tuple(TexGen(mode, plane) for plane in planes),
        matrix=matrix,
        environment=environment,
    )


def _mode_with_alpha(profile):
    """A DEPTH_TEXTURE_MODE of the machine whose alpha is the comparison's result, or None: it has none."""
    for mode in (BaseFormat.ALPHA, BaseFormat.INTENSITY):
        if mode in profile.textures.depth_texture_modes:
            return mode
    return None


def _marked_by_alpha(scene, view, unit, **settings):
    """P2: what the comparison finds lit is marked in the stencil through the alpha test."""
    return marking_pass(
        "compare with the shadow map, mark what is lit",
        scene,
        view,
        texture_units=(unit,),
        alpha_test=_LIT,
        **settings,
    )


def _marked_by_copy(view):
    """The picture of comparisons onto itself, red as alpha: what is lit is marked in the stencil."""
    panel = view.panel
    return copy_of_panel(
        "copy with red as alpha, mark what is lit",
        panel,
        PassState(scissor=panel.scissor, alpha_test=_LIT, stencil_test=MARK, color_mask=NO_COLOR),
        PixelTransfer(color_matrix=_ALPHA_FROM_RED),
    )


def stencil_passes(
    scene, view, lamp, name, profile, shading=SceneShading.LIT, *, camera=None, from_red=None, **sampling
):
    """H34: P1 to P3 with the map ``name`` of ``camera`` (None: the lamp's own).

    The alpha test reads the comparison's alpha, as ALPHA or INTENSITY. ``from_red``, None: where a machine
    has LUMINANCE alone, whose alpha is one whatever the comparison says: the comparison is drawn as a colour
    first, and copied onto itself with its red as alpha; the scene without the light then takes its place. (A
    texture colour table does not help: SGI_texture_color_table looks alpha up by alpha.)
    """
    camera = lamp if camera is None else camera
    mode = _mode_with_alpha(profile)
    from_red = mode is None if from_red is None else from_red
    unit = map_unit(
        camera.texture_matrix,
        name,
        profile,
        view=view,
        environment=REPLACE,
        depth_texture_mode=None if from_red else mode,
        **sampling,
    )
    cleared = Clear(label="clear the stencil", stencil=0, scissor=view.panel.scissor)
    light = lit_pass(scene, view, lamp, shading, label="light where it is marked", stencil_test=MARKED)
    if not from_red:
        unlit = unlit_pass(scene, view, shading)
        return (cleared, *unlit, *_marked_by_alpha(scene, view, unit), *light)
    compared = (
        draw_object("compare with the shadow map", thing, view, texture_units=(unit,), depth_test=FIRST_PASS)
        for thing in scene.objects
    )
    unlit = unlit_pass(scene, view, shading, depth_test=LATER_PASS)
    return (cleared, *compared, _marked_by_copy(view), *unlit, *light)


def _whole_lighting(thing, view, lamp, shading):
    """The lamp's light and the ambient light together."""
    light, ambient = lit_lighting(thing, view, lamp, shading), unlit_lighting(thing, shading)
    front = replace(light.front, ambient=ambient.front.ambient)
    return replace(light, model_ambient=ambient.model_ambient, front=front)


def _dimmed(share):
    """Combiners that do what SHADOW_AMBIENT does: the primary colour times t + share (1 - t), t the texel."""
    return program(
        total(product(TEXTURE0, CONSTANT0), CONSTANT1, to=SPARE0),
        final(SPARE0, PRIMARY),
        constant0=(1.0 - share,) * 3,
        constant1=(share,) * 3,
    )


def ambient_form_pass(
    scene,
    view,
    lamp,
    name,
    profile,
    share,
    shading=SceneShading.LIT,
    *,
    camera=None,
    combiners=None,
    **sampling,
):
    """H34's short form: one pass, all of whose light is multiplied by one, or by ``share`` in shadow.

    SGIX_shadow_ambient has the comparison give ``share`` where it fails. ``combiners``: whether a general
    combiner computes it from the comparison instead; None: if the machine has no shadow ambient.
    """
    if not 0.0 <= share <= 1.0:
        raise ValueError(f"Shadows keep {share!r} of the light; give a share from 0 to 1.")
    camera = lamp if camera is None else camera
    combiners = not profile.textures.shadow_ambient if combiners is None else combiners
    unit = map_unit(
        camera.texture_matrix, name, profile, view=view, fail_value=0.0 if combiners else share, **sampling
    )
    return tuple(
        draw_object(
            "light and shadow in one pass",
            thing,
            view,
            lighting=_whole_lighting(thing, view, lamp, shading),
            texture_units=(unit,),
            register_combiners=_dimmed(share) if combiners else None,
            depth_test=FIRST_PASS,
        )
        for thing in scene.objects
    )


def shadowed_light(
    scene, view, lamp, name, profile, shading=SceneShading.LIT, *, camera=None, matrix=None, **settings
):
    """The light's pass, multiplied by the comparison with the map ``name`` (Z20).

    ``matrix``: the texture matrix in the place of the camera's own. ``settings``: of ``map_sampler``
    (filtered, function), and more of the pass's state.
    """
    camera = lamp if camera is None else camera
    sampling = {key: settings.pop(key) for key in ("filtered", "function") if key in settings}
    unit = map_unit(camera.texture_matrix if matrix is None else matrix, name, profile, **sampling)
    settings.setdefault("label", "light times the comparison with the shadow map")
    return lit_pass(scene, view, lamp, shading, texture_units=(unit,), **settings)


def modulated_passes(scene, view, lamp, name, profile, shading=SceneShading.LIT, **settings):
    """Z10 with Z19, Z20: the scene without the light, and its light times the comparison.

    Ambient light is added outside the product (E003.9). ``settings``: of ``shadowed_light``.
    """
    return (
        *unlit_pass(scene, view, shading),
        *shadowed_light(scene, view, lamp, name, profile, shading, **settings),
    )


def kernel_offsets(kernel):
    """Where ``kernel`` by ``kernel`` texels lie about a place, in texels: (s, t) pairs, row by row."""
    steps = [i - (kernel - 1) / 2 for i in range(kernel)]
    return tuple((s, t) for t in steps for s in steps)


def _mean_of_four():
    """Combiners: the primary colour times the mean of four units' comparisons."""
    return program(
        scaled(0.5, total(TEXTURE0, TEXTURE1, to=SPARE0)),
        scaled(0.5, total(TEXTURE2, TEXTURE3, to=SPARE1)),
        scaled(0.5, total(SPARE0, SPARE1, to=SPARE0)),
        final(SPARE0, PRIMARY),
    )


def accumulated_passes(
    scene, view, lamp, name, edge, profile, kernel, shading=SceneShading.LIT, *, units=None, camera=None
):
    """Z18: the mean of ``kernel`` by ``kernel`` comparisons in the accumulation buffer.

    The accumulation buffer first loads the scene without the light, at full weight. Then it adds the light's
    passes, with the map moved by so many texels, each weighted by its number of comparisons. ``edge``: the
    map's. ``units``: 1 comparison in a pass, or 4, whose mean combiners take; None: 4 where the machine can
    and ``kernel`` is even. Raises ValueError for another number of them, and for 4 where it is odd.
    """
    camera = lamp if camera is None else camera
    if units is None:
        units = 4 if profile.textures.max_texture_units >= 4 and kernel % 2 == 0 else 1
    if kernel != int(kernel) or kernel < 1 or edge < 1:
        raise ValueError(
            f"A kernel of {kernel!r} texels along its edge, of a map of {edge}; give whole numbers from 1."
        )
    if units not in (1, 4) or kernel**2 % units:
        raise ValueError(
            f"{units!r} comparisons in a pass of {kernel} x {kernel}; give 1, or 4 where the kernel is even."
        )
    combiners = None if units == 1 else _mean_of_four()
    scissor = view.panel.scissor
    out = [
        *unlit_pass(scene, view, shading),
        Accum(label="accumulate the scene without the light", operation=AccumOperation.LOAD, scissor=scissor),
    ]
    offsets = kernel_offsets(kernel)
    for first in range(0, len(offsets), units):
        compared = (
            map_unit(moved(camera.texture_matrix, s / edge, t / edge), name, profile)
            for s, t in offsets[first : first + units]
        )
        out += (
            Clear(label="clear colour", color=(0.0, 0.0, 0.0, 0.0), scissor=scissor),
            *lit_pass(
                scene,
                view,
                lamp,
                shading,
                label="light times comparisons beside the place",
                texture_units=tuple(compared),
                register_combiners=combiners,
                blending=None,
            ),
            Accum(
                label="accumulate the light",
                operation=AccumOperation.ACCUM,
                value=units / kernel**2,
                scissor=scissor,
            ),
        )
    out.append(Accum(label="return the mean", operation=AccumOperation.RETURN, scissor=scissor))
    return tuple(out)


def show_depths(panel, name, profile, white=1.0):
    """The depths that a panel holds, read by the application as ``name`` and drawn there as grey.

    0 is black, 1 ``white``. (Here a depth texture can only be compared, so it cannot be shown.)
    """

    def drawn(read):
        depths = read[name]
        if depths.dtype.kind == "u":
            depths = depths / (2.0**profile.widest_depth - 1.0)
        return (
            DrawPixels(
                label="show depths as grey",
                image=PixelImage(white * depths, "LUMINANCE"),
                state=PassState(scissor=panel.scissor),
                position=at_pixel(panel.x, panel.y),
            ),
        )

    return (
        ReadPixels(
            label="read depths",
            name=name,
            format="DEPTH_COMPONENT",
            x=panel.x,
            y=panel.y,
            width=panel.width,
            height=panel.height,
        ),
        HostStep(label="depths become grey", reads=(name,), commands=drawn),
    )


def scene_passes(commands, scene):
    """How many times the scene's geometry is drawn."""
    first = scene.objects[0].mesh.positions
    return sum(
        isinstance(command, Draw) and np.array_equal(command.mesh.positions, first) for command in commands
    )
