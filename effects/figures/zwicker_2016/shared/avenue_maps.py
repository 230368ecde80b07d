"""Parts of the figures of document 003's "sampling problems".

They are the avenue, drawn with maps fitted in several ways, and how right each is.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import agreement, each_thing, shadow_reference
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import Panel, row_of_panels
from fixedpipe.effects.scenes import avenue
from fixedpipe.effects.scenes.objects_and_lamps import detail_of
from fixedpipe.effects.shadows import frustum_slices, light_space, parted_shadow_maps
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge

# The lower part of the picture that is near, and the farthest of the ground's rows. Source: the catalogue's
# F003-22 has the nearest 20 % of the screen. Assumed: the farthest twentieth of the ground's rows is "the far
# end".
NEAREST, FARTHEST = 0.2, 0.05
# Of the polygon offset, in steps of the depth buffer: a thousandth of the maps' depth, 6 centimetres of 60
# metres. A texel is larger than what is round here, and holds the depth of another part of it. Measured: with
# 4 steps 45 pixels of F003-22's LiSPSM picture are dark without a reason, with these 6.
OFFSET_UNITS = 16384.0
TINTS = ((1.0, 0.25, 0.20), (0.20, 0.85, 0.25), (0.25, 0.42, 1.0))
# Of the frame round what other panels show magnified.
FRAME = (1.0, 0.96, 0.55)


def edge_of(size, ratio):
    """Edge in texels of a map for a panel of ``size`` pixels. At 32 pixels, where the plain-Python
    specification draws, no map has more than twice the panel's.
    """
    return map_edge(size, ratio if size >= 64 else min(ratio, 2.0))


# How a panel shows the avenue: all that the viewer sees, with its slices tinted, a near shadow magnified, or
# the ball's part of that.
WHOLE, TINTED, NEAR_SHADOW, BALL_SHADOW = "whole", "tinted slices", "near shadow", "ball's shadow"
# Of what is magnified: the camera, and an outline of it for those that show the whole.
MAGNIFIED = {
    NEAR_SHADOW: (avenue.near_shadow_view, avenue.near_shadow_outline),
    BALL_SHADOW: (avenue.ball_shadow_view, avenue.ball_shadow_outline),
}


# Of a figure's panels.
PANEL_KIND = word.Several(
    (
        word.of_enum(*parted_shadow_maps.MapFit),
        word.Number(0.125, 8.0),
        word.Whole(1, 8),
        word.Choice({"whole": WHOLE, "tinted": TINTED, "near": NEAR_SHADOW, "ball": BALL_SHADOW}),
    )
)
SUN = word.of(
    word.DIRECTION_KIND, avenue.SUN, "The direction towards the sun, of any length: x to the right, y up."
)


def panels_of(panels):
    """The parameter ``panels`` of a figure: the content of each, for all of its panels or fewer."""
    return word.of(
        word.Several(PANEL_KIND, 1, len(panels)),
        panels,
        "Of each panel: what the maps are fitted to, their texels for each pixel along an edge, how many "
        "slices the view has, and what is shown.",
    )


def parameters_of(panels, **others):
    """The parameters of a figure that shows such panels, including its own, ``others``."""
    return {
        "panels": panels_of(panels),
        "background": word.BACKDROP(avenue.SKY),
        **others,
        "sun": SUN,
        "shading": word.SHADING(SceneShading.LIT),
    }


def camera_of(look, panel):
    """The viewer's camera of a panel."""
    view, _ = MAGNIFIED.get(look, (avenue.avenue_view, None))
    return view(panel)


def parts_for(fit, ratio, slices, size, scene, sun, mixture=frustum_slices.LAMBDA):
    """The maps of a panel, fitted to all that the viewer sees however the panel shows it: tuple of Part."""
    edge, whole = edge_of(size, ratio), avenue.avenue_view(Panel(0, 0, size, size))
    parts = parted_shadow_maps.parts_of_view(fit, scene, sun, whole, edge, slices, mixture)
    return tuple(replace(part, name=f"{part.name}, {edge} texels") for part in parts)


def scene(profile, size, *, shading, panels, background, sun):
    """Commands of ``sliced_scene``, slices ending where ``frustum_slices`` puts them."""
    settings = {"shading": shading, "panels": panels, "background": background, "sun": sun}
    return sliced_scene(profile, size, **settings, mixture=frustum_slices.LAMBDA)


