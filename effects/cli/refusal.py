"""How the command line says no: the sentence on the error stream, and exit status 2."""

import click

from fixedpipe.effects.refusal import Refusal


class Said(click.ClickException):
    """A Refusal's sentence as the command line ends with it."""

    exit_code = 2

    def show(self, file=None):
        """Print the sentence."""
        click.echo(f"fixedpipe: {self.format_message()}", file=file, err=True)


def check_size(what, columns, size, profile):
    """Raise Refusal when a row of ``columns`` panels of ``size`` pixels is larger than the machine draws."""
    largest = profile.framebuffers.max_viewport
    if columns * size > largest:
        raise Refusal(
            f"{what} with --size {size} is {columns * size}x{size} pixels; the {profile.name} draws up to "
            f"{largest}x{largest}. Give --size {largest // columns} or less."
        )
