"""``python -m fixedpipe.effects.cli``: the command line, by the interpreter that has it."""

from fixedpipe.effects.cli import main

if __name__ == "__main__":  # the ranks that work for mpi4py.futures import this under another name
    main(prog_name="fixedpipe")
