"""Instructions that are counted, by programs that stand in for perf and Valgrind."""

import json
import os
import shutil
import sys

import pytest

from bench import __main__ as command_line
from bench import counted, counters, kinds, limits, processor
from bench.scenes import SCENES
from bench.starting import environment


@pytest.fixture(autouse=True)
def has_avx512(monkeypatch):
    """Whatever draws here, the tests' processor has all extensions."""
    own = processor.Processor("AMD EPYC", "AuthenticAMD", 26, 2, tuple(processor.LEVELS), 2)
    monkeypatch.setattr(processor, "read", lambda: own)


_PERF = """1234567,,instructions:u,100.00,,
<not supported>,,cycles:u,100.00,,
"""
_VALGRIND = """==1== Cachegrind, a cache and branch-prediction profiler
==1== I   refs:      4,654,118,758
"""


def test_what_perf_cannot_count_is_left_out():
    assert counters._counted_by_perf(_PERF) == {"instructions": 1234567}
    assert counters._counted_by_perf("") == {}


def test_valgrind_tells_instructions():
    assert counters._counted_by_valgrind(_VALGRIND) == {"instructions": 4_654_118_758}
    assert counters._counted_by_valgrind("==1== no such line") == {}


def _program(folder, name, said, status=0):
    file = folder / name
    file.write_text(f"#!{sys.executable}\nimport sys\n{said}\nsys.exit({status})\n")
    file.chmod(0o755)


def _only(monkeypatch, folder):
    monkeypatch.setenv("PATH", str(folder))


def test_perf_counts_where_it_can(monkeypatch, tmp_path):
    write = f"open(sys.argv[sys.argv.index('-o') + 1], 'w').write({_PERF!r})"
    _program(tmp_path, "perf", write)
    _program(tmp_path, "valgrind", "")
    _only(monkeypatch, tmp_path)
    assert counters.choose(None) is counters.by_perf


@pytest.mark.parametrize("perf", [{"said": ""}, {"said": "", "status": 255}, None])
def test_valgrind_counts_where_perf_does_not(perf, monkeypatch, tmp_path):
    if perf:
        _program(tmp_path, "perf", **perf)
    _only(monkeypatch, tmp_path)
    with pytest.raises(OSError, match="valgrind is not installed"):
        counters.choose("avx2")
    _program(tmp_path, "valgrind", "")
    assert counters.choose("avx2") is counters.by_valgrind
    with pytest.raises(OSError, match=r"valgrind knows no AVX-512: give --cpu avx2 or generic"):
        counters.choose(None)


def test_a_fragments_share_is_that_of_the_frames_alone(monkeypatch):
    monkeypatch.setattr(counters, "_finish", lambda command, variables: "")
    asked = []

    def counter(command, variables):
        asked.append((command[3:], variables["PYTHONHASHSEED"], variables.get("LP_NUM_THREADS")))
        return {"instructions": 10**9 + int(command[-1]) * 8 * 64**2 * 50}

    scene = SCENES["b"]
    assert counters.count(counter, "ours", scene, 64) == {"instructions": 50.0}
    assert counters.count(counter, "llvmpipe", scene, 64) == {"instructions": 50.0}
    assert asked == [
        (["ours", "b", "64", "2"], "0", None),
        (["ours", "b", "64", "10"], "0", None),
        (["llvmpipe", "b", "64", "2"], "0", "0"),
        (["llvmpipe", "b", "64", "10"], "0", "0"),
    ]


def test_a_program_that_fails_is_an_error_with_what_it_said():
    with pytest.raises(OSError, match=r"ended with 1: .*No module named"):
        counters._finish([sys.executable, "-m", "bench.no_such"], {})


def test_frames_are_drawn_to_be_counted(monkeypatch):
    drawn = []

    class Party:
        def __init__(self, threads):
            drawn.append(threads)

        def prepare(self, scene, size):
            drawn.append((scene.name, size))

        def turn(self, frames):
            drawn.append(frames)

    monkeypatch.setattr("bench.measure.Ours", Party)
    counted.draw("ours", SCENES["a"], 64, 4)
    assert drawn == [1, ("a", 64), 5]


