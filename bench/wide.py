"""How fast frames of twelve bits are drawn by kernels and by the column engine."""

from bench.measure import Repeated, clock_of, take_turns
from bench.scenes import SCENES

# A texture, two with combiners, depth test and blending, two levels of a texture, and small triangles.
MEASURED = ("b", "c", "d", "h", "t")
BITS, EDGE, LAYERS, TURNS = 12, 256, 4, 5


def machines(scene, threads=1):
    """A scene's machine with components of twelve bits: its textures in place, for either engine."""
    from fixedpipe.pipeline.execution.machine import Machine

    profile = scene.profile.with_precision(combiner_bits=BITS, texture_bits=BITS, framebuffer_bits=BITS)
    for engine in (None, "columns"):
        machine = Machine(profile, EDGE, EDGE, threads=threads, engine=engine)
        machine.run(scene.textures())
        yield machine


def measure(threads):
    """name -> (rates of kernels, of the column engine), Mfragments/s of every turn, in turn."""
    found = {}
    for name in MEASURED:
        scene = SCENES[name]
        frame = scene.frame(EDGE, LAYERS)
        parties = [Repeated(machine, frame, clock_of(threads)) for machine in machines(scene, threads)]
        drawn = next(machines(scene)).run(frame).fragments
        both = take_turns(parties, turns=TURNS)
        found[name] = tuple([drawn / seconds / 1e6 for seconds in taken] for taken in both)
    return found
