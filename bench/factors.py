"""How long a reflectance of 32^4 samples takes to become textures, by each of the ways."""

from bench.scattering import seconds_of

SIZE, TERMS = 32, 3


def measure(turns=3):
    """name -> seconds, medians of ``turns``: three separable terms first, which is the most that is done."""
    from fixedpipe.effects.reflectance import homomorphic_factors, separable_factors
    from fixedpipe.effects.reflectance.brdfs import BRDFS
    from fixedpipe.effects.reflectance.hemisphere_maps import AnalyticBRDF
    from fixedpipe.effects.reflectance.separable_factors import Fit

    brdf = AnalyticBRDF(BRDFS["ward_bounded"], {"alpha_x": 0.2, "alpha_y": 0.5})
    table = separable_factors.table(brdf, SIZE)
    steps = {
        "three separable terms": lambda: separable_factors.factored(table, TERMS),
        "one separable term": lambda: separable_factors.factored(table, 1),
        "one term by norms": lambda: separable_factors.factored(table, 1, Fit.NORMS),
        "homomorphic, samples included": lambda: homomorphic_factors.factored(brdf, SIZE),
        "the table's samples": lambda: separable_factors.table(brdf, SIZE),
    }
    return {name: seconds_of(step, turns) for name, step in steps.items()}
