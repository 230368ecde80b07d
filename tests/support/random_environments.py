"""Random texture environments that a machine takes, for whole frames and for programs alone."""

from fixedpipe.pipeline.enums import (
    BaseFormat,
    CombineFunction,
    CombineOperand,
    CombineSource,
    TextureEnvironmentMode,
)
from fixedpipe.pipeline.state import Combine, TextureEnvironment
from fixedpipe.pipeline.textures.images import BASE_FORMAT, DEPTH_TEXELS

BYTES = (0, 1, 127, 128, 129, 254, 255)
_MODE, _FUNCTION, _SOURCE = TextureEnvironmentMode, CombineFunction, CombineSource
_ALPHAS = (CombineOperand.SRC_ALPHA, CombineOperand.ONE_MINUS_SRC_ALPHA)
_OWN = (_SOURCE.TEXTURE, _SOURCE.CONSTANT, _SOURCE.PRIMARY_COLOR, _SOURCE.PREVIOUS)


def random_color(random):
    """A colour of bytes, those where sums and halves turn being frequent."""
    return tuple(
        (random.choice(BYTES) if random.random() < 0.6 else random.randrange(256)) / 255.0 for _ in range(4)
    )


def _sources(profile):
    """Sources that the machine's environments read."""
    combine4 = _MODE.COMBINE4 in profile.combiners.texture_environment_modes
    sources = [*_OWN, *_OWN]
    if combine4:
        sources.append(_SOURCE.ZERO)
    if combine4 or profile.combiners.texture_environment_crossbar:
        sources += [_SOURCE(_SOURCE.TEXTURE0 + i) for i in range(profile.textures.max_texture_units)]
    return sources


def _combine(random, profile, mode, alpha):
    functions = profile.combiners.combine_functions
    if alpha:
        functions = functions - {_FUNCTION.DOT3_RGB, _FUNCTION.DOT3_RGBA}
    if mode is _MODE.COMBINE4:
        functions = functions & {_FUNCTION.ADD, _FUNCTION.ADD_SIGNED}
    operands = [random.choice(_ALPHAS if alpha else tuple(CombineOperand)) for _ in range(4)]
    if _FUNCTION.SUBTRACT not in profile.combiners.combine_functions and mode is not _MODE.COMBINE4:
        operands[2] = CombineOperand.SRC_ALPHA
    return Combine(
        random.choice(sorted(functions)),
        tuple(random.choice(_sources(profile)) for _ in range(4)),
        tuple(operands),
        random.choice((1.0, 1.0, 2.0, 4.0)),
    )


def random_environment(random, profile, internal_format):
    """A TextureEnvironment for a unit that reads a texture of this format. ``random``: a random.Random."""
    modes = sorted(profile.combiners.texture_environment_modes)
    colors = BASE_FORMAT[internal_format] in (BaseFormat.RGB, BaseFormat.RGBA)
    if internal_format in DEPTH_TEXELS or not colors:
        modes.remove(_MODE.DECAL)
    modes += [mode for mode in (_MODE.COMBINE, _MODE.COMBINE, _MODE.COMBINE4) if mode in modes]
    mode = random.choice(modes)
    if mode not in (_MODE.COMBINE, _MODE.COMBINE4):
        return TextureEnvironment(mode, random_color(random))
    return TextureEnvironment(
        mode,
        random_color(random),
        _combine(random, profile, mode, False),
        _combine(random, profile, mode, True),
    )
