"""``fixedpipe pixel``: print the pixel that a machine draws of a small state, and its history."""

import click


@click.command(short_help="Print the expected pixel of a small state on a machine, with its history.")
@click.argument("file", metavar="STATE.json")
@click.option("--profile", metavar="NAME", help="The machine. Default: the one that the file names.")
@click.option("--brief", is_flag=True, help="Print only the expected pixel, in one line.")
@click.option(
    "--json", "json_file", metavar="FILE", help="Write the pixel and its history as JSON; - prints it."
)
def pixel(file, profile, brief, json_file):
    """Draw STATE.json (- for standard input) on a machine, and print the pixel that it names.

    STATE.json has a window, textures, and polygons with their states: combiners or environments, texture
    shaders, tests, blending, fog. docs/pixel-states.md explains it, and docs/pixel-state.schema.json is its
    JSON Schema. The pixel has every bit that the machine computes, so a test needs no tolerance.

    --json writes color (bytes, or the framebuffer's codes), depth (units), stencil, the ideal's color, and
    the history. docs/pixel-history.schema.json describes the history.
    """
    import json

    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.frames import check_files, write_file
    from fixedpipe.effects.cli.options import machine_of
    from fixedpipe.effects.pixel_states.drawing import expected_pixel
    from fixedpipe.effects.pixel_states.states import read_state
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.user_pictures.inputs import read_text

    if brief and json_file:
        raise Refusal("--brief and --json say how the pixel is given; leave one of them out.")
    prints = json_file == "-"
    name = "standard input" if file == "-" else file
    state = read_state(read_text(file), name)
    if (profile or state.machine) is None:
        raise Refusal(f'{name} names no machine; add "machine": "NV2A" for instance, or give --profile.')
    machine = machine_of(profile or state.machine)
    if not prints:
        check_files(json_file)
    announce_compiling("portable")
    expected = expected_pixel(state, machine)
    text = json.dumps(expected.as_json(machine), indent=1)
    if prints:
        click.echo(text)
    elif json_file:
        write_file(json_file, text + "\n")
    elif brief:
        click.echo(expected.sentence())
    else:
        _print_history(expected, name, machine)


def _print_history(expected, name, machine):
    from rich.console import Console

    from fixedpipe.effects.cli.history_text import history_text

    console = Console(highlight=False)
    console.print(
        f"{name} on {machine.name}: {expected.sentence()}", style="bold", markup=False, soft_wrap=True
    )
    console.print(history_text(expected.history), soft_wrap=True)
