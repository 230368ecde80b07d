"""Whole random frames from a seed alone: what ``tests.fuzz`` draws with every engine and compares.

Unlike ``tests.support.strategies``, nothing here shrinks; it aims at what fast rasterization gets wrong:
small and thin triangles, shared edges, vertices on pixel centres, ratios of w, textures of one row,
coordinates at the ends of float64, states that change from draw to draw in one framebuffer, and draws that
wait in a queue while what they read is replaced.
"""

import random as scalars
from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.pipeline.commands import (
    BindTexImage,
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    GetTexImage,
    MakeCurrent,
    Mesh,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    BaseFormat,
    BlendEquation,
    BlendFactor,
    ColorWeights,
    ComparisonFunction,
    ComponentUsage,
    ConvolutionBorderMode,
    CullMode,
    DotProductMapping,
    Face,
    FogArithmetic,
    FogCoordinateSource,
    FogMode,
    FrontFace,
    InternalFormat,
    LineRasterization,
    LogicOperation,
    MagnificationThreshold,
    Mapping,
    MuxSelect,
    PolygonMode,
    PrimitiveType,
    ProductRounding,
    ProvokingVertex,
    Register,
    ShadeModel,
    TexelWord,
    TextureCompareMode,
    TextureFilter,
    TextureShaderOperation,
    TextureTarget,
    VertexStage,
    WindowOrigin,
    WrapMode,
)
from fixedpipe.pipeline.pixel_transfer import INITIAL_TRANSFER, ConvolutionFilter, PixelMaps, PixelTransfer
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, INFINITE_REALITY, NV2A, OCTANE
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.state import (
    IDENTITY,
    AlphaPortion,
    AlphaTest,
    Blending,
    ColorMask,
    ColorTable,
    CombinerInput,
    DepthClamp,
    DepthTest,
    FinalCombiner,
    Fog,
    GeneralCombiner,
    Light,
    Lighting,
    LineState,
    PassState,
    PointState,
    PolygonState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    Scissor,
    SignedComponents,
    StencilTest,
    TextureShaderStage,
    TextureUnit,
    VertexState,
    Viewport,
    WindowClip,
)
from fixedpipe.pipeline.textures.images import (
    COLORLESS_FORMATS,
    COMPONENT_BITS,
    DEPTH_TEXELS,
    FORMATS_OF_WORDS,
    SIGNED_FORMATS,
    Texture,
    texture_1d,
    texture_2d,
    texture_3d,
    texture_cube_map,
)
from fixedpipe.pipeline.textures.pixel_formats import (
    COMPONENT_TYPES,
    DEPTH_READABLE_AS,
    IMAGE_FORMATS,
    READABLE_AS,
)
from fixedpipe.pipeline.textures.words import internal_format_of, texture_of_words
from tests.support.combiner_words import READ_ONLY, SCALES_AND_BIASES, TEXTURE_REGISTERS, WRITABLE
from tests.support.random_environments import random_environment

