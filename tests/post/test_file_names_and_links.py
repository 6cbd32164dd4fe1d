"""post: names of files that are no UTF-8, hostile texts in pictures, files that ask for others."""

import csv
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure

POST = Path(__file__).resolve().parents[2] / "post"
sys.path.insert(0, str(POST.parent / "python"))

from synthetic import write_result  # noqa: E402

from thercon.post.cli import main  # noqa: E402
from thercon.post.comparison.cli import main as compare  # noqa: E402
from thercon.post.errors import UserError  # noqa: E402
from thercon.post.result import Result  # noqa: E402

NAME = b"joint\xff.vtkhdf"


def call(folder, program, *arguments, **environment):
    """Run a program of post in a folder; return exit status, output and message, as bytes."""
    command = [sys.executable, POST / program, *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, check=False,
                          env=os.environ | environment)
    return done.returncode, done.stdout, done.stderr


@pytest.fixture
def result(tmp_path):
    """Return the folder with a result whose name is no UTF-8."""
    write_result(tmp_path / "case.vtkhdf", loads=(1.0, 5.0), columns=4, rows=2)
    os.rename(tmp_path / "case.vtkhdf", os.fsencode(tmp_path) + b"/" + NAME)
    return tmp_path


@pytest.mark.parametrize(("arguments", "written", "language"), [
    (["plot", "zones", "--csv", NAME], [b"joint\xff.zones" + end
                               for end in (b".png", b".svg", b".csv", b"-pairs.csv")], "C"),
    (["report", NAME], [b"joint\xff.html"], "C.UTF-8"),
    (["compare", "--csv", NAME, NAME], [b"joint\xff.compare" + end
                               for end in (b"-blocks.csv", b".png", b".svg", b".csv")], "C"),
])
def test_a_name_that_is_no_utf8_is_read_shown_and_kept(result, arguments, written, language):
    status, out, said = call(result, *arguments, LC_ALL=language)
    assert (status, said) == (0, b"")
    for name in written:
        assert name in out.splitlines()
        content = Path(os.fsdecode(os.fsencode(result) + b"/" + name)).read_bytes()
        assert name.endswith(b".png") or content.decode(), "text is UTF-8"
        if name.endswith(b".svg"):
            ElementTree.fromstring(content)
        if name.endswith(b".html"):
            assert "<h1>joint\N{REPLACEMENT CHARACTER}</h1>" in content.decode()


def test_a_message_names_such_a_file_by_its_bytes(tmp_path):
    assert call(tmp_path, "plot", "mesh", NAME) == \
        (2, b"", b"plot: error: joint\xff.vtkhdf: no such file\n")


def test_a_mistake_of_the_program_is_told_in_one_line_or_in_full(usual, tmp_path, monkeypatch, capsys):
    """It is planted where every table is written."""
    def writer(*_, **__):
        raise KeyError("planted\nhere")

    monkeypatch.setattr(csv, "writer", writer)
    arguments = ["zones", "--csv", str(usual), "--out", str(tmp_path)]
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert said.startswith(f"plot: error: {usual}: cannot be evaluated (KeyError: ")
    assert "at tables.py:" in said and "THERCON_TRACEBACK=1" in said
    monkeypatch.setenv("THERCON_TRACEBACK", "1")
    with pytest.raises(KeyError, match="planted"):
        main(arguments)


