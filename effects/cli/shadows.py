"""``fixedpipe shadows``: draw a mesh's shadow on a floor, by the algorithms of the time."""

import click

from fixedpipe.effects.cli.options import profile_option, threads_option, three_numbers


@click.command(short_help="Draw a mesh's shadow, and compare it with ray casting.")
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
    help="Position of the lamp.",
)
@click.option(
    "--view", metavar="X,Y,Z", default="0.6,3.48,7.6", show_default=True, help="Direction to the eye."
)
@click.option("--out", metavar="FILE.png", required=True, help="Write the picture to this file.")
@click.option(
    "--size",
    type=click.IntRange(min=8),
    metavar="N",
    default=512,
    show_default=True,
    help="Width and height of the picture in pixels.",
)
@profile_option
@click.option(
    "--up", metavar="AXIS", default="y", show_default=True, help="The mesh's upward axis: x, y or z."
)
@click.option(
    "--map-size",
    type=click.IntRange(min=8),
    metavar="N",
    help="Width and height of the shadow map in texels, a power of two. Default: up to four times --size.",
)
@threads_option
def shadows(mesh, algorithm, light, view, out, size, profile, up, map_size, threads):
    """Draw the shadow of MESH, an OBJ or PLY file, on a floor, and compare it with ray casting.

    The mesh stands on the floor y = 0, and is scaled to 2.4 units. For --light and --view, +x is right, +y up
    and +z towards you. The command makes the floor so wide and puts the eye so far away that the picture
    holds the shadow.

    The algorithm depth-map is a shadow map in a depth texture. alpha-multitexture and alpha-single store the
    map's depths in alpha. z-pass and z-fail are shadow volumes, and need a closed mesh.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.progress import progress_of_long
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.refusal import Refusal, choose, refusals
    from fixedpipe.effects.reports.files import writable_picture, write_whole
    from fixedpipe.effects.user_pictures import mesh_shadows
    from fixedpipe.effects.user_pictures.inputs import read_mesh
    from fixedpipe.pipeline.framebuffers.pictures import png
    from fixedpipe.pipeline.profiles import PROFILES

    way = choose("algorithm", algorithm, mesh_shadows.ALGORITHMS)
    machine = choose("profile", profile, PROFILES)
    path = writable_picture(out, (mesh,))
    check_size("The picture", (size, size), machine)
    told: list[str] = []
    with refusals():
        mesh_shadows.check_machine(algorithm, profile)
        if map_size and not way.map:
            raise Refusal(f"{algorithm} has no map; leave --map-size out, or give an algorithm with one.")
        position = three_numbers(light, "The lamp's place", "-3,6,4", zero=True)
        toward = three_numbers(view, "The direction to the eye")
        edge = mesh_shadows.checked_map_edge(size, machine, map_size)
        read = read_mesh(mesh, tell=told.append)
        mesh_shadows.check_closed(algorithm, read, mesh)
        surface = mesh_shadows.stood_on_floor(read, up)
        stage = mesh_shadows.stage(surface, position, mesh, toward)
        announce_compiling()
        with progress_of_long(1) as step:
            step("the shadow, and rays to compare it with")
            found = mesh_shadows.drawn(algorithm, stage, machine, size, edge, threads)
    if algorithm == "z-pass" and found.viewer_in_shadow:
        click.echo(
            "The viewer is in the mesh's shadow, where z-pass counts wrong; give --algorithm z-fail.",
            err=True,
        )
    write_whole(path, png(found.picture.image))
    for line in told:
        click.echo(line)
    if not stage.whole:
        click.echo("The shadow ends on no floor that is drawn; a higher lamp, --light, keeps it there.")
    click.echo(f"{path}: {way.title}, {found.picture.summary}")
    click.echo(f"shadows against rays: {found.agreement}")
