"""``python -m fixedpipe.effects.cli``: the command line, run by a chosen interpreter."""

from fixedpipe.effects.cli import main

if __name__ == "__main__":  # mpi4py.futures' working ranks import this module under another name
    main(prog_name="fixedpipe")