def test_the_table_has_a_row_for_each_scene(monkeypatch, capsys, tmp_path):
    monkeypatch.setenv(limits.VARIABLE, "generic")
    monkeypatch.setattr(counters, "missing", list)
    monkeypatch.setattr(counters, "choose", lambda limit: counters.by_valgrind)
    found = {"ours": 12.345, "llvmpipe": 67.8}
    monkeypatch.setattr(counters, "count", lambda c, party, scene, size: {"instructions": found[party]})
    file = tmp_path / "counted.json"
    assert command_line.main(["counters", "b", "e2", "--cpu", "generic", "--json", str(file)]) == 0
    shown = capsys.readouterr().out
    assert "| scene | of a | ours, instructions | llvmpipe, instructions |" in shown
    assert "| b | fragment | 12.3 | 67.8 |" in shown
    assert "| e2 | triangle | 12.3 | 67.8 |" in shown
    said = json.loads(file.read_text())
    assert (said["cpu"], said["by"], said["scenes"][0]["ours"]) == (
        "generic",
        "valgrind",
        {"instructions": 12.345},
    )


def test_a_limited_count_is_a_process_of_its_own(monkeypatch):
    monkeypatch.delenv(limits.VARIABLE, raising=False)
    ran = []
    monkeypatch.setattr(limits, "run_again", lambda name, arguments: ran.append((name, arguments)) or 3)
    assert command_line.main(["counters", "b", "--cpu", "generic"]) == 3
    assert ran == [("generic", ["counters", "b", "--cpu", "generic"])]


def test_an_unknown_scene_is_refused(capsys):
    with pytest.raises(SystemExit):
        command_line.main(["counters", "x1"])
    assert "there is no scene x1; the scenes are a, a2" in capsys.readouterr().err


def test_children_find_the_checkout():
    assert os.path.isdir(os.path.join(environment()["PYTHONPATH"].split(os.pathsep)[0], "bench"))


# ------------------------------------------------------------------------------------- by kind


@pytest.mark.parametrize(
    ("mnemonics", "kind"),
    [
        ("vdivpd divss vsqrtps idiv div idivl", "divisions"),
        ("vgatherdps vpgatherdd vpgatherqq", "gathers"),
        ("vcvttpd2dq cvtsi2sd vcvtdq2ps", "conversions"),
        ("vmulpd addsd vfmadd231pd vroundpd vcmpnltpd vandpd", "float64"),
        ("vmulps addss vfmadd231ps vrcpps vminps", "float32"),
        (
            "vpshufb vunpcklpd vpermq vinserti128 vextractf128 vpackssdw vbroadcastsd vpblendw pextrb",
            "arranging",
        ),
        ("vpmovmskb vpmovzxbw vmovlhps movhps", "arranging"),
        ("mov vmovupd vmovdqa movzbl vmaskmovps vpmaskmovd", "moves"),
        ("vpmullw vpaddd pand vpsrlw vpmaxsw vpcmpgtd vptest", "integers"),
        ("add cmp je lea push pop pdep prefetcht0 dec test popcnt", "scalars"),
    ],
)
def test_an_instruction_is_of_one_kind(mnemonics, kind):
    found = {mnemonic: kinds.kind_of(mnemonic) for mnemonic in mnemonics.split()}
    assert set(found.values()) == {kind}, found


def test_only_what_is_in_no_file_is_counted_and_no_call_twice():
    lines = """ob=/usr/lib/libc.so.6
fn=malloc
0x10 31 1000
ob=???
fn=???
0x1000 0 7
calls=3 0x2000 0
0x1004 0 999
0x1004 0 7
0x1000 0 1
"""
    assert kinds.executed(lines.splitlines()) == {0x1000: 8, 0x1004: 7}


# vmulpd %ymm0,%ymm1,%ymm2; vmovupd %ymm2,0x20(%rsp); ret
_CODE = bytes.fromhex("c5f559d0c5fd11542420c3")


