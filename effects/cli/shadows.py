"""``fixedpipe shadows``: a mesh's shadow on a floor, by the algorithms of the time."""

import click

from fixedpipe.effects.cli.options import profile_option, threads_option, three_numbers


@click.command(short_help="Throw a mesh's shadow, and compare it with rays.")
@click.argument("mesh")
@click.option(
    "--algorithm",
    metavar="NAME",
    default="z-fail",
    show_default=True,
    help="depth-map, alpha-multitexture, alpha-single, z-pass or z-fail.",
)
@click.option(
    "--light",
    metavar="X,Y,Z",
    default="-3.5,6.5,3.5",
    show_default=True,
    help="Where the lamp is.",
)
@click.option("--out", metavar="FILE.png", required=True, help="The picture.")
@click.option(
    "--size", type=click.IntRange(min=8), metavar="N", default=512, show_default=True, help="Pixels an edge."
)
@profile_option
@click.option(
    "--up", metavar="AXIS", default="y", show_default=True, help="The mesh's upward axis: x, y or z."
)
@click.option(
    "--map-size",
    type=click.IntRange(min=8),
    metavar="N",
    help="Texels an edge of the shadow map, a power of two. Without it up to four for a pixel.",
)
@threads_option
def shadows(mesh, algorithm, light, out, size, profile, up, map_size, threads):
    """Throw the shadow of MESH, an OBJ or PLY file, on a floor, and say how it compares with rays.

    The mesh stands in the middle of the floor y = 0, 2.4 units large; the light's +x is right, +y up, +z
    towards you. depth-map is the shadow map with a depth texture; alpha-multitexture and alpha-single keep
    depths in alpha; z-pass and z-fail are shadow volumes, and need a mesh that is closed.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.refusal import Refusal, choose, refusals
    from fixedpipe.effects.reports.files import writable_picture, write_whole
    from fixedpipe.effects.reports.pictures import png
    from fixedpipe.effects.shadows.lit_scene import map_edge
    from fixedpipe.effects.user_pictures import mesh_shadows
    from fixedpipe.effects.user_pictures.inputs import read_mesh
    from fixedpipe.pipeline.profiles import PROFILES

    way = choose("algorithm", algorithm, mesh_shadows.ALGORITHMS)
    machine = choose("profile", profile, PROFILES)
    path = writable_picture(out)
    check_size("The picture", 1, size, machine)
    if not mesh_shadows.can_draw(algorithm, machine):
        able = ", ".join(mesh_shadows.machines_with(algorithm))
        raise Refusal(f"{profile} cannot draw {algorithm}, which takes {way.needs}. Give one of {able}.")
    if map_size and not way.map:
        raise Refusal(f"{algorithm} has no map; leave --map-size out, or give an algorithm with one.")
    position = three_numbers(light, "The lamp's place", "-3,6,4", zero=True)
    edge = map_size or min(map_edge(size, 4), machine.max_texture_size)
    if edge & (edge - 1) or edge > machine.max_texture_size:
        raise Refusal(
            f"The map's edge is {edge} texels; give a power of two up to {machine.max_texture_size}, the "
            f"{machine.name}'s largest."
        )
    with refusals():
        read = read_mesh(mesh)
        mesh_shadows.check_closed(algorithm, read, mesh)
        surface = mesh_shadows.stood_on_floor(read, up)
        scene = mesh_shadows.scene_of(surface, mesh)
        lamp = mesh_shadows.lamp_at(scene, position)
        announce_compiling()
        result, found = _drawn(algorithm, scene, lamp, machine, size, edge, threads)
    write_whole(path, png(result.image()))
    click.echo(f"{path}: {way.title}, {result.fragments} fragments on the {machine.name}")
    click.echo(f"shadows against rays: {found}")


def _drawn(algorithm, scene, lamp, machine, size, edge, threads):
    """The picture, and the ``Agreement`` of its mask with rays."""
    from fixedpipe.effects.acceptance import agreement
    from fixedpipe.effects.geometry.views import BACKGROUND, Panel
    from fixedpipe.effects.user_pictures import mesh_shadows
    from fixedpipe.pipeline.execution.machine import execute

    view = mesh_shadows.camera(Panel(0, 0, size, size))
    common = {"edge": edge, "background": BACKGROUND}
    drawn = [
        execute(
            mesh_shadows.commands(algorithm, scene, lamp, machine, size, shading=shading, **common),
            machine,
            size,
            size,
            threads=threads,
        )
        for shading in ("lit", "mask")
    ]
    truth = agreement.truth_of(scene, view, lamp)
    if algorithm == "z-pass" and mesh_shadows.in_shadow(truth.caster, view.eye, lamp):
        click.echo(
            "The viewer is in the mesh's shadow, where z-pass counts wrong; give --algorithm z-fail.",
            err=True,
        )
    framebuffer = drawn[1].framebuffer
    mask = agreement.lit_mask(framebuffer.color[::-1] / (2.0**framebuffer.color_bits - 1.0))
    understood = {"contact": mesh_shadows.hidden_distance(algorithm, lamp), "grazing": 0.1}
    if mesh_shadows.ALGORITHMS[algorithm].map:
        understood["map_edge"] = edge
    return drawn[0], agreement.compare(mask, truth, **understood)
