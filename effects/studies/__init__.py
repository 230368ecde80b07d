"""Studies: what the hardware's short numbers, clamps and missing parts do, measured on the emulated machines.

One module per artefact, named by its id in lower case; ``STUDIES`` has them by id.
"""

from effects.studies import p9
from effects.studies.study import collected

STUDIES = collected(p9.STUDY)