@pytest.mark.skipif(not shutil.which("objdump"), reason="needs objdump")
def test_counted_addresses_are_told_by_kind():
    regions = [(0x500, b"\x90" * 16), (0x1000, b"\x90" * 8 + _CODE), (0x9000, _CODE)]
    counts = {0x1008: 5, 0x100C: 4, 0x1012: 3, 0x9000: 100, 0x700: 50}
    assert kinds.tally(counts, regions) == (({"float64": 105, "moves": 4, "scalars": 3}), 4)
    assert kinds.tally({0x700: 50}, regions) == ({}, 0)


def test_a_processs_executable_memory_is_read_again(tmp_path):
    maps, memory, file = tmp_path / "maps", tmp_path / "mem", tmp_path / "dump.npz"
    maps.write_text(
        "20-24 r-xp 00000000 00:00 0 \n"
        "10-14 rwxp 00000000 00:00 0 \n"
        "30-34 rw-p 00000000 00:00 0 \n"
        "40-44 r-xp 00000000 08:01 77 /usr/lib/libc.so.6\n"
        "50-8000050 r-xp 00000000 00:00 0 \n"
    )
    memory.write_bytes(bytes(range(128)))
    counted.dump(file, maps, memory)
    assert counted.read_dump(file) == [(0x10, bytes(range(16, 20))), (0x20, bytes(range(32, 36)))]


def test_kinds_are_of_a_fragment_and_the_first_frame_counts(monkeypatch):
    def run(command):
        assert command[-4:-1] == ["b", "512", "4"]
        callgrind = next(word for word in command if word.startswith("--callgrind-out-file="))
        with open(callgrind.partition("=")[2], "w") as file:
            file.write("ob=\n0x1000 0 500\n")

    monkeypatch.setattr(kinds, "read_dump", lambda file: [])
    monkeypatch.setattr(
        kinds, "tally", lambda counts, regions: ({"float64": counts[0x1000], **_NO_KINDS}, 100)
    )
    found = kinds.count(run, ["ours", "b", "512"], work=10)
    assert (found["all"], found["stack"], found["float64"], found["gathers"]) == (10.0, 2.0, 10.0, 0.0)


_NO_KINDS = {kind: 0 for kind in (*kinds.KINDS, "scalars") if kind != "float64"}


def test_the_table_by_kind_has_a_row_for_each_party(monkeypatch, capsys):
    monkeypatch.setenv(limits.VARIABLE, "avx2")
    monkeypatch.setattr(counters, "missing", list)
    monkeypatch.setattr(counters, "_finish", lambda command, variables: "")
    monkeypatch.setattr(shutil, "which", lambda program: program)
    found = {"all": 50.0, "stack": 12.0, "float64": 11.4, **_NO_KINDS}
    monkeypatch.setattr(kinds, "count", lambda run, command, work: found)
    assert command_line.main(["counters", "b", "--kinds", "--cpu", "avx2"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(" | ")[2] for line in lines[2:]] == ["ours", "llvmpipe"]
    assert lines[2].startswith("| b | fragment | ours | 50 | 12 | 0 | 0 | 0 | 11.4 |")


@pytest.mark.parametrize(
    ("installed", "cpu", "sentence"),
    [
        ((), ["--cpu", "avx2"], "--kinds needs valgrind, which is not installed"),
        (("valgrind",), ["--cpu", "avx2"], "--kinds needs objdump, which is not installed"),
        (("valgrind", "objdump"), [], "knows no AVX-512: give --cpu avx2 or generic"),
    ],
)
def test_what_kinds_need_is_said(installed, cpu, sentence, monkeypatch, capsys):
    monkeypatch.setenv(limits.VARIABLE, "avx2")
    monkeypatch.setattr(shutil, "which", lambda program: program if program in installed else None)
    assert command_line.main(["counters", "b", "--kinds", *cpu]) == 1
    assert sentence in capsys.readouterr().err
