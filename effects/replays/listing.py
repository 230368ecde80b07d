"""Lists what a trace uses, without drawing it: functions, extensions, and the calls that machines refuse.

The machines are judged by the first frames that draw something. Functions, frames and draws are counted in
the whole trace.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from fixedpipe.effects.replays.replay import Frame, Replay
from fixedpipe.effects.replays.summary import missing_features
from fixedpipe.effects.replays.targets import Judged
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.outcomes import Outcome
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.traces.calls import Call

# Machines are judged by so many frames with draws. Assumed: they show what a game does all the time.
JUDGED_FRAMES = 10
# The machine that is recommended if no other refuses fewer calls.
_USUAL = "GEFORCE_256"

# How the names of an extension's functions begin, without gl.
_FUNCTIONS = {
    "ARB_multitexture": ("ActiveTexture", "ClientActiveTexture", "MultiTexCoord"),
    "ARB_transpose_matrix": ("LoadTransposeMatrix", "MultTransposeMatrix"),
    "ARB_texture_compression": ("CompressedTex",),
    "ARB_multisample": ("SampleCoverage",),
    "ARB_vertex_array_object": ("GenVertexArrays", "BindVertexArray"),
    "ARB_vertex_buffer_object": ("BindBuffer", "BufferData", "BufferSubData", "MapBuffer", "UnmapBuffer"),
    "ARB_occlusion_query": ("BeginQuery", "EndQuery"),
    "ARB_window_pos": ("WindowPos",),
    "ARB_vertex_program or ARB_fragment_program": ("ProgramString", "ProgramLocal", "ProgramEnv"),
    "ARB_imaging": (
        "ConvolutionFilter",
        "ConvolutionParameter",
        "SeparableFilter",
        "CopyConvolution",
        "ColorSubTable",
        "CopyColor",
        "Histogram",
        "ResetHistogram",
        "Minmax",
        "ResetMinmax",
    ),
    "EXT_blend_color": ("BlendColor",),
    "EXT_blend_func_separate": ("BlendFuncSeparate",),
    "EXT_blend_minmax": ("BlendEquation",),
    "EXT_compiled_vertex_array": ("LockArrays", "UnlockArrays"),
    "EXT_draw_range_elements": ("DrawRangeElements",),
    "EXT_fog_coord": ("FogCoord",),
    "EXT_framebuffer_blit": ("BlitFramebuffer",),
    "EXT_framebuffer_object": ("BindFramebuffer", "FramebufferTexture", "FramebufferRenderbuffer"),
    "EXT_multi_draw_arrays": ("MultiDraw",),
    "EXT_paletted_texture": ("ColorTableEXT",),
    "EXT_point_parameters": ("PointParameter",),
    "EXT_secondary_color": ("SecondaryColor",),
    "EXT_texture3D": ("TexImage3D", "TexSubImage3D", "CopyTexSubImage3D"),
    "EXT_vertex_weighting": ("VertexWeight",),
    "NV_register_combiners2": ("CombinerStage",),
    "NV_register_combiners": ("Combiner", "FinalCombiner"),
    "NV_vertex_array_range": ("VertexArrayRange", "FlushVertexArrayRange"),
    "NV_vertex_program": ("LoadProgramNV", "ExecuteProgram", "TrackMatrix", "ProgramParameter"),
    "ATI_fragment_shader": ("BeginFragmentShader",),
    "OpenGL 2.0's shaders": ("CreateShader", "UseProgram", "CreateProgramObject", "LinkProgram"),
    "GREMEDY_frame_terminator": ("FrameTerminator",),
}
# Tokens by which a program uses an extension, in calls of Enable and those for textures.
_TOKENS = {
    tokens.TEXTURE_CUBE_MAP: "ARB_texture_cube_map",
    tokens.TEXTURE_RECTANGLE_NV: "NV_texture_rectangle",
    tokens.COMBINE: "ARB_texture_env_combine",
    tokens.COMBINE4_NV: "NV_texture_env_combine4",
    tokens.POINT_SPRITE_NV: "NV_point_sprite",
    tokens.TEXTURE_SHADER_NV: "NV_texture_shader",
    tokens.TEXTURE_MAX_ANISOTROPY_EXT: "EXT_texture_filter_anisotropic",
    tokens.GENERATE_MIPMAP: "SGIS_generate_mipmap",
    tokens.TEXTURE_COMPARE_MODE: "ARB_shadow",
    **dict.fromkeys(range(0x83F0, 0x83F4), "EXT_texture_compression_s3tc"),
    **dict.fromkeys(range(0x81A5, 0x81A8), "ARB_depth_texture"),
}
_TOKEN_FUNCTIONS = ("glEnable", "glTex", "glCompressedTex", "glCopyTexImage")


def extension_of(function: str) -> str | None:
    """The extension, or later version of OpenGL, that introduced a function; None: OpenGL 1.1."""
    name = function.removeprefix("gl")
    return next((e for e, starts in _FUNCTIONS.items() if name.startswith(starts)), None)


@dataclass
class Verdict:
    """A machine's refusals in the judged frames: each sentence, its first call, and how often it occurred.

    ``without``: features that the machine lacks; it would draw without them.
    """

    profile: Profile
    draws: int
    refused_draws: int
    refusals: tuple[Outcome, ...]
    without: tuple[Outcome, ...] = ()

    @property
    def count(self) -> int:
        """How many calls it would refuse."""
        return sum(outcome.count for outcome in self.refusals)


class Listing:
    """Counts what a trace uses, call by call.

    - ``profiles``: {key: machine} of the machines to judge.
    - ``functions``: how often each function is called; ``extensions``: the extensions that are used.
    - ``sizes``: how many frames of each size there are.
    - ``judged``: how many frames the machines were judged by.
    """

    def __init__(self, profiles: Mapping[str, Profile], size: tuple[int, int] | None = None):
        self.functions: Counter[str] = Counter()
        self.sizes: Counter[tuple[int, int]] = Counter()
        self.judged = 0
        self._tokens: set[str] = set()
        self._replays = {key: Replay(profile, size=size, target=Judged) for key, profile in profiles.items()}
        self._counting = _USUAL if _USUAL in self._replays else next(iter(self._replays))
        self._verdicts: dict[str, Verdict] = {}

    @property
    def replay(self) -> Replay:
        """The Replay that continues to the end of the trace."""
        return self._replays[self._counting]

    def take(self, call: Call) -> None:
        """Count a call."""
        self.functions[call.name] += 1
        if call.name.startswith(_TOKEN_FUNCTIONS):
            self._tokens.update(_TOKENS[a] for a in call.arguments[:3] if isinstance(a, int) and a in _TOKENS)
        for key, replay in self._replays.items():
            frames = replay.take(call)
            if key == self._counting:
                ended = frames
        for frame in ended:
            self._ended(frame)

    def finish(self) -> None:
        """Handle the end of the trace."""
        for key, replay in self._replays.items():
            frames = replay.finish()
            if key == self._counting:
                ended = frames
        for frame in ended:
            self._ended(frame)
        self._judge()

    def _ended(self, frame: Frame) -> None:
        self.sizes[frame.width, frame.height] += 1
        if frame.draws and not self._verdicts:
            self.judged += 1
            if self.judged == JUDGED_FRAMES:
                self._judge()

    def _judge(self) -> None:
        if self._verdicts:
            return
        for key, replay in self._replays.items():
            found = [*replay.tally.of("refused"), *replay.tally.of("unknown")]
            found = [outcome for outcome in found if outcome.count > 0]
            draws, refused = replay.draws, replay.refused
            without = missing_features(replay.tally)
            self._verdicts[key] = Verdict(replay.profile, draws, refused, tuple(found), without)
        self._replays = {self._counting: self.replay}

    @property
    def extensions(self) -> list[str]:
        """The extensions that the trace uses, as far as functions and tokens tell."""
        found = {extension_of(name) for name in self.functions} | self._tokens
        return sorted(filter(None, found))

    @property
    def verdicts(self) -> dict[str, Verdict]:
        """The Verdict of each machine, by key; complete after ``finish``."""
        return self._verdicts

    def recommended(self) -> str:
        """The key of the machine with the fewest refusals, and then the fewest missing features. If several
        machines are equal: the GeForce 256, or the first.
        """
        costs = {key: (verdict.count, len(verdict.without)) for key, verdict in self._verdicts.items()}
        least = min(costs.values())
        best = [key for key, cost in costs.items() if cost == least]
        return _USUAL if _USUAL in best else best[0]

    def data(self) -> dict[str, Any]:
        """All counts and verdicts as values for JSON."""
        return {
            "calls": self.replay.calls,
            "frames": self.replay.frames,
            "draws": self.replay.draws,
            "sizes": [{"width": w, "height": h, "frames": n} for (w, h), n in self.sizes.items()],
            "functions": dict(self.functions.most_common()),
            "extensions": self.extensions,
            "judged_frames": self.judged,
            "machines": {
                key: {
                    "draws": verdict.draws,
                    "refused_draws": verdict.refused_draws,
                    "refused": [outcome._asdict() for outcome in verdict.refusals],
                    "without": [outcome._asdict() for outcome in verdict.without],
                }
                for key, verdict in self._verdicts.items()
            },
        }
