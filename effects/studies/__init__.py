"""Studies: the effect of the hardware's short numbers, clamps and missing parts, measured on emulated
machines.

Each artefact has a module, named by its id and a few words. ``STUDIES`` has them by id, in the catalogue's
order.
"""

import re
import sys
from typing import TYPE_CHECKING

from fixedpipe.effects.collection import Collection

if TYPE_CHECKING:
    from fixedpipe.effects.studies.study import Study


def _identify(name):
    """The id in a module's name: P9 for p09_nine_bit_registers."""
    artefact = re.fullmatch(r"p(\d\d)_\w+", name)
    return artefact and f"P{int(artefact[1])}"


# How a study's module is named.
FORM = "p09_nine_bit_registers for P9: two digits, then words"
STUDIES: "Collection[Study]" = Collection(sys.modules[__name__], "STUDY", _identify, FORM, beside=("study",))
