"""The cost of each figure: the cheapest are drawn first, and how long all will take is said before."""

import math

# On which SECONDS were measured.
PROCESSOR = "one core of an AMD EPYC (family 25)"
# Processor seconds of a figure on all its machines with its acceptance checks, by id.
# Measured: time.process_time around fixedpipe.effects.reports.figure_record.render, one thread, kernels in
# the cache.
SECONDS = {
    "F000-6": 2.2,
    "F000-7": 42,
    "F002-6": 1.5,
    "F002-13": 26,
    "F003-1": 4.0,
    "F003-2": 2.7,
    "F003-3": 1.0,
    "F003-4": 0.8,
    "F003-5": 1.8,
    "F003-6": 0.6,
    "F003-7": 0.5,
    "F003-8": 11,
    "F003-9": 10,
    "F003-10": 24,
    "F003-11": 4.0,
    "F003-12": 4.0,
    "F003-13": 0.6,
    "F003-14": 1.4,
    "F003-15": 21,
    "F003-16": 0.9,
    "F003-17": 2.1,
    "F003-18": 6.4,
    "F003-19": 13,
    "F003-20": 1.5,
    "F003-21": 4.0,
    "F003-22": 5.0,
    "F003-23": 6.8,
    "F003-24": 5.0,
    "F003-25": 23,
    "F003-26": 27,
    "F004-1": 17,
    "F004-2": 46,
    "F004-3": 35,
    "F004-4": 96,
    "F004-5": 76,
    "F004-6": 112,
    "F004-7": 9.3,
    "F004-8": 21,
    "G15": 16,
    "G17": 6.1,
    "H34": 8.1,
    "H35": 5.2,
    "H36": 9.3,
    "H37": 13,
    "H38": 16,
    "H40": 9.7,
    "K02": 7.2,
    "K04": 8.8,
    "K05": 22,
    "K08": 21,
    "K11": 8.6,
    "K12": 14,
    "K13": 12,
    "K14": 4.1,
    "K15": 8.9,
    "K16": 5.1,
    "K17": 6.0,
    "K18": 12,
    "K22": 9.4,
    "K24": 15,
    "Z05": 4.3,
    "Z06": 4.8,
    "Z13": 38,
    "Z14": 9.5,
    "Z16": 14,
    "Z21": 1.7,
    "Z23": 19,
    "Z27": 2.6,
}


def cheapest_first(figures):
    """The figures in the order of their costs; what was never measured comes last, in the order given."""
    return sorted(figures, key=lambda figure: SECONDS.get(figure.id, math.inf))
