"""Studies: what the hardware's short numbers, clamps and missing parts do, measured on the emulated machines.

One module per artefact, named by its id in lower case; ``STUDIES`` has them by id, in the catalogue's order.
"""

from effects.studies import (
    p4,
    p5,
    p6,
    p7,
    p8,
    p9,
    p10,
    p11,
    p15,
    p16,
    p17,
    p18,
    p19,
    p20,
    p21,
    p22,
    p23,
    p24,
    p30,
    p32,
    p35,
    p36,
    p37,
    p38,
    p39,
    p40,
)
from effects.studies.study import collected

_MODULES = (
    p4,
    p5,
    p6,
    p7,
    p8,
    p9,
    p10,
    p11,
    p15,
    p16,
    p17,
    p18,
    p19,
    p20,
    p21,
    p22,
    p23,
    p24,
    p30,
    p32,
    p35,
    p36,
    p37,
    p38,
    p39,
    p40,
)

STUDIES = collected(*(module.STUDY for module in _MODULES))
