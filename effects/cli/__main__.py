"""``python -m effects.cli``: the command line of a checkout, without installing it."""

from effects.cli import main

main(prog_name="fixedpipe")
