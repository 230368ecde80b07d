"""The passes of every shadow algorithm: a scene without the light, its light, and its depths from the light.

Lighting is OpenGL's, per vertex; one Draw for each object.
"""

from enum import StrEnum

from fixedpipe.effects.geometry.matrices import transform
from fixedpipe.effects.passes.arguments import member_of
from fixedpipe.effects.passes.draws import ADD, FIRST_PASS, LATER_PASS, MARK
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.state import ColorMask, Light, Lighting, Material, PassState, PolygonState

TECHNIQUES = (
    Technique("Z29", "what shadows tell: a scene with and without them", "Why are shadows important?"),
)

NO_COLOR = ColorMask(False, False, False, False)
_BLACK, _WHITE = (0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0)
# Assumed: light from everywhere that leaves shadows dark enough to be seen and light enough to see into.
AMBIENT = (0.22, 0.23, 0.27, 1.0)
# Assumed: a lamp whose light and the ambient light together stay below full intensity on the floor.
LAMP_COLOR = (0.78, 0.76, 0.70, 1.0)
# Assumed: a highlight that vertices as dense as the scenes' can show.
SHININESS = 32.0


class SceneShading(StrEnum):
    """How the passes shade a scene. A figure's parameters print the value."""

    LIT = "lit"  # its materials under ambient light and the lamp
    MASK = "mask"  # white where it is lit, black elsewhere, so that shadows can be read off the picture


def _is_mask(shading):
    return member_of(SceneShading, shading, "The shading") is SceneShading.MASK


def _emitting(color):
    return Lighting(model_ambient=_BLACK, front=Material(_BLACK, _BLACK, _BLACK, color))


def unlit_lighting(thing, shading):
    """Lighting without the lamp: ambient light alone."""
    if _is_mask(shading):
        return _emitting(_BLACK)
    return Lighting(model_ambient=AMBIENT, front=Material(ambient=(*thing.color, 1.0), diffuse=_BLACK))


def lit_lighting(thing, view, lamp, shading):
    """The lamp's light alone, without any ambient light."""
    if _is_mask(shading):
        return _emitting(_WHITE)
    strength = thing.specular
    light = Light(
        diffuse=LAMP_COLOR, specular=LAMP_COLOR, position=transform(view.modelview, lamp.homogeneous)
    )
    material = Material(
        ambient=_BLACK,
        diffuse=(*thing.color, 1.0),
        specular=(strength, strength, strength, 1.0),
        shininess=SHININESS,
    )
    return Lighting(
        lights=(light,),
        model_ambient=_BLACK,
        front=material,
        back=material if thing.two_sided else Material(),
        local_viewer=True,
        two_side=thing.two_sided,
    )


def draw_object(label, thing, view, *, lighting=None, clip_planes=(), **settings):
    """One object in a view. ``clip_planes``: in eye coordinates; ``settings``: more of PassState."""
    vertex = view.vertex_with(lighting=lighting, clip_planes=tuple(clip_planes))
    state = PassState(vertex=vertex, **settings)
    return Draw(label=f"{label}: {thing.name}", mesh=thing.mesh, state=state)


def unlit_pass(scene, view, shading=SceneShading.LIT, **settings):
    """The scene without the light's contribution; it leaves the depths that later passes test for."""
    settings.setdefault("depth_test", FIRST_PASS)
    return tuple(
        draw_object(
            "scene without the light", thing, view, lighting=unlit_lighting(thing, shading), **settings
        )
        for thing in scene.objects
    )


def lit_pass(
    scene, view, lamp, shading=SceneShading.LIT, *, label="light where it is not blocked", **settings
):
    """The light's contribution, added. ``settings``: what lets it pass (a stencil test, texture units)."""
    settings.setdefault("depth_test", LATER_PASS)
    settings.setdefault("blending", ADD)
    return tuple(
        draw_object(label, thing, view, lighting=lit_lighting(thing, view, lamp, shading), **settings)
        for thing in scene.objects
    )


def marking_pass(label, scene, view, **settings):
    """Fragments that pass the alpha test of ``settings`` are marked in the stencil buffer; no colour
    changes.
    """
    return tuple(
        draw_object(
            label, thing, view, stencil_test=MARK, depth_test=LATER_PASS, color_mask=NO_COLOR, **settings
        )
        for thing in scene.objects
    )


def depth_pass(scene, view, *, factor=0.0, units=0.0, label="depths seen from the light"):
    """Depths, without colours, of the objects that throw shadows, moved away from the viewer by
    PolygonOffset(factor, units).

    Objects that throw none are left out. Beyond the enclosed objects the map holds the farthest depth, so
    that a place outside the map, whose coordinates are clamped to its edge, is lit.
    """
    polygon = PolygonState(
        offset_fill=(factor, units) != (0.0, 0.0),
        offset_factor=factor,
        offset_units=units,
    )
    return tuple(
        draw_object(label, thing, view, depth_test=FIRST_PASS, color_mask=NO_COLOR, polygon=polygon)
        for thing in scene.throwing
    )


def map_edge(size, ratio):
    """Edge of a shadow map in texels: the power of two at or below ``ratio`` times a panel's ``size``, at
    least 8.
    """
    edge = 8
    while edge * 2 <= ratio * size:
        edge *= 2
    return edge