def sliced_scene(profile, size, *, shading, panels, background, sun, mixture):
    """Commands that draw the avenue on a row of panels, as many as ``panels`` has, which are (MapFit, ratio
    of the map's edge to the panel's, number of slices, look). Panels of the same maps share them. On panels
    that show the whole, a frame marks the region that the others magnify.
    """
    looks = [look for *_, look in panels] if shading is SceneShading.LIT else []
    things, window = avenue.avenue(detail_of(size)), (len(panels) * size, size)
    stored, drawn, names = [], [], set()
    for panel, (fit, ratio, slices, look) in zip(row_of_panels(len(panels), size), panels, strict=True):
        parts = parts_for(fit, ratio, slices, size, things, sun, mixture)
        new = [part for part in parts if part.name not in names]
        names.update(part.name for part in new)
        stored += parted_shadow_maps.store_parts(
            new, things, edge_of(size, ratio), window, units=OFFSET_UNITS
        )
        drawn += (
            panel.clear(background if shading is SceneShading.LIT else (0.0, 0.0, 0.0)),
            *parted_shadow_maps.parted_passes(
                parts,
                things,
                camera_of(look, panel),
                parts[0].camera,
                profile,
                shading,
                tints=TINTS if look == TINTED else None,
            ),
        )
        drawn += _lines(panel, look, looks, sun)
    return (*stored, *drawn)


def _lines(panel, look, looks, sun):
    """What is drawn over a panel that is one of those with these ``looks``: the outline of a round ball's
    shadow; on panels that magnify nothing, outlines of the parts that others magnify.
    """
    if look == BALL_SHADOW and looks and (outline := avenue.ball_shadow(sun)) is not None:
        return (drawing.stroke("the true shadow's outline", camera_of(look, panel), outline, FRAME),)
    return tuple(
        drawing.stroke("the part that is magnified", drawing.sheet(panel), outline(), FRAME)
        for magnified, (_, outline) in MAGNIFIED.items()
        if magnified in looks and look not in MAGNIFIED
    )


def reference(size, *, shading, panels, background, sun, mixture=frustum_slices.LAMBDA):
    """The same panels with shadows by rays in place of each map: a figure's ``reference``."""
    things, row, shots = avenue.avenue(detail_of(size)), row_of_panels(len(panels), size), {}
    for panel, (fit, ratio, slices, look) in zip(row, panels, strict=True):
        if look in shots and look != TINTED:
            continue
        parts, view = parts_for(fit, ratio, slices, size, things, sun, mixture), camera_of(look, panel)
        tinted = look == TINTED and tuple(
            (part.planes, parted_shadow_maps.tinted(things, tint))
            for part, tint in zip(parts, TINTS, strict=True)
        )
        shots[look] = shadow_reference.Shot(
            things,
            view,
            (parts[0].camera,),
            background if shading is SceneShading.LIT else (0.0, 0.0, 0.0),
            shading,
            parts=tinted or (),
        )
    picture = shadow_reference.row(size, [shots[look] for *_, look in panels])
    looks = [look for *_, look in panels] if shading is SceneShading.LIT else []
    lines = [line for shown in zip(row, looks, strict=False) for line in _lines(*shown, looks, sun)]
    return shadow_reference.overlaid(picture, lines) if lines else picture


@lru_cache(maxsize=4)
def truth(size, sun, look=WHOLE):
    """What rays say of a panel of ``size`` pixels: agreement.Truth, of a light that is the basic map's."""
    scene, view = avenue.avenue(detail_of(size)), camera_of(look, Panel(0, 0, size, size))
    return agreement.truth_of(scene, view, light_space.whole_scene_camera(scene, sun, view))


def agreements(picture, size, panels, sun, mixture=frustum_slices.LAMBDA):
    """An agreement.Agreement for each panel of a picture [size, n size, 3] of ``SceneShading.MASK``.

    A slice's pixels are compared with its own camera's texels. Only surfaces that face the light are
    compared. Other pixels are dark whatever the map says.
    """
    scene, out = avenue.avenue(detail_of(size)), []
    for number, (fit, ratio, slices, look) in enumerate(panels):
        rays = truth(size, sun, look)
        facing = dot(rays.shown.normals, np.array(sun)) > 0.0
        mask = agreement.lit_mask(picture[:, number * size : (number + 1) * size])
        kinds = np.zeros(mask.shape, np.uint8)
        for part in parts_for(fit, ratio, slices, size, scene, sun, mixture):
            where = between(part.planes, rays) & facing
            found = agreement.compare(
                mask,
                replace(rays, lamp=part.camera),
                map_edge=edge_of(size, ratio),
                where=where,
            )
            kinds[where] = found.kinds[where]
        counts = np.bincount(kinds.ravel(), minlength=agreement.OTHER + 1).tolist()
        total = sum(counts[1:])
        agreeing = counts[agreement.AGREES] / total
        out.append(agreement.Agreement(total, agreeing, *counts[agreement.SILHOUETTE :], kinds))
    return out


