"""H36 to H38: shadow maps without a shadow extension; the depth from the light is a colour's alpha.

Texture coordinate generation gives every fragment its linear depth z from the light, 0 at the light's near
plane and 1 at its far one. A one-dimensional ramp texture turns z into alpha. H36, the map, is a picture from
the light, whose alpha holds the depths; its red, green and blue do not matter. A fragment that the camera
sees is in shadow if its own depth, by the same ramp, is greater than the map's.

    P0  from the light, ramp: alpha = z + bias                  CopyTexImage         store_map
    P1  from the camera: scene without the light                                     all below
    P2  H37: ramp minus projected map, alpha test, mark         in one pass          with_combiners,
    P3  H37: the light where the stencil is marked                                   with_environments
    P2  H38: ramp into destination alpha; minus projected map;                       with_one_unit
        window onto itself, alpha times 2^n
    P3  H38: the light times (1 - destination alpha)

H37's frame has three passes while light and objects stand still and four when they move, as the paper says.
With the extension it would have as many (erratum E000.8: "one pass more" holds if the lit pass itself makes
the comparison). H38's frame has four passes and a copy of the window, and one pass more when something moves.

The project's choices:

- Two rasterizations never give the same depth, so "alpha is 0 where it is lit" never holds without a bias
  (erratum E000.9). The map stores depths ``bias`` steps farther from the light.
- The ramp's texels are i / (W - 1). With LINEAR it is exact for s' = s (W - 1) / W + 1 / (2 W), which goes
  into the plane of the generation. Uncorrected, it is off by half a texel at its ends (study P7).
- Combiners subtract by SIGNED_NEGATE. The final combiner's clamp leaves max(0, difference), and the alpha
  test is EQUAL 0. A product with -1 as EXPAND_NORMAL of zero is one with -256/255 on a machine whose half is
  128; from a map's 128 on it is a step too low. Environments of the time have no SUBTRACT. ADD_SIGNED of one
  and the other's complement gives 1/2 + difference, and the test is LEQUAL 128/255. On a machine whose half
  is 128, equal alphas give 127, so a difference of one step passes too. There a bias of b - 1 gives the masks
  that b gives with combiners.
- H38 needs destination alpha and FUNC_REVERSE_SUBTRACT (EXT_blend_subtract, the imaging subset). Without the
  latter, ``subtract=False``: the map is copied as 1 - z and added. The sum clamps at one if the fragment is
  in shadow. The copy onto itself has a bias of 1 - 2^n and a scale of 2^n, so one stays one and all lower
  numbers become zero. Equal alphas are then in shadow, so this map's bias is one step more. Pixel transfer's
  scale and bias are in OpenGL 1.0.
- The smallest alpha above zero is 1/(2^n - 1), not 1/2^n (erratum E000.10); times 2^n it is above one too.
- The map also needs destination alpha. In a window without alpha the ramp goes through red: an INTENSITY
  ramp, and a map copied as INTENSITY, whose alpha is the window's red. H37 then still runs; H38 does not.

Source: Heidrich 2001, section 2.1 (H36, H37, H38 of the catalogue; pass sequences A-H36/H37 and
A-H38); NV_register_combiners; EXT_blend_subtract; OpenGL 1.2.1 sections 2.10.4, 3.6.3, 4.3.3.
"""

