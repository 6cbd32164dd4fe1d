"""Damaged files: each program of post says in one line what is wrong, and ends with status 2.

60 files here; THERCON_FUZZ=N tries N of them, with pictures drawn in full.
"""

import os
import re
import resource
import shutil
import signal
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

POST = Path(__file__).resolve().parents[2] / "post"
sys.path.insert(0, str(POST.parent / "python"))

from damage import damage  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from program import CYLINDER, run  # noqa: E402
from synthetic import write_result  # noqa: E402

from thercon.post import cli, style  # noqa: E402
from thercon.post.comparison import cli as comparison  # noqa: E402
from thercon.post.report import cli as report  # noqa: E402

FILES = int(os.environ.get("THERCON_FUZZ", "30"))
FIRST = int(os.environ.get("THERCON_FUZZ_FIRST", "60"))
LONGEST = 60  # CPU seconds
ROOM = 3 * 2**30  # bytes of address space beside what the tests have
CALCULIX = Path(__file__).resolve().parent / "calculix"
TEMPLATE = """
[[value]]
name = "load"
pattern = 'LOAD = *(\\S+)'
[[value]]
name = "normal_force"
pattern = 'FORCE = *(\\S+)'
[[table]]
heading = '^ NODE'
end = '^$'
columns = [{name = "node", first = 1, last = 6}, {name = "pressure", first = 7, last = 20}]
"""
PICTURES = (["mesh"], ["profiles", "--load", "3", "5"], ["zones"], ["fields"], ["convergence"],
            ["fields", "--region", "contact", "--quantity", "stress_error"], ["accuracy"])


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Return a folder with files of all kinds that are read, none of them damaged."""
    folder = tmp_path_factory.mktemp("whole")
    write_result(folder / "loads.vtkhdf", loads=(1.0, 5.0, 3.0), columns=4, rows=2, failing=True,
                 contacts=("LEFT", "RIGHT"))
    for end in ("inp", "mesh"):
        shutil.copy(CYLINDER.parents[1] / "examples" / f"brake_pad.{end}", folder)
    status, said = run(folder / "brake_pad.inp", "--accuracy", "5%")
    assert status == 4, said
    for path in CALCULIX.glob("*.[fd][ra][dt]"):
        shutil.copy(path, folder)
    with h5py.File(folder / "loads.vtkhdf") as file:
        pressure, nodes = file["contact/LEFT/pressure"][0], file["contact/LEFT/slave_node"][()]
    rows = zip(nodes.tolist(), pressure.tolist())
    table = [f"{node:6d}{value:14.6E}" for node, value in rows]
    (folder / "old.lst").write_text("\n".join(["LOAD = 1.0", "FORCE = 5.", " NODE  P", *table, ""]))
    rows = [line.split() for line in table]
    words = [f"LEFT,{node},1.0,{value}" for node, value in rows]
    (folder / "figure.csv").write_text("\n".join(["contact,node,load,pressure", *words]))
    (folder / "form.toml").write_text(TEMPLATE)
    return folder


def calls(folder, random):
    """Return a file to damage, and the program and arguments that read it."""
    result = folder / ("loads.vtkhdf" if random.integers(2) else "brake_pad.vtkhdf")
    which = int(random.integers(8))
    if which < 3:
        picture = PICTURES[int(random.integers(len(PICTURES)))]
        return result, cli.main, [*picture[:1], str(result), *picture[1:]]
    if which == 3:
        return result, report.main, [str(result)]
    others = [result, folder / "old.lst", folder / "figure.csv", *sorted(folder.glob("*.frd")),
              *sorted(folder.glob("*.dat"))]
    other = others[int(random.integers(len(others)))]
    if which < 6 and other != result:
        pair = [folder / "loads.vtkhdf", other]
    else:
        pair, other = [result, shutil.copy(result, folder / f"copy-{result.name}")], result
    form = ["--template", str(folder / "form.toml")] if other.suffix == ".lst" else []
    ways = [["--axis", "load"]] if other.suffix in (".lst", ".csv") else [[], ["--by", "coordinate"]]
    ways += [["--by", "curve"], ["--all-keys"]]
    way = ways[int(random.integers(len(ways)))]
    return other, comparison.main, [*map(str, pair), *form, *way]


def too_long(*_):
    """End a call that takes too long: no program catches this."""
    raise KeyboardInterrupt("took too long")


@pytest.fixture
def bounded(monkeypatch):
    """Bound time and memory; render in full only where many files are tried."""
    if "THERCON_FUZZ" in os.environ:
        monkeypatch.setitem(style.SETTINGS, "savefig.dpi", 60)
    else:
        monkeypatch.setattr(Figure, "savefig", lambda self, path, **_: path.write_text("not drawn"))
    size = int(re.search(r"VmSize:\s*(\d+)", Path("/proc/self/status").read_text())[1]) * 1024
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (size + ROOM, before[1]))
    signal.signal(signal.SIGPROF, too_long)
    yield
    signal.setitimer(signal.ITIMER_PROF, 0)
    resource.setrlimit(resource.RLIMIT_AS, before)


def test_a_damaged_file_is_one_line_and_status_2(whole, bounded, tmp_path, capfd):
    """Or it is read all the same. Status 1 is kept for a comparison that was made."""
    told, unforeseen = [], []
    for seed in range(FIRST, FIRST + FILES):
        folder = tmp_path / str(seed)
        shutil.copytree(whole, folder)
        path, main, arguments = calls(folder, np.random.default_rng(seed))
        done = f"seed {seed}: {damage(path, seed)}; {' '.join(arguments)}"
        capfd.readouterr()
        signal.setitimer(signal.ITIMER_PROF, LONGEST)
        status = main([*arguments, "--out", str(folder / "out")])
        signal.setitimer(signal.ITIMER_PROF, 0)
        out, said = capfd.readouterr()
        assert status in (0, 2) or (status == 1 and out.endswith("NOT within tolerance\n")), done
        assert "memory ran out" not in said, (done, said)
        if status == 2:
            assert re.fullmatch(r"(plot|report|compare): error: [^\n]+\n", said), (done, said)
            told.append(said)
        else:
            assert said == "", (done, said)
        unforeseen += [f"{done}\n   {said}"] if "cannot be evaluated" in said else []
        shutil.rmtree(folder)
    assert len(told) > FILES // 3, "the files are hardly damaged"
    print("\n".join(unforeseen), f"\n{len(told)} of {FILES} refused, {len(unforeseen)} by the guard")
    assert len(unforeseen) < 0.1 * FILES
