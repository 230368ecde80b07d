"""The cost of each figure: the cheapest are drawn first, and the total time is estimated before."""

import math

# On which SECONDS were measured.
PROCESSOR = "one core of an AMD EPYC (family 25)"
# Processor seconds of a figure on all its machines with its acceptance checks, by id.
# Measured: time.process_time around fixedpipe.effects.reports.figure_record.render, one thread, kernels in
# the cache. Of documents 000, 001 and 002 on family 26, beside other work.
SECONDS = {
    "F000-1": 0.5,
    "F000-2": 31,
    "F000-3": 16,
    "F000-4": 51,
    "F000-5": 105,
    "F000-6": 2.2,
    "F000-7": 42,
    "F000-8": 0.8,
    "F000-9": 26,
    "F000-10": 1.6,
    "F000-11": 7.5,
    "F000-12": 2.2,
    "F000-13": 38,
    "F001-1": 2.2,
    "F001-2": 30,
    "F001-3": 0.7,
    "F001-4": 0.3,
    "F001-5": 0.7,
    "F001-6": 1.2,
    "F001-7": 0.8,
    "F001-8": 0.4,
    "F001-9": 4.9,
    "F001-10": 20,
    "F001-11": 16,
    "F001-12": 29,
    "F001-13": 7.9,
    "F001-14": 0.4,
    "F001-15": 0.8,
    "F001-16": 1.3,
    "F001-17": 0.7,
    "F002-1": 55,
    "F002-2": 2.2,
    "F002-3": 0.9,
    "F002-4": 7.8,
    "F002-5": 7.2,
    "F002-6": 1.5,
    "F002-7": 1.7,
    "F002-8": 2.7,
    "F002-9": 3.5,
    "F002-10": 8.1,
    "F002-11": 13,
    "F002-12": 19,
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
    "G03": 2.8,
    "G15": 16,
    "G17": 6.1,
    "G20": 4.7,
    "G21": 4.8,
    "G22": 7,
    "G26": 4.3,
    "G27": 2.1,
    "G28": 3.1,
    "G31": 1.8,
    "G36": 1.4,
    "H10": 17,
    "H11": 26,
    "H13": 31,
    "H16": 13,
    "H18": 17,
    "H20": 23,
    "H21": 39,
    "H22": 31,
    "H24": 8.7,
    "H25": 58,
    "H30": 70,
    "H31": 7.2,
    "H32": 24,
    "H33": 25,
    "H34": 8.1,
    "H35": 5.2,
    "H36": 9.3,
    "H37": 13,
    "H38": 16,
    "H40": 9.7,
    "H43": 17,
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
    "T002-1": 9,
    "S07": 54,
    "S10": 39,
    "S13": 7.2,
    "S14": 13,
    "S15": 27,
    "S21": 5.0,
    "S22": 58,
    "S23": 4.4,
    "S24": 20,
    "Z05": 4.3,
    "Z06": 4.8,
    "Z13": 38,
    "Z14": 9.5,
    "Z16": 14,
    "Z21": 1.7,
    "Z23": 19,
    "Z27": 2.6,
}


# The share of these seconds that a figure's first picture takes: on its first machine and by the ideal.
# Measured: as SECONDS, of 29 figures, every fifth from the dearest to the cheapest.
_OF_THE_FIRST = 0.19


def seconds_of(figures, machines=None):
    """Processor seconds of figures on some of their machines, with checks; ``machines``: {id: names}. None:
    of their first pictures.
    """
    if machines is None:
        return sum(_OF_THE_FIRST * SECONDS[figure.id] for figure in figures)
    return sum(SECONDS[f.id] * len(machines[f.id]) / len(f.machines) for f in figures)


def longest_after_the_first(figures):
    """The cheapest figure first, so that one is ready soon. Then figures that were never measured, and the
    others from the longest down, so that several processes end at about the same time.
    """
    in_order = cheapest_first(figures)
    return [*in_order[:1], *reversed(in_order[1:])]


def cheapest_first(figures):
    """The figures in the order of their costs; those that were never measured come last, in the order
    given.
    """
    return sorted(figures, key=lambda figure: SECONDS.get(figure.id, math.inf))
