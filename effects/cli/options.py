"""Options that several subcommands share."""

import click

profile_option = click.option(
    "--profile",
    metavar="NAME",
    default="GEFORCE_256",
    show_default=True,
    help="Machine.",
)
threads_option = click.option(
    "--threads",
    type=click.IntRange(min=1),
    metavar="N",
    help="Threads; any number gives the same bits.",
)
