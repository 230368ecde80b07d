"""Studies: what the hardware's short numbers, clamps and missing parts do, measured on the emulated machines.

One module per artefact, named by its id in lower case; ``STUDIES`` has them by id, in the catalogue's order.
"""

import importlib
import pkgutil
import re
from types import MappingProxyType


def _studies():
    """The STUDY of each module that is named by an id, p9 or p10, in the ids' order."""
    names = [m.name for m in pkgutil.iter_modules(__path__) if re.fullmatch(r"p\d+", m.name)]
    for name in sorted(names, key=lambda name: int(name[1:])):
        yield importlib.import_module(f"{__name__}.{name}").STUDY


STUDIES = MappingProxyType({study.id: study for study in _studies()})
