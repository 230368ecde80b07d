"""Options that several subcommands share, and three numbers as an option gives them."""

import math

import click

from fixedpipe.effects.refusal import Refusal

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


def three_numbers(text, what, example="1,2,3", zero=False):
    """Three finite numbers, not all zero unless ``zero``, from ``x,y,z``. Raises Refusal, naming ``what``."""
    try:
        numbers = tuple(float(c) for c in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)) or not (zero or any(numbers)):
        not_zero = "" if zero else "not all zero, "
        raise Refusal(f"{what} is {text!r}; give three numbers, {not_zero}as {example}.")
    return numbers
