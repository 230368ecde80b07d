"""``fixedpipe passes``: a figure's commands in words."""

import click

from effects.cli.options import profile_option


@click.command(short_help="Print a figure's passes in words.")
@click.argument("figure_id", metavar="ID")
@profile_option
def passes(figure_id, profile):
    """Print the pass sequence of figure ID: every command, and every state that differs from the default."""
    from effects.cli.refusal import choose, refusals
    from effects.figures import FIGURES
    from pipeline.describe import describe
    from pipeline.profiles import PROFILES

    figure = choose("figure", figure_id, FIGURES)
    machine = choose("profile", profile, PROFILES)
    with refusals():
        commands = figure.commands(machine)
    click.echo(f"{figure.id}: {figure.title} ({', '.join(figure.techniques)}), on {machine.name}\n")
    click.echo(describe(commands))
