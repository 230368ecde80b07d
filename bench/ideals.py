"""How long an ideal picture takes beside the machine's."""

import time

# A surface by two textures, one by tables, one under projected maps, and diagrams of a small machine picture.
FIGURES = {"F004-4": "GEFORCE_256", "F000-2": "GEFORCE_256", "F003-8": "GEFORCE_3", "F002-4": "GEFORCE_256"}


def measure(turns=3):
    """name -> [turns] of (processor seconds of the ideal's picture, of the machine's), on one thread.

    The machine's are of the picture with its fragments recorded, as the ideal needs them; the ideal's begin
    when those are there. One turn comes before, which is not counted.
    """
    from fixedpipe.effects.figures import FIGURES as KNOWN

    found = {}
    for name, machine in FIGURES.items():
        figure, taken = KNOWN[name], []
        for _ in range(turns + 1):
            start = time.process_time()
            drawn = figure.render(machine, figure.size, threads=1)
            drawn.image()
            between = time.process_time()
            drawn.ideal.image()
            taken.append((time.process_time() - between, between - start))
        found[name] = taken[1:]
    return found