@pytest.mark.vectors
def test_texts_in_pictures_are_text(tmp_path, capsys, monkeypatch):
    """Of units, loads, contacts and files: no element but those of matplotlib, no handler."""
    save = Figure.savefig
    monkeypatch.setattr(Figure, "savefig", lambda figure, path, **options:
                        save(figure, path, **options) if path.suffix == ".svg" else None)
    hostile = "\"'--><script>x</script><svg onload=x> $\\frac{$ \x01"
    path = tmp_path / "a<b>&$'.vtkhdf"
    write_result(path, contacts=(hostile.replace("/", ""), "OTHER"), label=hostile, loads=(1.0, 5.0),
                 columns=4, rows=2)
    with h5py.File(path, "r+") as file:
        for key in ("length", "stress", "power", "temperature"):
            file["run"].attrs[f"unit_{key}"] = hostile
    for picture in ("mesh", "profiles", "zones", "fields", "convergence"):
        assert main([picture, str(path), "--out", str(tmp_path)]) == 0
        assert capsys.readouterr().err == "", picture
    assert compare([str(path), str(path), "--out", str(tmp_path)]) == 0
    drawn = list(tmp_path.glob("*.svg"))
    assert len(drawn) == 8
    allowed = {"svg", "metadata", "RDF", "Work", "type", "format", "creator", "Agent", "title", "defs",
               "style", "g", "path", "use", "clipPath", "rect", "image"}
    for picture in drawn:
        for element in ElementTree.parse(picture).iter():
            assert element.tag.rpartition("}")[2] in allowed, (picture, element.tag)
            assert not [key for key in element.attrib if key.startswith("on")]
            href = element.get("{http://www.w3.org/1999/xlink}href", "#")
            assert href.startswith(("#", "data:image/png;base64,"))


def external(file, other):
    """Replace /contact by a link to that of another file."""
    del file["contact"]
    file["contact"] = h5py.ExternalLink(other, "/contact")


def soft(file, other):
    """Reach another file by way of a soft link."""
    file["aside"] = h5py.ExternalLink(other, "/")
    del file["history"]
    file["history"] = h5py.SoftLink("/aside/history")


def storage(file, other):
    """Keep the loads as bytes of another file."""
    count = len(file["history/load"])
    del file["history/load"]
    file.create_dataset("history/load", (count,), "f8", external=[(other, 0, 8 * count)])


def virtual(file, other):
    """Take the loads from another file."""
    count = len(file["history/load"])
    del file["history/load"]
    layout = h5py.VirtualLayout((count,), "f8")
    layout[:] = h5py.VirtualSource(other, "history/load", (count,))
    file["history"].create_virtual_dataset("load", layout)


@pytest.mark.parametrize("reach", [external, soft, storage, virtual])
def test_no_other_file_is_read(tmp_path, reach):
    for name in ("case", "other"):
        write_result(tmp_path / f"{name}.vtkhdf", loads=(1.0, 5.0), columns=4, rows=2)
    with h5py.File(tmp_path / "case.vtkhdf", "r+") as file:
        reach(file, str(tmp_path / "other.vtkhdf"))
    with pytest.raises(UserError, match="not followed|not read"):
        Result(tmp_path / "case.vtkhdf")


def test_a_dataset_that_claims_more_than_it_has_is_refused_and_a_compressed_one_read(tmp_path):
    path = tmp_path / "case.vtkhdf"
    write_result(path, loads=(1.0, 5.0))
    with h5py.File(path, "r+") as file:
        stress = file["VTKHDF/PointData/stress"][()]
        del file["VTKHDF/PointData/stress"]
        file["VTKHDF/PointData"].create_dataset("stress", data=0.0 * stress, compression="gzip",
                                                compression_opts=9)
    Result(path).file.close()
    with h5py.File(path, "r+") as file:
        del file["contact/CYLINDER/pressure"]
        file["contact/CYLINDER"].create_dataset("pressure", (2, 10**9), "f8", chunks=(1, 1024))
    with pytest.raises(UserError, match="pressure claims to be larger"):
        Result(path)


def test_values_that_are_missing_where_none_may_be_are_named(tmp_path):
    path = tmp_path / "case.vtkhdf"
    write_result(path, loads=(1.0, 5.0))
    with h5py.File(path, "r+") as file:
        file["history/load"][1] = np.nan
    with Result(path) as result, pytest.raises(UserError, match="load has values that are no numbers"):
        assert result.history
