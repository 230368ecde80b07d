"""F003-12: why shadows are important, realism: two pairs with and without self-shadowing (Z29, Z23)."""

from fixedpipe.effects.acceptance import agreement, shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view, row_of_panels
from fixedpipe.effects.scenes import objects_and_lamps
from fixedpipe.effects.shadows import shadow_volumes
from fixedpipe.effects.shadows.lit_scene import SceneShading, lit_pass, unlit_pass
from fixedpipe.pipeline.commands import Clear

DATA = figure_data(__file__, "F003-12")

_LAMP = (3.6, 6.9, 1.2)
_BOWL = (
    *((0.0, 0.0), (0.95, 0.0), (0.95, 0.14), (0.62, 0.16), (0.60, 0.28), (0.2, 0.34), (0.14, 0.5)),
    *((0.14, 1.0), (0.3, 1.1), (0.8, 1.3), (0.86, 1.42), (0.78, 1.42), (0.4, 1.24), (0.0, 1.18)),
)


def gate():
    """Two steps, four pillars and a slab: boxes that reach a little into each other."""
    pillars = [surfaces.box(0.2, 1.1, 0.2).moved(x, 0.77, z) for x in (-0.62, 0.62) for z in (-0.36, 0.36)]
    return surfaces.joined(
        surfaces.box(2.1, 0.16, 1.5).moved(0.0, 0.08, 0.0),
        surfaces.box(1.7, 0.14, 1.14).moved(0.0, 0.18, 0.0),
        *pillars,
        surfaces.box(1.75, 0.2, 1.15).moved(0.0, 1.38, 0.0),
    )


def subjects(detail):
    """The two scenes: the gate, and a turned bowl on a stem."""
    floor = objects_and_lamps.Object(
        "floor", objects_and_lamps.floor(4.2, detail // 2), (0.62, 0.60, 0.56), closed=False
    )
    return (
        objects_and_lamps.Scene(
            (
                floor,
                objects_and_lamps.Object(
                    "gate", gate().rotated(rotation("y", 28.0)), (0.72, 0.58, 0.42), 0.1
                ),
            )
        ),
        objects_and_lamps.Scene(
            (floor, objects_and_lamps.Object("bowl", surfaces.lathe(_BOWL, detail), (0.30, 0.50, 0.55), 0.5))
        ),
    )


def camera(panel):
    """The camera of both pairs."""
    return perspective_view(panel, (-0.8, 3.6, 6.4), (-0.4, 0.55, 0.0), field_of_view=27.0, radius=4.0)


def without_self_shadows(scene, view, lamp, profile, shading):
    """Shadow volumes, object by object: each is lit where no other's shadow falls."""
    out, scissor = list(unlit_pass(scene, view, shading)), view.panel.scissor
    for thing in scene.objects:
        others = objects_and_lamps.Scene(tuple(o for o in scene.objects if o is not thing))
        alone = objects_and_lamps.Scene((thing,))
        out.append(Clear(label="stencil to zero", stencil=0, scissor=scissor))
        if any(o.closed for o in others.objects):
            volumes = shadow_volumes.shadow_volumes(others, lamp.homogeneous)
            operations = shadow_volumes.counting_operations(profile)
            out += shadow_volumes.z_pass_counts(volumes, view, operations)
        out += lit_pass(
            alone,
            view,
            lamp,
            shading,
            label="light where no other object is in its way",
            stencil_test=shadow_volumes.NOT_SHADOWED,
        )
    return tuple(out)


def scene(profile, size, *, shading, background):
    """The gate with self-shadows and without them, the bowl with and without."""
    out, panels = [], row_of_panels(4, size)
    for k, subject in enumerate(subjects(objects_and_lamps.detail_of(size))):
        lamp = objects_and_lamps.lamp_around(subject, _LAMP)
        for panel, passes in zip(
            panels[2 * k :], (shadow_volumes.z_pass, without_self_shadows), strict=False
        ):
            out += (panel.clear(background), *passes(subject, camera(panel), lamp, profile, shading))
    return tuple(out)


def checks(figure, renderer):
    """Each panel's mask against rays; the size of the self-shadows."""
    size, found, own, elsewhere = 256, [], [], 0
    mask = agreement.lit_mask(renderer.machine_window(figure, size, shading=SceneShading.MASK))
    view = camera(row_of_panels(1, size)[0])
    for k, subject in enumerate(subjects(objects_and_lamps.detail_of(size))):
        lamp = objects_and_lamps.lamp_around(subject, _LAMP)
        both = [mask[:, (2 * k + i) * size : (2 * k + i + 1) * size] for i in (0, 1)]
        for part, self_shadows in zip(both, (True, False), strict=True):
            truth = agreement.truth_of(subject, view, lamp, self_shadows)
            # Without its own volume no mask darkens an object where it is turned away: n.l does.
            where = None if self_shadows else agreement.cosines(truth) > 0.0
            found.append(agreement.compare(part, truth, where=where))
        shown = truth.shown
        differs = (both[0] != both[1]) & (agreement.cosines(truth) > 0.0)
        own.append(float(differs[shown.object == 1].mean()))
        elsewhere += int((differs & (shown.object == 0) & ~agreement.silhouettes(truth)).sum())
    return (
        *agreement.volume_checks({Answer.MACHINE: found}, 0.998),
        DATA.check(
            "least share of an object that faces the light and is in its own shadow", min(own), Answer.MACHINE
        ),
        DATA.check("pixels of the floor that differ within a pair", elsewhere, Answer.MACHINE),
    )


def reference(size, *, shading, background):
    """The shadows by rays, in every second panel without those that an object throws on itself."""
    view, shots = camera(row_of_panels(1, size)[0]), []
    for subject in subjects(objects_and_lamps.detail_of(size)):
        lamp = objects_and_lamps.lamp_around(subject, _LAMP)
        shots += [
            shadow_reference.Shot(subject, view, (lamp,), background, shading, self_shadows=own)
            for own in (True, False)
        ]
    return shadow_reference.row(size, shots)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "shading": word.SHADING(SceneShading.LIT),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("shadow volumes", scene, ("OPENGL_1_2", "GEFORCE_256")),),
    acceptance=checks,
    reference=reference,
)
