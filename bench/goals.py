"""What is asked for: of every scene the least ratio to llvmpipe, of every figure its number."""

from bench.processor import ZEN_5

# The same with AVX-512 and with AVX2 alone, on one thread and on two.
_SCENES = {
    "a": 2.0,
    "a2": 2.0,
    "b": 2.0,
    "b2": 2.0,
    "c": 2.0,
    "d": 2.0,
    "e2": 2.5,
    "f2": 1.5,
    "f3": 1.5,
    "g": 3.0,
    "h": 2.0,
    "i": 1.2,
}
# What was asked of a Zen 5 with all of its vectors before, and is more.
_ZEN_5_WHOLE = {"b": 2.2, "b2": 2.2}
_FIGURES = {
    # A sixteenth of the 240 µs that it was on a Zen 2 when this was asked for.
    "teximage": 15,
    # What lighting may add to a Draw of 100 vertices.
    "lit": 50,
    # Ten times the column engine's 0.85 when this was asked for.
    "wide": 8.5,
    "cold": 25,
    "cached": 1.2,
    "help": 0.1,
    "scaling": 1.8,
    "memory": 400,
    "factors": 5,
    "probes": 0.5,
}
# Named for an Intel Xeon at 2.1 GHz (Emerald Rapids), those of draws and passes for an AMD EPYC (Zen 2), and
# taken for every other processor.
_OTHER = {
    "draws": 30,
    "passes": 30,
    "states": 200,
    "frames": 120,
    "first": 30,
    "ideal": 0.66,
    "all": 120,
    "fresh": 360,
}
_ZEN_5 = {
    "draws": 15,
    "passes": 15,
    "states": 120,
    "frames": 300,
    "first": 20,
    # An eighth of the 2.64 s that it was when this was asked for.
    "ideal": 0.33,
    "all": 60,
    "fresh": 180,
}


def goals(processor, limit=None):
    """name -> number asked for on a Processor that is limited as ``--cpu`` says.

    Scenes e, i and t have none, and no scene has where the limit is "generic".
    """
    is_zen_5 = processor.kind == ZEN_5
    scenes = {} if limit == "generic" else _SCENES
    more = _ZEN_5_WHOLE if is_zen_5 and limit is None else {}
    return scenes | more | _FIGURES | (_ZEN_5 if is_zen_5 else _OTHER)


def applied(processor):
    """Which goals hold, in words."""
    if processor.kind == ZEN_5:
        return "Goals: those for Zen 5."
    return "Goals: those for an Intel Xeon (Emerald Rapids), which hold for every processor but Zen 5."