_SMALL_AREA = 480  # pixels: the specification takes some 0.1 ms for each fragment
_COUNTED = (TextureFilter.NEAREST, TextureFilter.LINEAR)
_POLYGONS = tuple(p for p in PrimitiveType if p < PrimitiveType.POINTS)
_STROKES = tuple(p for p in PrimitiveType if p >= PrimitiveType.POINTS)
_USUAL_BLENDINGS = (
    Blending(BlendFactor.ONE, BlendFactor.ONE),
    Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA),
    Blending(BlendFactor.DST_COLOR, BlendFactor.ZERO),
)
_ZERO = CombinerInput()
_DEPTH = FogCoordinateSource.FRAGMENT_DEPTH
_ONE = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
_READ_FORMATS = (
    *("RGBA", "RGB", "RED", "GREEN", "BLUE"),
    *("ALPHA", "LUMINANCE", "LUMINANCE_ALPHA", "DEPTH_COMPONENT", "STENCIL_INDEX"),
)
# Edges of textures, narrow ones frequent; the last are left to frames whose machine takes them.
_EDGES = (1, 1, 2, 4, 8, 16, 32, 64)
_OTHER_WORDS = (  # signed ones, and words of sixteen bits
    TexelWord.V8U8,
    TexelWord.L6V5U5,
    TexelWord.X8L8V8U8,
    TexelWord.Q8W8V8U8,
    TexelWord.V16U16,
    TexelWord.R16B16,
    TexelWord.Y16,
)
_LONG = ((1, 4096), (4096, 1), (2048, 1), (1, 2048), (2048, 2), (4, 1024))


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame to draw.

    small  the specification draws it in a fraction of a second, if it is not wide
    wide   of a machine whose components have 8 to 12 bits
    """

    seed: int
    profile: Profile
    width: int
    height: int
    depth_bits: int
    commands: tuple
    small: bool
    wide: bool = False


def random_frame(seed, *, size=None, profile=None, depth_bits=None, begins_cleared=False, wide=False):
    """The frame of a seed: an int, 0 or more.

    size, profile, depth_bits   of the framebuffer and the machine; None: of the seed
    begins_cleared              whether everything a frame reads it has written before, so that a Machine that
                                drew others gives the same
    wide                        whether the machine's combiners, texels and framebuffer have 8 to 12 bits each
    """
    return _Maker(seed).frame(size, profile, depth_bits, begins_cleared, wide)


_OP = TextureShaderOperation
_WITHOUT_TEXEL = (_OP.NONE, _OP.CULL_FRAGMENT, _OP.DOT_PRODUCT, _OP.DOT_PRODUCT_DEPTH_REPLACE)
_FLAT, _CUBE = (TextureTarget.TEXTURE_2D,), (TextureTarget.TEXTURE_CUBE_MAP,)
_RECTANGLES = (TextureTarget.TEXTURE_RECTANGLE,)
_DEPENDENT = (  # operations, how many DOT_PRODUCT stages they follow, the targets that they read
    (_OP.DEPENDENT_AR_TEXTURE_2D, 0, _FLAT),
    (_OP.DEPENDENT_GB_TEXTURE_2D, 0, _FLAT),
    (_OP.OFFSET_TEXTURE_2D, 0, _FLAT),
    (_OP.OFFSET_TEXTURE_2D_SCALE, 0, _FLAT),
    (_OP.OFFSET_TEXTURE_RECTANGLE, 0, _RECTANGLES),
    (_OP.OFFSET_TEXTURE_RECTANGLE_SCALE, 0, _RECTANGLES),
    (_OP.DOT_PRODUCT_TEXTURE_2D, 1, _FLAT),
    (_OP.DOT_PRODUCT_TEXTURE_RECTANGLE, 1, _RECTANGLES),
    (_OP.DOT_PRODUCT_TEXTURE_3D, 2, (TextureTarget.TEXTURE_3D,)),
    (_OP.DOT_PRODUCT_TEXTURE_CUBE_MAP, 2, _CUBE),
    (_OP.DOT_PRODUCT_REFLECT_CUBE_MAP, 2, _CUBE),
    (_OP.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP, 2, _CUBE),
)


def _may_be_repeated(draw, since):
    """Whether a Draw is valid after the commands ``since``. They may give its texture another base format,
    which its environment does not take, or fewer levels than its filter reads.
    """
    stored = {c.texture for c in since if isinstance(c, TexImage | CopyTexImage)}
    return not any(
        unit is not None
        and unit.texture in stored
        and (draw.state.register_combiners is None or unit.sampler.min_filter not in _COUNTED)
        for unit in draw.state.texture_units
    )


class _Maker:
    """Draws a frame's parts; ``known``: what its commands made so far, by name."""

    def __init__(self, seed):
        self.seed = seed
        self.chooser, self.random = scalars.Random(seed), np.random.default_rng(seed)
        self.textures, self.surfaces, self.serial = {}, {}, 0

    # ---------------------------------------------------------------------------------- choices

    def one_of(self, choices):
        return self.chooser.choice(list(choices))

    def chance(self, probability):
        return self.chooser.random() < probability

    def whole(self, low, high):
        """A whole number, both ends included."""
        return self.chooser.randint(low, high)

    def uniform(self, low, high):
        return self.chooser.uniform(low, high)

    def maybe(self, probability, make):
        return make() if self.chance(probability) else None

    def name(self, what):
        self.serial += 1
        return f"{what} {self.serial}"

    def color(self):
        kind = self.whole(0, 3)
        if kind == 0:
            return tuple(self.one_of((0.0, 0.5, 1.0)) for _ in range(4))
        if kind == 1:
            return tuple(self.whole(0, 255) / 255.0 for _ in range(4))
        return tuple(self.uniform(-0.1 if kind == 2 else 0.0, 1.1) for _ in range(4))

    # ----------------------------------------------------------------------------------- frames

    def frame(self, size, profile, depth_bits, begins_cleared, wide):
        self.small = self.chance(0.7) if size is None else size[0] * size[1] <= _SMALL_AREA
        self.profile = profile or (self.wide_machine() if wide else self.machine())
        if wide:
            depth_bits = self.one_of(self.profile.framebuffers.depth_bits)
        self.plain = self.chance(0.4)  # common states alone
        self.window = self.width, self.height = size or self.size()
        if depth_bits is None:
            depth_bits = self.one_of((24, 24, 16, *self.profile.framebuffers.depth_bits))
        self.window_depth = self.depth_bits = int(depth_bits)
        commands = [self.tex_image(self.name("image")) for _ in range(self.whole(0, 3))]
        if begins_cleared:
            commands.append(Clear(label="begin", color=(0.0, 0.0, 0.0, 0.0), depth=1.0, stencil=0))
        elif self.chance(0.6):
            commands.append(self.clear())
        for _ in range(self.whole(1, 4 if self.small else 10)):
            commands += self.step(commands)
        if begins_cleared:  # what others may draw over before it is looked at
            commands.append(MakeCurrent(label="window"))
            commands += [self.read(name, whole=True) for name in ("RGBA", "DEPTH_COMPONENT", "STENCIL_INDEX")]
        drawn = self.window_depth, tuple(commands), self.small, wide
        return Frame(self.seed, self.profile, *self.window, *drawn)

    def wide_machine(self):
        """One of twelve bits that was built, or one that no one built, of widths that kernels have."""
        if self.chance(0.3):
            octane = OCTANE.with_precision(combiner_bits=12, framebuffer_bits=12)
            return self.one_of((INFINITE_REALITY, OCTANE, octane))
        bits = [self.one_of((8, 9, 10, 11, 12, 12)) for _ in range(3)]
        combiners, texels, framebuffer = bits if self.chance(0.5) else bits[:1] * 3
        machine = self.machine()
        if texels != 8:  # stages may read words of 16 bits, which such texels do not hold
            machine = machine.changed(texture_shader_operations=frozenset())
        return machine.with_precision(
            combiner_bits=combiners, texture_bits=texels, framebuffer_bits=framebuffer
        )

    def machine(self):
        """One that was built, or one that no one built, with every arithmetic that a profile has."""
        machine = self.one_of((GEFORCE_256, GEFORCE_256, GEFORCE_3, NV2A, NV2A))
        if self.chance(0.7):
            return machine
        fields = dict(
            expand_half=self.one_of((128, 127.5)),
            product_rounding=self.one_of(ProductRounding),
            round_before_scale=self.chance(0.5),
            clamp_low=self.one_of((-256, -255)),
            magnification_threshold=self.one_of(MagnificationThreshold),
            fog_arithmetic=self.one_of(FogArithmetic),
            device_origin=self.one_of(WindowOrigin),
            color_weights=self.one_of(ColorWeights),
            diamond_exit_lines=self.chance(0.5),
            max_probes=self.one_of((1, 8)),
            exact_probes=self.chance(0.5),
            shadow_ambient=self.chance(0.5),
            color_matrix=self.chance(0.5),
            color_tables=self.chance(0.5),
            max_color_table_size=16,
            convolution=self.chance(0.5),
            max_convolution_size=3,
            clamps_color_matrix=self.chance(0.5),
            depth_texture_modes=machine.textures.depth_texture_modes
            and (BaseFormat.INTENSITY, BaseFormat.LUMINANCE, BaseFormat.ALPHA),
        )
        if fields["diamond_exit_lines"]:  # no machine has them with other colours
            fields["color_weights"] = ColorWeights.EXACT
        return machine.changed(**fields)

    def size(self):
        if self.small:
            while True:
                width, height = self.one_of(
                    (
                        (self.whole(1, 24), self.whole(1, 24)),
                        (self.whole(8, 40), self.whole(8, 24)),
                        (self.whole(1, 6), self.whole(33, 100)),
                        (self.whole(33, 100), self.whole(1, 6)),
                        (16, 8),
                    )
                )
                if width * height <= _SMALL_AREA:
                    return width, height
        return self.one_of(
            (
                (self.whole(17, 200), self.whole(33, 170)),
                (self.whole(60, 130), self.whole(60, 130)),
                (self.whole(1, 20), self.whole(65, 300)),
                (self.whole(65, 300), self.whole(1, 20)),
                (128, 128),
            )
        )

    def step(self, before):
        """One thing that a frame does next, as commands."""
        draws = [c for k, c in enumerate(before) if type(c) is Draw and _may_be_repeated(c, before[k:])]
        what = self.chooser.random()
        if what < 0.6 or not draws:
            return [self.draw()]
        if what < 0.72:  # the same object again, or with another object's half
            repeated = self.one_of(draws)
            if self.chance(0.3):
                repeated = replace(repeated, mesh=self.mesh_for(repeated.state))
            return [repeated] * self.whole(1, 2)
        if what < 0.78:
            return [self.clear()]
        if what < 0.84:
            return [self.copy()]
        if what < 0.88:
            return self.replacement()
        if what < 0.90:
            return [self.read(self.one_of(_READ_FORMATS))]
        if what < 0.92:
            return self.query()
        if what < 0.95:
            redefinable = [name for name in self.textures if name.startswith("image")]
            if not redefinable:
                return [self.tex_image(self.name("image"))]
            return [self.tex_image(self.one_of(redefinable))]
        if self.profile.framebuffers.surface_formats:
            return self.other_surface()
        return [self.draw()]

    # ---------------------------------------------------------------------------- whole commands

    def draw(self):
        state = self.state()
        return Draw(label=self.name("draw"), mesh=self.mesh_for(state), state=state)

    def clear(self):
        masked = self.chance(0.2)
        return Clear(
            label=self.name("clear"),
            color=self.maybe(0.8, self.color),
            depth=self.maybe(0.8, lambda: self.one_of((0.0, 0.5, 1.0, 1.0, self.uniform(0.0, 1.0)))),
            stencil=self.maybe(0.6, lambda: self.one_of((0, 1, 255, self.whole(0, 255)))),
            scissor=self.maybe(0.25, self.scissor),
            color_mask=self.color_mask() if masked else ColorMask(),
            stencil_write_mask=self.whole(0, 255) if masked else 255,
        )

    def power_of_two(self, most):
        """A power of two up to ``most``."""
        return 1 << self.whole(0, most.bit_length() - 1)

    def copy(self):
        most = 8 if self.small else 64
        width, height = (self.power_of_two(min(edge, most)) for edge in (self.width, self.height))
        generate = self.chance(0.5)
        label = f"copy{' with levels' if generate else ''}"
        again = [n for n in self.textures if n.startswith(label)] if self.chance(0.3) else []
        name = self.one_of(again) if again else self.name(label)
        command = CopyTexImage(
            label="copy",
            texture=name,
            target=TextureTarget.TEXTURE_2D,
            internal_format=self.one_of(COMPONENT_BITS),
            x=self.whole(0, self.width - width),
            y=self.whole(0, self.height - height),
            width=width,
            height=height,
            generate_mipmap=generate,
            transfer=self.transfer(),
        )
        image = texture_2d(np.zeros((height, width, 4), np.uint8), command.internal_format, mipmaps=generate)
        self.textures[name] = image
        return command

    def replacement(self):
        names = [n for n, t in self.textures.items() if t.internal_format in COMPONENT_BITS]
        if not names:
            return [self.copy()]
        name = self.one_of(names)
        texture = self.textures[name]
        level = self.whole(0, len(texture.levels) - 1)
        faces, rows, columns = texture.levels[level].shape[:3]
        width, height = min(columns, self.width), min(rows, self.height)
        width, height = self.whole(0, width), self.whole(0, height)
        plain = texture.target in (TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_CUBE_MAP)
        return [
            CopyTexSubImage(
                label="replace",
                texture=name,
                x_offset=self.whole(0, columns - width),
                y_offset=self.whole(0, rows - height),
                x=self.whole(0, self.width - width),
                y=self.whole(0, self.height - height),
                width=width,
                height=height,
                level=level,
                face=self.whole(0, faces - 1),
                generate_mipmap=plain and level == 0 and len(texture.levels) > 1 and self.chance(0.5),
                transfer=self.transfer(),
            )
        ]

    def read(self, pixel_format, whole=False):
        if whole:
            return ReadPixels(label="read", name=f"whole {pixel_format}", format=pixel_format)
        width, height = self.whole(0, self.width), self.whole(0, self.height)
        return ReadPixels(
            label="read",
            name=self.name("pixels"),
            format=pixel_format,
            x=self.whole(0, self.width - width),
            y=self.whole(0, self.height - height),
            width=width,
            height=height,
            type=self.one_of(COMPONENT_TYPES) if pixel_format in IMAGE_FORMATS else "UNSIGNED_BYTE",
            transfer=self.transfer(),
        )

    def query(self):
        names = [n for n, t in self.textures.items() if t.internal_format in COMPONENT_BITS]
        if not names:
            return [self.copy()]
        name = self.one_of(names)
        texture = self.textures[name]
        volume = texture.target is TextureTarget.TEXTURE_3D
        level = self.whole(0, len(texture.levels) - 1)
        return [
            GetTexImage(
                label="query",
                name=self.name("pixels"),
                texture=name,
                level=level,
                face=0 if volume else self.whole(0, len(texture.levels[level]) - 1),
                format=self.one_of(IMAGE_FORMATS),
                type=self.one_of(COMPONENT_TYPES),
                transfer=self.transfer()
                if self.profile.pixels.transfers_texture_queries
                else INITIAL_TRANSFER,
            )
        ]

    def transfer(self):
        """Pixel transfer as far as the machine has it; no image becomes smaller."""
        if self.chance(0.6):
            return INITIAL_TRANSFER
        profile, more = self.profile, {}
        if profile.pixels.color_matrix:
            more["color_matrix"] = tuple(self.factors() for _ in range(4))
            more["post_color_matrix_bias"] = self.factors()
        if profile.pixels.color_tables:
            more["color_table"] = self.maybe(0.4, self.color_table)
            more["post_color_matrix_color_table"] = self.maybe(0.4, self.color_table)
        if profile.pixels.convolution and self.chance(0.4):
            rows = tuple(tuple(self.factors() for _ in range(2)) for _ in range(self.whole(1, 3)))
            modes = ConvolutionBorderMode.CONSTANT_BORDER, ConvolutionBorderMode.REPLICATE_BORDER
            border = self.one_of(BaseFormat), self.one_of(modes), self.factors()
            more["convolution_2d"] = ConvolutionFilter(rows, *border)
        return PixelTransfer(
            scale=self.factors(),
            bias=self.factors(),
            index_shift=self.whole(-2, 2),
            index_offset=self.whole(-9, 9),
            map_color=self.chance(0.3),
            map_stencil=self.chance(0.3),
            maps=PixelMaps(r_to_r=self.factors(), a_to_a=self.factors(), s_to_s=(7, 300, 0, 255)),
            **more,
        )

    def factors(self):
        return tuple(self.one_of((0.0, 0.5, 1.0, self.uniform(-1.0, 2.0))) for _ in range(4))

    def color_table(self):
        entries = tuple(self.factors() for _ in range(2 ** self.whole(0, 4)))
        return ColorTable(entries, self.one_of(BaseFormat), self.one_of((None, 4, 8)))

    def other_surface(self):
        """To a pbuffer and back, or a pbuffer as a texture."""
        if self.surfaces and self.chance(0.5):
            surface = self.one_of(list(self.surfaces.values()))
            return [self.bind(surface)]
        if (self.width, self.height) != self.window or (self.surfaces and self.chance(0.5)):
            (self.width, self.height), self.depth_bits = self.window, self.window_depth
            return [MakeCurrent(label="window")]
        color_format = self.one_of(self.surface_formats())
        depth_bits = int(self.one_of(self.profile.framebuffers.depth_bits))
        most = 16 if self.small else 64
        width, height = self.power_of_two(most), self.power_of_two(most)
        if self.chance(0.3):
            width, height = self.whole(1, most), self.whole(1, most)
        shared = {}
        owners = {None: (*self.window, self.window_depth)} | {
            s.surface: (s.width, s.height, s.depth_bits) for s in self.surfaces.values() if not s.shares_depth
        }
        if self.profile.framebuffers.shared_depth and self.chance(0.4):
            of = self.one_of(list(owners))
            across, up, depth_bits = owners[of]
            width, height = self.whole(1, min(across, most)), self.whole(1, min(up, most))
            shared = {"shares_depth": True, "depth_of": of}
        name = f"{width}x{height} {color_format.name} {depth_bits}{f' of {of}' if shared else ''}"
        command = MakeCurrent(
            label="pbuffer",
            surface=name,
            width=width,
            height=height,
            color_format=color_format,
            depth_bits=depth_bits,
            **shared,
        )
        self.surfaces[name] = command
        self.width, self.height, self.depth_bits = width, height, depth_bits
        if shared:  # what is there decides
            return [command, self.draw(), self.draw()]
        cleared = Clear(label="begin", color=(0.0, 0.0, 0.0, 0.0), depth=1.0, stencil=0)
        return [command, cleared, self.draw()]

    def surface_formats(self):
        return sorted(self.profile.framebuffers.surface_formats)

    def bind(self, surface):
        two = not (surface.width & (surface.width - 1) or surface.height & (surface.height - 1))
        target = TextureTarget.TEXTURE_2D if two else TextureTarget.TEXTURE_RECTANGLE
        formats = READABLE_AS[surface.color_format]
        deep = self.chance(0.4)
        internal_format = DEPTH_READABLE_AS[surface.depth_bits] if deep else self.one_of(formats)
        name = f"bound {target.name} {'depth' if deep else 'color'}"
        texels = np.zeros((1, surface.height, surface.width, 4), np.uint8)
        self.textures[name] = Texture(target, internal_format, (texels,))
        return BindTexImage(
            label="bind",
            texture=name,
            surface=surface.surface,
            target=target,
            internal_format=internal_format,
            origin=self.one_of(WindowOrigin),
        )

    # --------------------------------------------------------------------------------- textures

    def texels(self, *shape):
        """Random bytes; 0 and 255 are frequent in some."""
        bytes_ = self.random.integers(0, 256, (*shape, 4), np.uint8)
        if self.chance(0.3):
            extreme = self.random.random(bytes_.shape) < 0.4
            bytes_[extreme] = self.random.choice(np.array([0, 255], np.uint8), extreme.sum())
        return bytes_

    def tex_image(self, name):
        """A new texture object, or another image of one: of the same target, with levels if it had, and of
        the same words.
        """
        old = self.textures.get(name)
        if old is None:
            target = TextureTarget.TEXTURE_2D
            if not self.plain and self.chance(0.25):
                target = self.one_of(sorted(self.profile.textures.texture_targets))
            deep = target is TextureTarget.TEXTURE_2D and self.shadows() and self.chance(0.15)
            mipmaps, kind = self.chance(0.5), None
            stored = self.profile.textures.internal_formats
            kinds = [kind for kind in _OTHER_WORDS if internal_format_of(kind) in stored]
            if kinds and target is TextureTarget.TEXTURE_2D and not (deep or mipmaps) and self.chance(0.15):
                kind = self.one_of(kinds)
        else:
            target, deep = old.target, old.internal_format in DEPTH_TEXELS
            kind = next((k for k in _OTHER_WORDS if internal_format_of(k) is old.internal_format), None)
            mipmaps = len(old.levels) == max(old.width, old.height).bit_length()
        width, height = self.one_of(_EDGES), self.one_of(_EDGES)
        if not self.small and self.chance(0.1):
            width, height = 256, self.one_of((1, 128, 256))
        if self.chance(0.12):
            limit = self.profile.textures.max_texture_size
            width, height = self.one_of([s for s in _LONG if max(s) <= limit])
        if kind is None:
            image = self.image(target, deep, mipmaps, width, height)
        else:
            image = texture_of_words(self.random.integers(0, 1 << 32, (height, width)), kind)
        self.textures[name] = image
        return TexImage(label=name, texture=name, image=image)

    def shadows(self):
        return len(self.profile.textures.texture_compare_modes) > 1

    def image(self, target, deep, mipmaps, width, height):
        if deep:
            kinds = [TexelWord.Y16_FIXED, TexelWord.X8_Y24_FIXED]
            if not self.profile.textures.depths_as_colors:  # floats are only compared
                kinds.append(TexelWord.Y16_FLOAT)
            kind = self.one_of(
                [k for k in kinds if internal_format_of(k) in self.profile.textures.internal_formats]
            )
            shift = 8 if kind is TexelWord.X8_Y24_FIXED else 0
            most = 8 if self.small else 64  # the specification compares every texel for every fragment
            words = self.random.integers(0, 1 << 16, (min(height, most), min(width, most))) << shift
            return texture_of_words(words, kind)
        internal_format = self.one_of(COMPONENT_BITS) if self.chance(0.4) else InternalFormat.RGBA8
        if target is TextureTarget.TEXTURE_1D:
            return texture_1d(self.texels(width), internal_format, mipmaps=mipmaps)
        if target is TextureTarget.TEXTURE_CUBE_MAP:
            edge = min(width, height, 16)
            return texture_cube_map(self.texels(6, edge, edge), internal_format, mipmaps=mipmaps)
        if target is TextureTarget.TEXTURE_3D:
            shape = self.one_of((1, 2, 4)), min(height, 16), min(width, 16)
            if mipmaps:
                return texture_3d(self.texels(*shape), internal_format, mipmaps=True)
            words = self.random.integers(0, 1 << 32, shape)
            return texture_of_words(words, TexelWord.A8R8G8B8, TextureTarget.TEXTURE_3D)
        if target is TextureTarget.TEXTURE_RECTANGLE:
            width, height = self.whole(1, 20), self.whole(1, 20)
            levels = texture_2d(self.texels(height, width), internal_format).levels
            return Texture(target, internal_format, levels)
        return texture_2d(self.texels(height, width), internal_format, mipmaps=mipmaps)

    def sampler(self, texture):
        deep = texture.internal_format in DEPTH_TEXELS
        rectangle = texture.target is TextureTarget.TEXTURE_RECTANGLE
        complete = len(texture.levels) == max(texture.width, texture.height, texture.depth).bit_length()
        mipmapped = complete and not rectangle
        wraps = (
            (WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE)
            if self.plain
            else sorted(self.profile.textures.wrap_modes)
        )
        if rectangle:
            wraps = (WrapMode.CLAMP, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_BORDER)
        mag = self.one_of(_COUNTED)
        sampler = Sampler(
            min_filter=mag if self.chance(0.3) else self.one_of(TextureFilter if mipmapped else _COUNTED),
            mag_filter=mag,
            wrap_s=self.one_of(wraps),
            wrap_t=self.one_of(wraps),
            wrap_r=self.one_of(wraps),
            border_color=self.color(),
        )
        if deep:
            modes = sorted(self.profile.textures.texture_compare_modes - {TextureCompareMode.NONE})
            sampler = replace(
                sampler,
                compare_mode=self.one_of(modes),
                compare_function=self.one_of(sorted(self.profile.textures.shadow_functions)),
                depth_texture_mode=self.one_of((None, *self.profile.textures.depth_texture_modes)),
            )
            if self.profile.textures.shadow_ambient and self.chance(0.5):
                sampler = replace(sampler, compare_fail_value=self.uniform(0.0, 1.0))
            if self.profile.textures.depths_as_colors and self.chance(0.4):
                sampler = replace(sampler, compare_mode=TextureCompareMode.NONE, compare_fail_value=0.0)
        if self.plain or deep:
            return sampler
        if mipmapped and self.chance(0.1):
            sampler = replace(sampler, min_lod=self.uniform(-2.0, 3.0), max_lod=self.uniform(-2.0, 6.0))
        if mipmapped and self.chance(0.1):
            sampler = replace(sampler, max_level=self.whole(0, 8))
        if self.chance(0.1):
            base = self.whole(0, len(texture.levels) - 1)
            sampler = replace(sampler, base_level=base, max_level=max(base, sampler.max_level))
        most = self.profile.textures.max_anisotropy
        of_bytes = texture.internal_format not in FORMATS_OF_WORDS
        if most > 1 and of_bytes and texture.target is TextureTarget.TEXTURE_2D and self.chance(0.06):
            sampler = replace(sampler, max_anisotropy=self.one_of((most, min(2.0, most), 1.5)))
        elif (
            self.profile.textures.max_probes > 1
            and of_bytes
            and texture.target is TextureTarget.TEXTURE_2D
            and self.chance(0.2)
        ):
            sampler = replace(sampler, max_probes=self.one_of((2, 4, 8)))
            if self.profile.textures.exact_probes and self.chance(0.5):
                sampler = replace(sampler, max_probes=self.whole(2, 8), exact_probes=True)
        if self.profile.textures.signed_components and self.chance(0.05):
            signs = SignedComponents(*(self.chance(0.5) for _ in range(4)))
            sampler = replace(sampler, signed_components=signs)
        return sampler

    def unit(self, sets):
        name = self.one_of(list(self.textures))
        matrix = IDENTITY
        if self.chance(0.1):
            scale = self.one_of((0.25, 7.0, -1.0, 2.0**-60))
            matrix = tuple(tuple(scale * v for v in row) if i < 2 else row for i, row in enumerate(IDENTITY))
        limit = self.profile.textures.max_lod_bias
        bias = self.one_of((0.5, -0.5, limit, -limit, self.uniform(-limit, limit)))
        return TextureUnit(
            name,
            self.sampler(self.textures[name]),
            lod_bias=bias if self.chance(0.2) and limit else 0.0,
            coordinates=self.whole(0, sets - 1),
            matrix=matrix,
        )

    def kind(self, name):
        """What a sampler must know of a texture."""
        texture = self.textures[name]
        complete = len(texture.levels) == max(texture.width, texture.height, texture.depth).bit_length()
        special = [texture.internal_format in formats for formats in (DEPTH_TEXELS, FORMATS_OF_WORDS)]
        return texture.target, special, complete, len(texture.levels)

    def unit_after(self, units):
        """A unit, or none, or one that shares coordinates and sampler with the unit before it."""
        if self.chance(0.12):
            return None
        unit, before = self.unit(self.sets), units[-1] if units else None
        if before is None or self.chance(0.7):
            return unit
        if self.kind(before.texture) != self.kind(unit.texture):
            unit = replace(unit, texture=before.texture)
        changed = replace(before, texture=unit.texture)
        return replace(changed, lod_bias=unit.lod_bias) if self.chance(0.3) else changed

    # -------------------------------------------------------------------------------- combiners

    def general_input(self, usages, units):
        kind = self.whole(0, 3)
        if kind == 0:  # what the stage before wrote, mostly
            register = self.one_of(self.live[-3:])
        elif kind == 1:
            register = self.one_of(self.live)
        else:
            register = self.one_of(
                (*READ_ONLY, *WRITABLE, *TEXTURE_REGISTERS[:units], *TEXTURE_REGISTERS[:units])
            )
        usage = self.one_of(usages)
        if register is Register.FOG:  # its factor is the final combiner's
            usage = usages[0]
        mapping = self.one_of(Mapping) if self.chance(0.6) else Mapping.UNSIGNED_IDENTITY
        if register in self.live[self.first_written :] and self.chance(0.4):  # all that may be below zero
            mapping = self.one_of((Mapping.SIGNED_IDENTITY, Mapping.SIGNED_NEGATE))
        return CombinerInput(register, mapping, usage)

    def portion(self, kind, units):
        usages = (ComponentUsage.RGB if kind is RGBPortion else ComponentUsage.BLUE, ComponentUsage.ALPHA)
        outputs = self.chooser.sample((*WRITABLE, *TEXTURE_REGISTERS[:units]), 3)
        if self.chance(0.6):
            outputs = [*[o for o in outputs if o is not Register.SPARE0][:2], Register.SPARE0]
        kept = [
            o if self.chance(p) else Register.DISCARD for o, p in zip(outputs, (0.3, 0.3, 0.8), strict=True)
        ]
        scale, bias = self.one_of(SCALES_AND_BIASES) if self.chance(0.5) else SCALES_AND_BIASES[0]
        flags = {}
        if kind is RGBPortion:
            flags = {"ab_dot_product": self.chance(0.2), "cd_dot_product": self.chance(0.2)}
        return kind(
            *(self.general_input(usages, units) for _ in range(4)),
            *kept,
            scale=scale,
            bias=bias,
            mux_sum=self.chance(0.25),
            **flags,
        )

    def general_combiner(self, units):
        rgb, alpha = self.portion(RGBPortion, units), self.portion(AlphaPortion, units)
        written = (rgb.ab_output, rgb.cd_output, rgb.sum_output)
        self.live += [register for register in written if register is not Register.DISCARD]
        if self.profile.combiners.blue_to_alpha and self.chance(0.1):
            written = {alpha.ab_output, alpha.cd_output, alpha.sum_output}
            rgb = replace(
                rgb,
                ab_blue_to_alpha=rgb.ab_output not in written,
                cd_blue_to_alpha=rgb.cd_output not in written,
            )
        own = {}
        if self.profile.combiners.per_stage_constants and self.chance(0.2):
            own = {"constant_color0": self.color(), "constant_color1": self.maybe(0.5, self.color)}
        return GeneralCombiner(rgb, alpha, **own)

    def final_input(self, variable, units):
        registers = [*READ_ONLY, *WRITABLE, *TEXTURE_REGISTERS[:units]]
        if variable in "abcd":
            registers.append(Register.E_TIMES_F)
        if variable in "bcd":
            registers.append(Register.SPARE0_PLUS_SECONDARY_COLOR)
        register = self.one_of(registers)
        usage = self.one_of((ComponentUsage.RGB, ComponentUsage.ALPHA))
        if variable == "g":
            usage = self.one_of((ComponentUsage.ALPHA, ComponentUsage.BLUE))
        elif register in (Register.E_TIMES_F, Register.SPARE0_PLUS_SECONDARY_COLOR):
            usage = ComponentUsage.RGB
        mapping = self.one_of((Mapping.UNSIGNED_IDENTITY, Mapping.UNSIGNED_INVERT))
        return CombinerInput(register, mapping, usage)

    def final_combiner(self, units):
        alpha = CombinerInput(Register.SPARE0, usage=ComponentUsage.ALPHA)
        if self.chance(0.5):  # show what the general combiners made
            shown, other = CombinerInput(self.live[-1]), CombinerInput(self.one_of(self.live[-3:]))
            if self.chance(0.4):
                half = CombinerInput(Register.CONSTANT_COLOR0, usage=ComponentUsage.ALPHA)
                return FinalCombiner(half, shown, other, g=alpha)
            return FinalCombiner(_ZERO, _ZERO, _ZERO, shown, g=alpha)
        inputs = {
            v: self.one_of((_ZERO, _ONE)) if self.chance(0.3) else self.final_input(v, units)
            for v in "abcdef"
        }
        return FinalCombiner(**inputs, g=alpha if self.chance(0.5) else self.final_input("g", units))

    def simple_combiners(self, units):
        """One stage that shows textures and colours: nothing hides a wrong texel."""
        sources = [Register.PRIMARY_COLOR, *TEXTURE_REGISTERS[:units], *TEXTURE_REGISTERS[:units]]
        a, b, c, d = (self.one_of(sources) for _ in range(4))
        second = self.chance(0.5)
        alpha = ComponentUsage.ALPHA
        dot = self.chance(0.2)
        expand = Mapping.EXPAND_NORMAL if dot else Mapping.UNSIGNED_IDENTITY
        rgb = RGBPortion(
            CombinerInput(a, expand),
            CombinerInput(b, expand) if self.chance(0.7) else _ONE,
            CombinerInput(c) if second else _ZERO,
            CombinerInput(d) if second else _ZERO,
            ab_dot_product=dot,
            ab_output=Register.SPARE0 if dot else Register.DISCARD,
            sum_output=Register.DISCARD if dot else Register.SPARE0,
        )
        one = replace(_ONE, usage=alpha)
        own = AlphaPortion(CombinerInput(a, usage=alpha), CombinerInput(b, usage=alpha) if second else one)
        final = FinalCombiner(
            _ZERO, _ZERO, _ZERO, CombinerInput(Register.SPARE0),
            g=CombinerInput(Register.SPARE0, usage=alpha),
        )  # fmt: skip
        return RegisterCombiners((GeneralCombiner(rgb, own),), final)

    def with_environments(self, units):
        """The same units with texture environments in the place of register combiners."""
        return tuple(
            unit
            and replace(
                unit,
                environment=random_environment(
                    self.chooser, self.profile, self.textures[unit.texture].internal_format
                ),
            )
            for unit in units
        )

    def register_combiners(self, units):
        if self.chance(0.45):
            return self.simple_combiners(units)
        most = self.profile.combiners.max_general_combiners
        self.live = [Register.CONSTANT_COLOR0, Register.PRIMARY_COLOR, *TEXTURE_REGISTERS[:units]]
        self.first_written = len(self.live)
        if self.small:
            most = min(most, 4) if self.chance(0.8) else most
        own = {}
        if self.profile.combiners.combiner_flags and self.chance(0.2):
            own = {
                "mux_select": self.one_of(MuxSelect),
                "invert_spare0": self.chance(0.5),
                "invert_secondary_color": self.chance(0.5),
            }
        return RegisterCombiners(
            tuple(self.general_combiner(units) for _ in range(self.whole(1, most))),
            self.final_combiner(units),
            self.color(),
            self.color(),
            color_sum_clamp=self.chance(0.6),
            **own,
        )

    # ----------------------------------------------------------------------------------- states

    def scissor(self):
        """A box that may cut bands of rows, reach over the border, or miss the screen."""
        width, height = self.width, self.height
        kind = self.whole(0, 3)
        if kind == 0:
            return Scissor(0, self.whole(0, height), width, self.whole(0, height))
        if kind == 1:
            return Scissor(self.whole(0, width), 0, self.whole(0, width), height)
        return Scissor(
            self.whole(-3, width), self.whole(-3, height), self.whole(0, width + 5), self.whole(0, height + 5)
        )

    def color_mask(self):
        return ColorMask(*(self.chance(0.6) for _ in range(4)))

    def stencil_test(self):
        functions = (ComparisonFunction.ALWAYS, *ComparisonFunction)
        operations = sorted(self.profile.fragments.stencil_operations)
        return StencilTest(
            function=self.one_of(functions),
            reference=self.one_of((0, 1, 2, 255, self.whole(-5, 300))),
            mask=self.one_of((255, self.whole(0, 255))),
            fail=self.one_of(operations),
            depth_fail=self.one_of(operations),
            depth_pass=self.one_of(operations),
            write_mask=self.one_of((255, self.whole(0, 255))),
        )

    def depth_test(self):
        usual = (ComparisonFunction.LESS, ComparisonFunction.LEQUAL, ComparisonFunction.ALWAYS)
        return DepthTest(self.one_of(usual if self.chance(0.5) else ComparisonFunction), self.chance(0.75))

    def blending(self):
        if self.chance(0.3):
            return self.one_of(_USUAL_BLENDINGS)
        profile = self.profile
        equation = BlendEquation.FUNC_ADD
        if self.chance(0.4):
            equation = self.one_of(sorted(profile.fragments.blend_equations))
        return Blending(
            source=self.one_of(sorted(profile.fragments.blend_factors_source)),
            destination=self.one_of(sorted(profile.fragments.blend_factors_destination)),
            equation=equation,
            color=self.color(),
        )

    def fog(self):
        start = self.one_of((0.0, 1.0, self.uniform(-4.0, 4.0)))
        return Fog(
            mode=self.one_of(FogMode),
            density=self.one_of((0.0, 1.0, 0.35)),
            start=start,
            end=start + self.one_of((1.0, -1.0, 3.5)),
            color=self.color(),
            coordinate_source=self.one_of(
                FogCoordinateSource if self.profile.vertices.fog_coordinate else [_DEPTH]
            ),
        )

    def polygon(self):
        offset = self.chance(0.2)
        return PolygonState(
            cull_face=self.one_of(Face) if self.chance(0.12) else None,
            front_face=self.one_of(FrontFace),
            offset_fill=offset,
            offset_factor=self.uniform(-4.0, 4.0) if offset else 0.0,
            offset_units=self.one_of((0.0, 1.0, -3.5, 1e9, self.uniform(-1e4, 1e4))) if offset else 0.0,
            shade_model=self.one_of((ShadeModel.SMOOTH, ShadeModel.SMOOTH, ShadeModel.FLAT)),
            provoking_vertex=self.one_of(ProvokingVertex),
        )

    def depth_clamp(self):
        limits = (0.0, 0.25, 1.0, 2.5, 300.0, 40000.0, 2.0**23, 2.0**25)
        low, high = sorted((self.one_of(limits), self.one_of(limits)))
        return DepthClamp(low, high if self.chance(0.7) else None, self.chance(0.5))

    def vertex(self):
        if self.chance(0.3):
            return VertexState(stage=VertexStage.PROGRAM_RESULTS, two_side=self.chance(0.1))
        viewport = Viewport()
        if self.chance(0.1):
            viewport = Viewport(
                self.whole(-5, 5),
                self.whole(-5, 5),
                self.whole(1, 2 * self.width),
                self.whole(1, 2 * self.height),
                self.uniform(0.0, 1.0),
                self.uniform(0.0, 1.0),
            )
        lighting = None
        if not self.plain and self.chance(0.06):
            light = Light(position=(0.3, 0.2, 1.0, 0.0))
            lighting = Lighting((light,), two_side=self.chance(0.6), separate_specular_color=self.chance(0.5))
        return VertexState(viewport=viewport, lighting=lighting)

    def stages(self, units):
        """Texture shader stages for enabled units: those of their targets, one that reads none, or a cull."""
        operations = []
        for unit in units:
            if unit is None:
                operations.append(TextureShaderOperation.NONE)
                continue
            target = self.textures[unit.texture].target
            operations.append(TextureShaderOperation[target.name])
        for i, unit in enumerate(units):
            if unit is not None and self.chance(0.3):
                operations[i] = self.one_of(
                    (TextureShaderOperation.PASS_THROUGH, TextureShaderOperation.CULL_FRAGMENT)
                )
        for i in range(1, len(units)):
            if units[i] is not None and self.chance(0.6):
                operations[i] = self.dependent_operation(i, operations, units[i])
        mappings = sorted(self.profile.texture_shaders.dot_product_mappings)
        results = [k for k, operation in enumerate(operations) if operation not in _WITHOUT_TEXEL]
        return tuple(
            TextureShaderStage(
                operation,
                previous_texture_input=self.one_of([k for k in results if k < i] or [0]),
                cull_modes=tuple(self.one_of(CullMode) for _ in range(4)),
                offset_texture_matrix=tuple(self.uniform(-1.0, 1.0) for _ in range(4)),
                offset_texture_scale=self.uniform(-1.0, 2.0),
                offset_texture_bias=self.uniform(-1.0, 1.0),
                dot_product_mapping=self.one_of(mappings) if mappings else DotProductMapping(0),
                constant_eye=tuple(self.uniform(-1.0, 1.0) for _ in range(3)),
            )
            for i, operation in enumerate(operations)
        )

    def dependent_operation(self, i, operations, unit):
        """An operation of stage ``i`` that reads earlier stages, where its unit and they allow one."""
        if not any(operation not in _WITHOUT_TEXEL for operation in operations[:i]):
            return operations[i]
        found, dots = [TextureShaderOperation.DOT_PRODUCT], 0
        while dots < i and operations[i - 1 - dots] is TextureShaderOperation.DOT_PRODUCT:
            dots += 1
        sampler, target = unit.sampler, self.textures[unit.texture].target
        if dots and TextureShaderOperation.DOT_PRODUCT_DEPTH_REPLACE not in operations[:i]:
            found.append(TextureShaderOperation.DOT_PRODUCT_DEPTH_REPLACE)
        if sampler.min_filter is sampler.mag_filter and sampler.max_anisotropy == sampler.max_probes == 1:
            internal_format = self.textures[unit.texture].internal_format
            unsigned = sampler.signed_components == SignedComponents()
            unsigned = unsigned and internal_format not in COLORLESS_FORMATS | SIGNED_FORMATS
            found += [
                operation
                for operation, needed, targets in _DEPENDENT
                if target in targets and dots >= needed and (unsigned or not operation.name.endswith("SCALE"))
            ]
        return self.one_of([o for o in found if o in self.profile.texture_shaders.texture_shader_operations])

    def state(self):
        profile, plain = self.profile, self.plain
        most = profile.textures.max_texture_units
        combiners = units = stages = None
        self.sets = self.whole(1, 3)
        if self.chance(0.85):
            count = self.whole(0, most) if self.textures else 0
            units = ()
            for _ in range(count):
                units += (self.unit_after(units),)
            if profile.combiners.max_general_combiners:
                combiners = self.register_combiners(max(count, 1))
            if any(units) and (combiners is None or self.chance(0.2)):
                combiners, units = None, self.with_environments(units)
            shaders = TextureShaderOperation.PASS_THROUGH in profile.texture_shaders.texture_shader_operations
            if units and not plain and shaders and self.chance(0.06):
                stages = self.stages(units)
        polygon = self.polygon()
        rare = {}
        if not plain:
            rare = {
                "color_sum": profile.fragments.color_sum and self.chance(0.2),
                "logic_op": self.maybe(0.1, lambda: self.one_of(LogicOperation)),
                "depth_clamp": self.maybe(0.12, self.depth_clamp) if profile.fragments.depth_clamp else None,
                "ycbcr_conversion": profile.combiners.ycbcr_conversion and self.chance(0.1),
                "w_buffering": profile.fragments.w_buffering and self.chance(0.1),
                "perspective_correction": not (profile.primitives.perspective_hint and self.chance(0.05)),
            }
            if self.chance(0.05):
                stipple = self.random.integers(0, 256, 128, np.uint8).tobytes()
                polygon = replace(polygon, stipple=stipple)
            if self.chance(0.05):
                polygon = replace(
                    polygon,
                    front_mode=self.one_of(PolygonMode),
                    back_mode=self.one_of(PolygonMode),
                    offset_line=self.chance(0.5),
                    offset_point=self.chance(0.5),
                )
            if profile.fragments.max_window_rectangles and self.chance(0.06):
                boxes = tuple(self.scissor() for _ in range(self.whole(1, 3)))
                rare["window_clip"] = WindowClip(boxes, self.chance(0.5))
            rare["line"] = self.line()
            sprite = bool(profile.primitives.point_sprite_units) and self.chance(0.3)
            rare["point"] = PointState(self.one_of((1.0, 2.0, 3.5, self.uniform(0.0, 9.0))), sprite)
        return PassState(
            vertex=self.vertex(),
            polygon=polygon,
            texture_units=units or (),
            register_combiners=combiners,
            texture_shader=stages,
            fog=self.maybe(0.15, self.fog),
            scissor=self.maybe(0.2, self.scissor),
            alpha_test=self.maybe(
                0.2, lambda: AlphaTest(self.one_of(ComparisonFunction), self.uniform(-0.2, 1.2))
            ),
            stencil_test=self.maybe(0.2, self.stencil_test),
            depth_test=self.maybe(0.6, self.depth_test),
            blending=self.maybe(0.4, self.blending),
            color_mask=self.color_mask() if self.chance(0.1) else ColorMask(),
            **rare,
        )

    # ----------------------------------------------------------------------------------- meshes

    def line(self):
        width = self.one_of((1.0, 0.0, 3.0, self.uniform(0.0, 6.0)))
        stipple = self.maybe(0.3, lambda: (self.one_of((1, 2, 5, 256)), self.whole(0, 0xFFFF)))
        steps = self.profile.arithmetic.diamond_exit_lines or stipple is not None or self.chance(0.5)
        return LineState(width, LineRasterization.STEPS if steps else LineRasterization.RECTANGLE, stipple)

    def mesh_for(self, state):
        """A mesh with everything that the state may read, in clip or in window coordinates."""
        shape = self.shape()
        pixels, count = shape.pixels, len(shape.pixels)
        programmed = state.vertex.stage is VertexStage.PROGRAM_RESULTS
        w = self.w(count, pixels, behind=not programmed)
        z = self.z(count)
        if programmed:
            farthest = {16: 65535.0, 23: 8388607.0, 24: 16777215.0, -16: 511.9375, -24: 1e30}[self.depth_bits]
            positions = np.column_stack([pixels, (z * 0.5 + 0.5) * farthest, w])
        else:
            x, y = (2.0 * pixels / (self.width, self.height) - 1.0).T
            positions = np.column_stack([x * w, y * w, z * w, w])
        named = [unit.coordinates for unit in state.texture_units if unit is not None]
        sets = self.coordinate_sets(pixels, count, max([self.sets - 1, *named]) + 1)
        fog = self.random.uniform(-2.0, 4.0, count) if state.fog or self.chance(0.1) else None
        if not self.plain and self.chance(0.06):  # ends of float64, which no scene has
            for array in (positions, *sets, fog):
                self.sprinkle(array)
        back = self.colors(count) if state.vertex.two_side else None
        return Mesh(
            positions,
            shape.primitive,
            indices=shape.indices,
            counts=shape.counts,
            colors=self.colors(count),
            secondary_colors=self.colors(count) if self.chance(0.4) else None,
            normals=self.random.uniform(-1.0, 1.0, (count, 3)) if state.vertex.lighting else None,
            texture_coordinates=sets,
            fog_coordinates=fog,
            back_colors=back,
            edge_flags=self.random.random(count) < 0.7 if self.chance(0.1) else None,
        )

    def sprinkle(self, array):
        """Put numbers of no sensible size into a few places of an array, or of none."""
        if array is not None and self.chance(0.5):
            extreme = (1e38, -1e38, 1e300, -1.7e308, 1e-308, 5e-324, -0.0, 2.0**31, -(2.0**63), 8192.0)
            places = self.random.integers(0, array.size, self.whole(1, 4))
            array.reshape(-1)[places] = self.random.choice(extreme, len(places))

    def shape(self):
        kinds = (
            *(self.screen, self.screen, self.large, self.any, self.any, self.lattice, self.lattice),
            *(self.exact, self.slivers, self.tiny, self.fan, self.far, self.degenerate, self.strip),
        )
        if not self.plain:
            kinds += (self.listed, self.strokes)
        made = self.one_of(kinds)()
        snapped = self.whole(0, 7)
        if snapped == 0:  # on pixel corners and centres
            return replace(made, pixels=np.round(made.pixels * 2.0) / 2.0)
        if snapped == 1:  # on the raster of snapped coordinates, and half way between
            return replace(made, pixels=np.round(made.pixels * 32.0) / 32.0)
        return made

    def somewhere(self, count):
        return self.random.uniform(-0.3, 1.3, (count, 2)) * (self.width, self.height)

    def screen(self):
        """The whole screen as two triangles, or somewhat more or less of it."""
        corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float64) * (self.width, self.height)
        if self.chance(0.4):
            corners += self.random.uniform(-2.0, 2.0, (4, 2))
        if self.chance(0.5):
            corners = corners[::-1]
        kind = self.whole(0, 2)
        if kind == 0:
            return _Shape(corners, self.one_of((PrimitiveType.QUADS, PrimitiveType.POLYGON)))
        if kind == 1:
            return _Shape(corners[[0, 1, 3, 2]], PrimitiveType.TRIANGLE_STRIP)
        return _Shape(corners, PrimitiveType.TRIANGLES, np.array([0, 1, 2, 0, 2, 3]))

    def large(self):
        """One triangle over most of the screen."""
        corners = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]) * (self.width, self.height)
        corners = corners[self.random.permutation(3)]
        return _Shape(corners + self.random.uniform(-1.0, 1.0, (3, 2)) * self.one_of((0.0, 0.1, 5.0)))

    def any(self):
        count = self.whole(3, 9)
        indices = self.random.integers(0, count, self.whole(3, 24)) if self.chance(0.5) else None
        return _Shape(self.somewhere(count), self.one_of(_POLYGONS), indices)

    def lattice(self):
        """Cells of a few pixels with shared vertices, moved a little: hundreds of small triangles."""
        cell = self.one_of((0.5, 1.0, 2.0, 3.0, 4.0, self.uniform(0.3, 7.0)))
        most = 12 if self.small else 30
        columns = min(most, max(1, int(self.width / cell) + 2))
        rows = min(most, max(1, int(self.height / cell) + 2))
        grid = np.stack(np.meshgrid(np.arange(columns + 1), np.arange(rows + 1)), -1).reshape(-1, 2) * cell
        grid = grid + self.random.uniform(-0.5, 0.5, grid.shape) * self.one_of((0.0, 0.2, 1.0, 2.0)) * cell
        grid += self.random.uniform(-1.0, 1.0, 2) * self.one_of((0.0, 1.0, 20.0))
        if self.chance(0.3):
            angle = self.uniform(0.0, 6.3)
            turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
            middle = np.array([self.width, self.height]) / 2.0
            grid = (grid - middle) @ turn + middle
        first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).reshape(-1)
        across, down = first + 1, first + columns + 1
        kind = self.whole(0, 2)
        if kind == 0:
            indices = np.column_stack([first, across, down + 1, down]).reshape(-1)
            return _Shape(grid, PrimitiveType.QUADS, indices)
        if kind == 1:
            each = np.arange(columns + 1)
            pairs = [
                np.stack([each + r * (columns + 1), each + (r + 1) * (columns + 1)], 1) for r in range(rows)
            ]
            indices = np.concatenate([pair.reshape(-1) for pair in pairs])
            counts = (2 * (columns + 1),) * rows
            return _Shape(grid, PrimitiveType.TRIANGLE_STRIP, indices, counts)
        indices = np.column_stack([first, across, down, across, down + 1, down]).reshape(-1, 3)
        if self.chance(0.3):
            indices = self.random.permutation(indices)
        return _Shape(grid, PrimitiveType.TRIANGLES, indices.reshape(-1))

    def slivers(self):
        """Long triangles that are thinner than a pixel."""
        count = self.whole(1, 8)
        start = self.somewhere(count)
        along = self.random.normal(size=(count, 2)) * self.one_of((3.0, 20.0, 200.0))
        thin = self.random.normal(size=(count, 2)) * self.one_of((0.05, 0.3, 1.0))
        return _Shape(np.stack([start, start + along, start + along * 0.7 + thin], 1).reshape(-1, 2))

    def tiny(self):
        """Triangles inside a pixel or two: some hold a centre, most hold none."""
        count = self.whole(1, 40)
        center = np.floor(self.somewhere(count)) + 0.5
        reach = self.one_of((0.1, 0.6, 1.5))
        corners = center[:, None] + self.random.uniform(-reach, reach, (count, 3, 2))
        return _Shape(corners.reshape(-1, 2))

    def fan(self):
        """Many triangles around one vertex, by edges that meet in it."""
        count = self.whole(3, 24)
        angles = np.sort(self.random.uniform(0.0, 2.0 * np.pi, count))
        center = self.somewhere(1)
        ring = center + np.stack([np.cos(angles), np.sin(angles)], -1) * self.uniform(0.5, self.width + 3.0)
        primitive = self.one_of(
            (PrimitiveType.TRIANGLE_FAN, PrimitiveType.TRIANGLE_FAN, PrimitiveType.POLYGON)
        )
        closed = np.concatenate([ring, ring[:1]])
        if primitive is PrimitiveType.POLYGON:
            return _Shape(closed[:-1], primitive)
        return _Shape(np.concatenate([center, closed]), primitive)

    def exact(self):
        """Triangles whose weights are 1/4, 1/2 and the like at pixel centres, of areas that are no powers of
        two: what a cut-off bit takes away shows.
        """
        count = self.whole(1, 4)
        corner = np.floor(self.somewhere(count)) + self.one_of((0.5, 0.0))
        legs = self.random.choice([3, 5, 6, 7, 9, 10, 12, 14, 20, 24, 40, 48], (count, 2))
        legs = legs * self.random.choice([-1, 1], (count, 2))
        along, up = legs * [1, 0], legs * [0, 1] + self.whole(0, 1) * (legs[:, :1] // 2) * [1, 0]
        corners = np.stack([corner, corner + along, corner + up], 1)
        return _Shape(corners[:, self.random.permutation(3)].reshape(-1, 2))

    def far(self):
        """Vertices far outside the screen, on this and that side of the guard band."""
        count = 3 * self.whole(1, 4)
        reach = self.random.choice([1.0, 20.0, 500.0, 8000.0, 30000.0], (count, 1))
        return _Shape(self.somewhere(count) + self.random.uniform(-1.0, 1.0, (count, 2)) * reach)

    def degenerate(self):
        """Triangles without an area, and vertices on one line of pixel centres."""
        count = 3 * self.whole(1, 5)
        pixels = self.somewhere(count)
        kind = self.whole(0, 3)
        if kind == 0:
            pixels[:, 1] = pixels[:, 0]
        elif kind == 1:
            pixels[1::3] = pixels[::3]
        elif kind == 2:
            pixels[:, 1] = np.floor(pixels[:, 1]) + 0.5
        else:
            pixels[2::3, 1] = pixels[1::3, 1]  # a flat side
        return _Shape(pixels)

    def strip(self):
        """A long strip that winds over the screen."""
        count = self.whole(4, 40 if self.small else 200)
        path = np.cumsum(self.random.normal(size=(count, 2)) * self.one_of((0.5, 2.0, 10.0)), 0)
        kind = self.one_of((PrimitiveType.TRIANGLE_STRIP, PrimitiveType.QUAD_STRIP))
        return _Shape(path + self.somewhere(1), kind)

    def listed(self):
        """A long list of indices into few vertices."""
        count = self.whole(3, 30)
        length = self.one_of((60, 300, 4096)) if not self.small else self.one_of((30, 90))
        pixels = self.somewhere(1) + self.random.normal(size=(count, 2)) * self.one_of((1.0, 4.0))
        return _Shape(pixels, self.one_of(_POLYGONS), self.random.integers(0, count, length))

    def strokes(self):
        count = self.whole(1, 8)
        return _Shape(self.somewhere(count), self.one_of(_STROKES))

    def w(self, count, pixels, behind):
        kind = self.whole(0, 9)
        if kind < 4:
            return np.ones(count)
        if kind == 4:
            return np.full(count, self.one_of((0.25, 3.7, 1e-3, 1e5)))
        if kind == 5:  # a plane that recedes
            height = pixels[:, 1] / self.height
            return 1.0 + np.clip(height, 0.0, 1.0) * self.one_of((1.0, 9.0, 999.0))
        if kind == 6:
            return 10.0 ** self.random.uniform(0.0, 3.0, count)
        if kind == 7:
            return np.exp2(self.random.integers(-3, 4, count))
        w = np.exp(self.random.uniform(-2.0, 2.0, count))
        if kind == 8 and behind:
            return np.where(self.random.random(count) < 0.3, -w, w)
        return w

    def z(self, count):
        kind = self.whole(0, 4)
        if kind == 0:
            return np.full(count, self.one_of((-1.0, -0.5, 0.0, 0.5, 1.0)))
        if kind == 1:
            return np.round(self.random.uniform(-1.0, 1.0, count) * 4.0) / 4.0
        if kind == 2:
            return self.random.uniform(-1.4, 1.4, count)
        if kind == 3:
            return self.uniform(-1.0, 1.0) + self.random.uniform(-1e-6, 1e-6, count)
        return self.random.uniform(-1.0, 1.0, count)

    def colors(self, count):
        kind = self.whole(0, 5)
        if kind == 0:
            return None
        if kind == 1:
            return np.tile(self.random.random((1, 4)), (count, 1))
        if kind == 2:
            return self.random.choice([0.0, 0.25, 0.5, 1.0], (count, 4))
        if kind == 3:
            return self.random.integers(0, 256, (count, self.one_of((3, 4)))) / 255.0
        if kind == 4:
            return self.random.uniform(-0.2, 1.2, (count, 4))
        return self.random.random((count, 4))

    def coordinate_sets(self, pixels, count, needed):
        """As many sets as the units may name; some are the same array, or equal to another."""
        sets = [self.coordinates(pixels, count)]
        while len(sets) < needed:
            kind = self.whole(0, 5)
            if kind == 0:
                sets.append(sets[0])
            elif kind == 1:
                sets.append(sets[0].copy())
            elif kind == 2:
                sets.append(sets[0] * self.one_of((2.0, -1.0, 0.5, 4.0)))
            else:
                sets.append(self.coordinates(pixels, count))
        return tuple(sets)

    def coordinates(self, pixels, count):
        random, kind = self.random, self.whole(0, 13)
        made = random.uniform(-1.5, 1.5, (count, 4))
        if kind < 3:  # so many texels a pixel
            edges = self.random.choice([1, 2, 4, 8, 16, 64], 2)
            texels = random.choice([0.25, 0.5, 1.0, 2.0, 4.0, 2.0**0.5], 2)
            made[:, :2] = pixels * texels / edges + self.one_of((0.0, 0.5, random.random())) / edges
        elif kind == 3:
            made = np.round(made * 8.0) / 8.0
        elif kind == 4:
            made *= self.one_of((40.0, 1e3, 1e6))
        elif kind == 5:
            made[:] = made[:1]
        elif kind == 6:
            made *= 2.0**-60
        elif kind == 7:  # at, just below and just above texel boundaries
            edge = self.one_of((1, 2, 16, 64, 2048))
            made = random.integers(-2 * edge, 2 * edge + 1, made.shape) / edge
            made = np.nextafter(made, made + random.integers(-1, 2, made.shape))
        elif kind == 8:
            made = random.choice([0.0, 1.0, -1.0, 0.5, 2.0**-149, 1e6, -1e6], made.shape)
        elif kind == 9 and not self.plain:
            made *= self.one_of((1e38, 1e15, 2.0**31, 2.0**40))
        elif kind == 10:
            made = np.abs(made)
        elif kind == 11:
            made[:, self.whole(0, 1)] = self.one_of((0.0, 0.5, -3.25))
        if kind == 12 or self.chance(0.05):
            made[:, 3] = random.uniform(0.5, 3.0, count)
        elif kind == 13:
            made[:, 3] = random.choice([0.0, 1.0, -1.0, 2.0], count)
        else:
            made[:, 3] = 1.0
        return made[:, :2] if self.chance(0.3) and (made[:, 3] == 1.0).all() else made


@dataclass(frozen=True, eq=False)
class _Shape:
    """Window positions [n, 2] in pixels, and how they are drawn."""

    pixels: np.ndarray
    primitive: PrimitiveType = PrimitiveType.TRIANGLES
    indices: np.ndarray | None = None
    counts: tuple[int, ...] | None = None