from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from fixedpipe.effects.geometry.matrices import eye_plane
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.passes.arguments import member_of
from fixedpipe.effects.passes.combiners import (
    SPARE0,
    TEXTURE0,
    TEXTURE1,
    ZERO,
    negated,
    program,
    shown,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import (
    ADD,
    EDGE,
    FIRST_PASS,
    LATER_PASS,
    MARKED,
    NEAREST,
    REPLACE,
    SUBTRACT,
    copy_of_panel,
    unit,
)
from fixedpipe.effects.shadows.lit_scene import (
    SceneShading,
    draw_object,
    lit_lighting,
    lit_pass,
    marking_pass,
    unlit_pass,
)
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import (
    Clear,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    Saturate,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    BlendFactor,
    CombineFunction,
    CombineOperand,
    CombineSource,
    ComparisonFunction,
    InternalFormat,
    TexGenMode,
    TextureEnvironmentMode,
)
from fixedpipe.pipeline.pixel_transfer import INITIAL_TRANSFER, PixelTransfer
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    ColorMask,
    Combine,
    PassState,
    TexGen,
    TextureEnvironment,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_1d, texture_2d

TECHNIQUES = (
    Technique("H36", "a shadow map in alpha: linear depth from the light by a ramp texture", "2.1"),
    Technique("H37", "alpha-coded shadows by two units: the depths' difference in one pass", "2.1"),
    Technique("H38", "alpha-coded shadows by one unit: the difference in destination alpha", "2.1"),
)

ONLY_ALPHA, ONLY_RGB = ColorMask(False, False, False, True), ColorMask(True, True, True, False)
ADD_WHERE_ALPHA_IS_ZERO = Blending(BlendFactor.ONE_MINUS_DST_ALPHA, BlendFactor.ONE)
RAMP, MAP = "ramp of depths", "alpha-coded shadow map"
_ONE_MINUS_ALPHA = PixelTransfer(scale=(1.0, 1.0, 1.0, -1.0), bias=(0.0, 0.0, 0.0, 1.0))
# Assumed: steps that the map's depths are moved away from the light; study P4 has what fewer cost. One is
# for the two roundings, one for the slope of what is seen under a texel.
BIAS = 2.0
_NOT_GENERATED = TexGen()


class DepthComponent(Enum):
    """The window's component that holds depths: alpha, or red where the window has no alpha."""

    ALPHA = "alpha"
    RED = "red"


@dataclass(frozen=True)
class Coding:
    """How depths from the light become alpha.

    bits       n, of the component that holds them; a step is 1 / (2^n - 1) of the distance between the planes
    texels     of the ramp, a power of two; None: 2^n, at most 256, between which LINEAR interpolates
    bias       steps that the map's depths are moved away from the light
    corrected  whether s is made s', for which the ramp is exact
    linear     the paper's linear depth; False: a z-buffer's depth, with a division per pixel, for comparison
               (study P5)
    component  of the window
    """

    bits: int = 8
    texels: int | None = None
    bias: float = BIAS
    corrected: bool = True
    linear: bool = True
    component: DepthComponent = DepthComponent.ALPHA

    def __post_init__(self):
        member_of(DepthComponent, self.component, "The component of depths")
        if not 4 <= self.bits <= 16 or self.bits != int(self.bits):
            raise ValueError(f"Depths of {self.bits} bits; a machine's components have 4 to 16.")
        if self.width < 2 or self.width & (self.width - 1):
            raise ValueError(f"A ramp of {self.width} texels; give a power of two, 2 or more.")
        if not abs(self.bias) < np.inf:
            raise ValueError(f"The bias is {self.bias!r} steps; give a finite number.")

    @property
    def step(self):
        """The smallest difference of two alphas."""
        return 1.0 / (2**self.bits - 1)

    @property
    def width(self):
        """Texels of the ramp."""
        return min(256, 2**self.bits) if self.texels is None else self.texels

    def internal_format(self, profile):
        """Of the ramp and of the map: as wide as the machine's components where they are wider than bytes."""
        base = "ALPHA" if self.component is DepthComponent.ALPHA else "INTENSITY"
        wide = InternalFormat[f"{base}12"]
        if self.bits > 8 and wide in profile.textures.internal_formats:
            return wide
        return InternalFormat[f"{base}8"]

    def ramp(self, profile, subtract=True):
        """The command that stores the ramp.

        ``subtract``: as for ``with_one_unit``; False: the ramp ends a step below one. So a surface beyond the
        lamp's far plane stays below one if no depth of a map is added, and is lit.
        """
        alphas = np.arange(self.width) / float(self.width - 1)
        if not subtract:
            alphas = np.minimum(alphas, 1.0 - self.step)
        image = texture_1d(np.repeat(alphas[:, None], 4, axis=1), self.internal_format(profile))
        label = f"load the ramp: depth to alpha, {self.width} texels"
        return TexImage(label=label, texture=RAMP, image=image)

    def ramp_unit(self, lamp, view, bias=0.0, **settings):
        """A texture unit that reads the ramp where a fragment's depth from the light is, ``bias`` steps
        farther; ``settings``: more of TextureUnit.

        The planes are specified in the camera's eye coordinates (section 2.10.4).
        """
        if self.linear:
            depth, one = lamp.depth_plane, (0.0, 0.0, 0.0, 1.0)
        else:
            depth, one = lamp.texture_matrix[2:]
        scale = (self.width - 1.0) / self.width if self.corrected else 1.0
        move = (0.5 / self.width if self.corrected else 0.0) + scale * bias * self.step
        s = _generated(tuple(scale * d + move * w for d, w in zip(depth, one, strict=True)), view)
        q = _NOT_GENERATED if self.linear else _generated(one, view)
        return unit(RAMP, EDGE, gen=(s, _NOT_GENERATED, _NOT_GENERATED, q), **settings)


def _generated(world_plane, view):
    return TexGen(TexGenMode.EYE_LINEAR, eye_plane(world_plane, view.modelview))


def map_unit(lamp, view, name=MAP, **settings):
    """A texture unit that reads the map where a fragment is seen from the light: projective, nearest texel.

    ``lamp``: an object with a ``texture_matrix`` from world coordinates to the map's; ``settings``: more of
    TextureUnit.
    """
    s, t, _, q = lamp.texture_matrix
    gen = (_generated(s, view), _generated(t, view), _NOT_GENERATED, _generated(q, view))
    return unit(name, NEAREST, gen=gen, **settings)


def store_map(
    scene, lamp, panel, edge, profile, coding, *, name=MAP, subtract=True, shading=SceneShading.LIT
):
    """P0, H36: the scene from the light, depth as alpha, and the copy of it as a texture.

    Parameters
    ----------
    panel
        Where in the window it is drawn: a Panel. A larger map is drawn part after part.
    edge
        Texels along the map's edge, a power of two.
    coding
        The Coding of depths; the map's are ``coding.bias`` steps farther.
    subtract
        False: the map is one minus the depth, one step farther still, for ``with_one_unit``.
    shading
        What red, green and blue show, as ``lit_scene``'s; nothing depends on it.

    Raises ValueError where the map's edge is no power of two.
    """
    if edge < 1 or edge & (edge - 1):
        raise ValueError(f"The map's edge is {edge!r} texels; give a power of two.")
    part = edge
    while part > min(panel.width, panel.height):
        part //= 2
    bias = coding.bias if subtract else coding.bias + 1.0
    drawn = Panel(panel.x, panel.y, part, part)
    copied = {
        "texture": name,
        "x": panel.x,
        "y": panel.y,
        "width": part,
        "height": part,
        "transfer": INITIAL_TRANSFER if subtract else _ONE_MINUS_ALPHA,
    }
    internal_format = coding.internal_format(profile)
    if part == edge:
        copy = CopyTexImage(label="copy it as the map", internal_format=internal_format, **copied)
        return *picture_from_light(scene, lamp, drawn, coding, bias=bias, shading=shading), copy
    empty = texture_2d(np.zeros((edge, edge, 4), np.uint8), internal_format)
    out = [TexImage(label=f"make a map of {edge}x{edge} texels", texture=name, image=empty)]
    for y in range(0, edge, part):
        for x in range(0, edge, part):
            viewport = Panel(panel.x - x, panel.y - y, edge, edge)
            out += picture_from_light(
                scene, lamp, drawn, coding, bias=bias, viewport=viewport, shading=shading
            )
            out.append(CopyTexSubImage(label="copy it into the map", x_offset=x, y_offset=y, **copied))
    return tuple(out)


def picture_from_light(
    scene, lamp, panel, coding, *, bias, viewport=None, shading=SceneShading.LIT, background=(0.0, 0.0, 0.0)
):
    """The scene from the light's view. Alpha is its depth, ``bias`` steps farther; red too, if red holds
    depths.

    ``viewport``: the Panel that the light's whole view fills; ``panel`` shows the part that falls on it.
    None: the panel itself.
    """
    view = lamp.view(panel if viewport is None else viewport)
    ramp = coding.ramp_unit(lamp, view, bias, environment=REPLACE)
    # Where nothing is drawn the map is as far as it goes.
    rgb = background if coding.component is DepthComponent.ALPHA else (1.0, 1.0, 1.0)
    label = "clear to the farthest depth"
    clear = Clear(label=label, color=(*rgb, 1.0), depth=1.0, scissor=panel.scissor)
    draws = (
        draw_object(
            "depth as alpha, seen from the light",
            thing,
            view,
            lighting=lit_lighting(thing, view, lamp, shading),
            texture_units=(ramp,),
            depth_test=FIRST_PASS,
        )
        for thing in scene.throwing
    )
    return clear, *(replace(d, state=replace(d.state, scissor=panel.scissor)) for d in draws)


# ------------------------------------------------------------------------------------- H37: two texture units


def difference_combiners():
    """Register combiners whose alpha is max(0, texture 0's alpha - texture 1's)."""
    difference = total(TEXTURE0, negated(TEXTURE1), to=SPARE0)
    return program(stage(alpha=difference), shown(ZERO, alpha=SPARE0))


EQUAL_ZERO = AlphaTest(ComparisonFunction.EQUAL, 0.0)
# Erratum E000.9: ADD_SIGNED's zero is one half.
AT_MOST_HALF = AlphaTest(ComparisonFunction.LEQUAL, 128.0 / 255.0)

_COLOR_AS_IT_IS = Combine(CombineFunction.REPLACE, (CombineSource.PREVIOUS,), (CombineOperand.SRC_COLOR,))
# Previous + (1 - texel) - 1/2.
DIFFERENCE_BY_ADD_SIGNED = TextureEnvironment(
    TextureEnvironmentMode.COMBINE,
    rgb=_COLOR_AS_IT_IS,
    alpha=Combine(
        CombineFunction.ADD_SIGNED,
        (CombineSource.PREVIOUS, CombineSource.TEXTURE),
        (CombineOperand.SRC_ALPHA, CombineOperand.ONE_MINUS_SRC_ALPHA),
    ),
)


def clear_window(view, background, label="clear colour, depth and stencil"):
    """The camera's panel as its first pass finds it: destination alpha zero, no pixel marked."""
    return Clear(label=label, color=(*background, 0.0), depth=1.0, stencil=0, scissor=view.panel.scissor)


def _marked_passes(scene, view, lamp, shading, background, marking):
    """P1 to P3 of H37: ``marking`` is P2."""
    return (
        clear_window(view, background),
        *unlit_pass(scene, view, shading),
        *marking,
        *lit_pass(scene, view, lamp, shading, stencil_test=MARKED),
    )


def with_combiners(scene, view, lamp, profile, coding, *, background, shading=SceneShading.LIT, name=MAP):
    """H37 by register combiners: max(0, ramp - map) is alpha; pixels with alpha zero are lit.

    ``store_map`` before it; parameters as there. ``view``: the camera's View.
    """
    marking = marking_pass(
        "mark what is not behind the map: ramp - map = 0",
        scene,
        view,
        texture_units=(coding.ramp_unit(lamp, view), map_unit(lamp, view, name)),
        register_combiners=difference_combiners(),
        alpha_test=EQUAL_ZERO,
    )
    return _marked_passes(scene, view, lamp, shading, background, marking)


def with_environments(scene, view, lamp, profile, coding, *, background, shading=SceneShading.LIT, name=MAP):
    """H37 by the texture environments of two units: alpha is 1/2 + (ramp - map), and at most one half is lit.

    Parameters as for ``with_combiners``.
    """
    marking = marking_pass(
        "mark what is not behind the map: 1/2 + ramp - map <= 1/2",
        scene,
        view,
        texture_units=(
            coding.ramp_unit(lamp, view, environment=REPLACE),
            map_unit(lamp, view, name, environment=DIFFERENCE_BY_ADD_SIGNED),
        ),
        alpha_test=AT_MOST_HALF,
    )
    return _marked_passes(scene, view, lamp, shading, background, marking)


# -------------------------------------------------------------------------------- H38: one texture unit


def scale_alpha(panel, bits, *, subtract=True):
    """Copy the window's panel onto itself with alpha times 2^bits: all alphas above zero become one.

    ``subtract``: False adds a bias of 1 - 2^bits: all alphas below one become zero.
    """
    scale = 2.0**bits
    return copy_of_panel(
        f"copy the window onto itself, alpha times 2^{bits}",
        panel,
        PassState(scissor=panel.scissor, color_mask=ONLY_ALPHA),
        PixelTransfer(scale=(1.0, 1.0, 1.0, scale), bias=(0.0, 0.0, 0.0, 0.0 if subtract else 1.0 - scale)),
    )


def difference_in_alpha(
    scene, view, lamp, profile, coding, *, background, subtract=True, shading=SceneShading.LIT, name=MAP
):
    """P1 and the first two parts of H38's P2: the scene without the light, and ramp minus map in destination
    alpha.

    Without ``subtract``, alpha is ramp plus one minus map, at most one. Parameters as for ``with_one_unit``.
    """

    def drawn(label, texture_unit, blending):
        return tuple(
            draw_object(
                label,
                thing,
                view,
                texture_units=(texture_unit,),
                depth_test=LATER_PASS,
                blending=blending,
                color_mask=ONLY_ALPHA,
            )
            for thing in scene.objects
        )

    label = "minus the map" if subtract else "plus the map of 1 - depth"
    return (
        clear_window(view, background),
        *unlit_pass(scene, view, shading, color_mask=ONLY_RGB),
        *drawn("alpha = depth from the light", coding.ramp_unit(lamp, view, environment=REPLACE), None),
        *drawn(label, map_unit(lamp, view, name, environment=REPLACE), SUBTRACT if subtract else ADD),
        Saturate(label="alpha in [0, 1]", scissor=view.panel.scissor),
    )


def with_one_unit(
    scene,
    view,
    lamp,
    profile,
    coding,
    *,
    background,
    alpha_bits=8,
    subtract=True,
    shading=SceneShading.LIT,
    name=MAP,
):
    """H38, one texture unit: the difference in destination alpha, made zero or one by a copy of the window.

    ``alpha_bits``: the bits of the window's alpha, n; 0: it has none. ``subtract``: False for a machine
    without FUNC_REVERSE_SUBTRACT; ``store_map`` then needs the same value. Other parameters as for
    ``with_combiners``.

    Raises ValueError for a window without alpha. ``fixedpipe.pipeline.validation`` refuses the passes if a
    machine cannot subtract.
    """
    if alpha_bits < 1 or coding.component is not DepthComponent.ALPHA:
        raise ValueError(
            "H38 keeps the difference of depths in the window's alpha, and this window has none; ask for one "
            "with destination alpha, or compare in one pass with two texture units (H37)."
        )
    settings = {"background": background, "subtract": subtract, "shading": shading, "name": name}
    return (
        *difference_in_alpha(scene, view, lamp, profile, coding, **settings),
        scale_alpha(view.panel, alpha_bits, subtract=subtract),
        Saturate(label="alpha 0 or 1", scissor=view.panel.scissor),
        *lit_pass(scene, view, lamp, shading, blending=ADD_WHERE_ALPHA_IS_ZERO, color_mask=ONLY_RGB),
    )


def show_alpha(panel):
    """Destination alpha made visible: a white square times it takes the panel's colours' place."""
    state = PassState(
        vertex=VertexState(viewport=panel.viewport),
        blending=Blending(BlendFactor.DST_ALPHA, BlendFactor.ZERO),
        color_mask=ONLY_RGB,
    )
    return Draw(label="show alpha as grey", mesh=plane().mesh(), state=state)


def passes(commands):
    """How many times commands draw the scene or copy the window: consecutive Draws of the same words before
    the object's name are one pass.
    """
    labels = [c.label.rsplit(":", 1)[0] for c in commands if isinstance(c, Draw | CopyPixels)]
    return sum(a != b for a, b in zip(labels, [None, *labels], strict=False))