def machine_agreements(figure, renderer, size, panels=None):
    """``agreements`` of the machine's picture of a figure, or of other ``panels`` with its maps."""
    changes = {} if panels is None else {"panels": panels}
    picture = renderer.machine_window(figure, size, shading=SceneShading.MASK, **changes)
    values = {**figure.values, **changes}
    mixture = values.get("mixture", frustum_slices.LAMBDA)
    return agreements(picture, size, values["panels"], values["sun"], mixture)


def shown_and_whole(figure, renderer, size):
    """``agreements`` of the near shadow, with the machine's maps of the magnified panels; and of the same
    maps over the whole view.
    """
    near = tuple((*panel[:3], NEAR_SHADOW) for panel in figure.values["panels"] if panel[3] in MAGNIFIED)
    whole = tuple((*panel[:3], WHOLE) for panel in near)
    shown, found = (machine_agreements(figure, renderer, size, panels) for panels in (near, whole))
    return shown, found


@lru_cache(maxsize=2)
def _things(size, panel, sun, background, mixture):
    """What each thing changes of a panel in each of its slices: ``each_thing.changes_of``."""
    fit, ratio, slices, look = panel
    rays = truth(size, sun, look)
    parts = parts_for(fit, ratio, slices, size, avenue.avenue(detail_of(size)), sun, mixture)
    regions = [between(part.planes, rays) for part in parts] if look == WHOLE else ()
    shot = shadow_reference.Shot(avenue.avenue(detail_of(size)), rays.view, (rays.lamp,), background)
    return each_thing.changes_of(shot, regions)


def things_checks(data, figure, renderer):
    """The Checks that magnified panels, and whole ones with slices, show each thing's light and its shadow.

    One map of the whole view has too few texels for the shadows of what is far away.
    """
    p, asked = figure.values, {}
    for number, (fit, ratio, slices, look) in enumerate(p["panels"]):
        # However many texels a map has, a magnified panel shows the same things.
        panel = (parted_shadow_maps.MapFit.BASIC, 1.0, 1, look) if look in MAGNIFIED else None
        if look == WHOLE and slices > 1:
            panel = fit, ratio, slices, look
        if panel is not None:
            mixture = p.get("mixture", frustum_slices.LAMBDA)
            asked[number] = _things(figure.size, panel, p["sun"], p["background"], mixture)
    yield from each_thing.checks(data, figure, renderer, asked)


def between(planes, rays):
    """Pixels whose surface lies between clip planes of eye coordinates: bool [h, w]."""
    modelview = np.array(rays.view.modelview)
    eye = rays.shown.points @ modelview[:3, :3].T + modelview[:3, 3]
    inside = np.ones(eye.shape[:2], np.bool_)
    for plane in planes:
        inside &= eye @ np.array(plane[:3]) + plane[3] >= 0.0
    return inside


def wrong(found, rows=slice(None)):
    """The fraction of compared pixels that differ, in some of the picture's rows."""
    kinds = found.kinds[rows]
    return float((kinds > agreement.AGREES).sum() / max((kinds > agreement.NOT_COMPARED).sum(), 1))


def others(found, bound=5e-4, measured=0.0002):
    """The check that next to no differing pixel is without a reason."""
    return Check(
        "pixels that differ from rays without a reason, largest share",
        max(f.other / f.compared for f in found),
        at_most=bound,
        on=Answer.MACHINE,
        reason="texels at the edge of two faces have the one's polygon offset and shade the other, on "
        f"crowns of trees and on the far gate; measured {measured}",
    )


def nearest_rows(size):
    """The rows of the nearest part of the screen, bottom row first."""
    return slice(0, int(NEAREST * size))


def mean_footprints(camera, edge, rays):
    """How large texels are on the ground, in pixels, in the mean over the nearest and the farthest rows."""
    size = rays.view.panel.height
    ground = rays.shown.object == 0
    rows = np.nonzero(ground.any(axis=1))[0]
    count = max(int(FARTHEST * len(rows)), 1)
    out = []
    for chosen in (np.arange(int(NEAREST * size)), rows[-count:]):
        here = np.zeros_like(ground)
        here[chosen] = True
        here &= ground
        points = rays.shown.points[here]
        normals = np.broadcast_to([0.0, 1.0, 0.0], points.shape)
        sizes = light_space.texel_footprints(camera.texture_matrix, edge, rays.view, points, normals)
        out.append(float(sizes.mean()))
    return tuple(out)
