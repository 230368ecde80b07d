"""Z11, Z13 to Z16: shadow maps, each for a part of the view.

A part is a shadow map's camera and the clip planes, in the viewer's eye coordinates, between which the map is
read. First the maps are stored, one after the other. Then each part is drawn between its planes: without the
light, and with the light times the comparison. Z13 and Z15 have one part without planes. Z14 and Z16 have a
part for each slice of the viewer's frustum, and Z11 one for each face of a cube.

Source: document 003, "limited field of view" and "sampling problems"; A-Z11, A-Z14/Z15/Z16 of the catalogue.
"""

from dataclasses import dataclass, replace
from enum import StrEnum

from fixedpipe.effects.passes.arguments import checked_rgb, member_of, one_of, positive
from fixedpipe.effects.scenes.objects_and_lamps import Scene
from fixedpipe.effects.shadows import cube_of_maps, frustum_slices, light_space, shadow_maps
from fixedpipe.effects.shadows.lit_scene import SceneShading, unlit_pass
from fixedpipe.effects.technique import Technique, Variant

TECHNIQUES = (
    Technique("Z13", "shadow maps with more texels", "Sampling problems"),
    Technique("Z16", "slices and light-space perspective together", "Sampling problems"),
    Variant(("Z11", "Z14", "Z15"), "the passes that draw with several maps"),
)

# Measured, on the avenue at 256 pixels and texels: of the pixels that face the light 0.11 % are in their own
# surface's shadow with a factor of 1.1 and LiSPSM, 0.02 % with 2; beyond, shadows leave what throws them.
OFFSETS = {"factor": 2.0, "units": 4.0}


class MapFit(StrEnum):
    """What shadow maps of a light far away are fitted to. The value begins the names of their textures."""

    BASIC = "basic"  # all of the scene
    SLICES = "slices"  # what the viewer sees, in slices of the view
    LISPSM = "LiSPSM"  # what the viewer sees, in perspective towards it
    SLICES_AND_LISPSM = "slices and LiSPSM"


@dataclass(frozen=True)
class Part:
    """One map of several: its name as a texture, its camera, and the clip planes of the part that it
    lights.
    """

    name: str
    camera: object
    planes: tuple = ()


def parts_of_view(fit, scene, direction, view, edge, count=3, mixture=frustum_slices.LAMBDA):
    """The parts of a MapFit for a light far away, ``edge`` texels a map: a tuple of Part.

    direction  to the light, world coordinates
    count      how many slices
    mixture    as for ``frustum_slices.split_distances``

    One texel is left free round each map, for filters. A slice that contains nothing of the scene has no
    part.
    """
    member_of(MapFit, fit, "The way to fit shadow maps")
    border = 1.0 / positive(edge, "The map's edge")
    if fit is MapFit.BASIC:
        return (Part("basic shadow map", light_space.whole_scene_camera(scene, direction, view, border)),)
    body = light_space.seen_body(scene, view)
    if fit is MapFit.LISPSM:
        return (Part(fit.value, light_space.perspective_camera(body, scene, direction, view, border)),)
    camera = light_space.uniform_camera if fit is MapFit.SLICES else light_space.perspective_camera
    distances = frustum_slices.view_slices(view, count, mixture)
    out = []
    for k in range(count):
        body = light_space.seen_body(scene, view, *distances[k : k + 2])
        if len(body):
            planes = frustum_slices.slice_planes(distances, k)
            out.append(Part(f"{fit.value}, {k + 1}", camera(body, scene, direction, view, border), planes))
    return tuple(out)


def parts_of_cube(scene, position, view, edge, border_texels=1.5):
    """The six parts of a cube of maps round a point light, in the order of ``cube_of_maps.FACES``."""
    lamps = cube_of_maps.cube_lamps(scene, position, border_texels / positive(edge, "The map's edge"))
    return tuple(
        Part(f"shadow map {face}", lamp, cube_of_maps.face_planes(position, face, view.modelview))
        for face, lamp in zip(cube_of_maps.FACES, lamps, strict=True)
    )


def store_parts(parts, scene, edge, window, **settings):
    """The parts' maps: ``shadow_maps.store_map`` of each, with OFFSETS unless ``settings`` say otherwise."""
    settings = {**OFFSETS, **settings}
    return tuple(
        command
        for part in parts
        for command in shadow_maps.store_map(
            scene, part.camera, part.name, edge, window, label=f"depths: {part.name}", **settings
        )
    )


def tinted_color(color, tint):
    """An RGB colour half way to the RGB ``tint``: a product would leave a tree black in red."""
    return tuple((c + t) / 2.0 for c, t in zip(color, checked_rgb(tint, "The tint"), strict=True))


def tinted(scene, tint):
    """The scene with each colour as for ``tinted_color``."""
    return Scene(tuple(replace(thing, color=tinted_color(thing.color, tint)) for thing in scene.objects))


def parted_passes(
    parts, scene, view, lamp, profile, shading=SceneShading.LIT, *, tints=None, lit=None, **settings
):
    """Each part without the light, and with its light times the comparison with its map.

    ``lamp``: what lights. ``tints``: an RGB for each part, or None. ``lit``: names of the parts that get
    light, or None: all. ``settings``: of ``shadow_maps.shadowed_light``.
    """
    if tints is not None and len(tints) != len(parts):
        raise ValueError(f"There are {len(tints)} tints for {len(parts)} parts; give one for each.")
    for name in () if lit is None else lit:
        one_of([part.name for part in parts], name, "The part that gets light")
    out = []
    for k, part in enumerate(parts):
        seen = scene if tints is None else tinted(scene, tints[k])
        out += unlit_pass(seen, view, shading, clip_planes=part.planes)
        if lit is None or part.name in lit:
            out += shadow_maps.shadowed_light(
                seen,
                view,
                lamp,
                part.name,
                profile,
                shading,
                camera=part.camera,
                clip_planes=part.planes,
                label=f"light times the comparison: {part.name}",
                **settings,
            )
    return tuple(out)
