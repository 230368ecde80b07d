"""docs/machines.md, made of the profiles and of tests/support/features.py: ``python -m tests.machines``."""

from itertools import groupby
from pathlib import Path

from fixedpipe.pipeline.profiles import PROFILES
from tests.support.features import FEATURES

PAGE = Path(__file__).parents[1] / "docs" / "machines.md"

_HEAD = """\
# The machines, and what they have

With this page you can find a machine that has a feature, and choose a machine for your frame.

In the tables of features, "yes" means that the machine has the feature, and "-" that it has not. A number is
the machine's limit. Below each of these tables, a second one names the files that specify, implement and test
the features; you need it only to change the code. `fixedpipe profiles NAME` prints all values of a machine,
each with its evidence. [adding-things.md](adding-things.md) says how to add a machine or a feature.

`make machines` makes this page from `pipeline/profiles/` and `tests/support/features.py`, and a test fails if
it is stale. Tests try every entry. `validate` accepts a feature's commands exactly where the tables say so.
Elsewhere its message names the machine, and says what to do instead.

"""

# Columns of the tables: short names, as a dozen must fit.
_SHORT = {
    "OPENGL_1_2": "GL 1.2",
    "OPENGL_1_2_IMAGING": "imaging",
    "MULTITEXTURE": "multi",
    "GEFORCE_256": "GF 256",
    "GEFORCE_3": "GF 3",
    "NV2A": "NV2A",
    "OCTANE": "Octane",
    "INFINITE_REALITY": "IR",
    "G400": "G400",
    "TEXRAM": "Texram",
    "SCHILLING": "proposal",
    "FUTURE": "future",
    "IDEAL": "ideal",
}


def _row(cells):
    return "| " + " | ".join(cells) + " |"


def _table(head, rows):
    return "\n".join([_row(head), _row(["---"] * len(head)), *map(_row, rows)]) + "\n"


def _widths(bits):
    return " or ".join(map(str, bits))


def _depths(profile):
    fixed = _widths(b for b in profile.framebuffers.depth_bits if b > 0)
    return fixed if min(profile.framebuffers.depth_bits) > 0 else f"{fixed}, float"


def _machines():
    rows = [
        (
            f"`{name}`",
            _SHORT[name],
            p.description,
            str(p.textures.max_texture_units),
            str(p.combiners.max_general_combiners or "-"),
            _widths(p.framebuffers.color_bits),
            str(p.arithmetic.texture_bits),
            _depths(p),
        )
        for name, p in PROFILES.items()
    ]
    head = (
        "profile",
        "short name",
        "machine",
        "texture units",
        "general combiners",
        "color bits",
        "texel bits",
        "depth",
    )
    return _table(head, rows)


def mark(feature, profile):
    """A table's cell."""
    if not feature.has(profile):
        return "-"
    return "yes" if feature.limit is None else str(feature.limit(profile))


def _modules(paths):
    return ", ".join(f"`{path}`" for path in paths) or "-"


def _places(features):
    """Rows of where features are: one for all that are at the same places."""
    places = {}
    for f in features:
        places.setdefault((f.reference, f.implementation, f.tests), []).append(f.name)
    return [("; ".join(names), *map(_modules, place)) for place, names in places.items()]


def page():
    """The whole page as text."""
    parts = [_HEAD, "## Machines\n\n", _machines()]
    for group, features in groupby(FEATURES, lambda feature: feature.group):
        features = tuple(features)
        rows = [(f.name, *(mark(f, p) for p in PROFILES.values())) for f in features]
        parts += [
            f"\n## {group}\n\n",
            _table(("feature", *(_SHORT[name] for name in PROFILES)), rows),
            "\n",
            _table(("feature", "specification", "implementation", "tests"), _places(features)),
        ]
    return "".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page())
