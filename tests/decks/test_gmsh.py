"""Meshes as gmsh writes them for Abaqus: stored ones (gmsh/make_meshes.sh), and fresh ones where
there is a gmsh. A contact of two bodies is input/examples/hot_sleeve.inp."""

import shutil
import subprocess

import h5py
import pytest
from blocks import write
from deck_runs import DECKS, PATIENCE, run
from physics import judge

FOLDER = DECKS / "gmsh"
YOUNG, POISSON, LOAD = 1000.0, 0.3, 5.0
KINDS = "quads8", "quads4", "triangles6", "triangles3", "everything"
# gmsh places the points along a curve to 1e-12 of its length.
TOLERANCE = 1e-9


@pytest.fixture(scope="module", params=["stored", "fresh"])
def meshes(request, tmp_path_factory):
    """Return a folder of meshes."""
    if request.param == "stored":
        return FOLDER
    gmsh = shutil.which("gmsh")
    if not gmsh:
        pytest.skip("there is no gmsh")
    folder = tmp_path_factory.mktemp("meshes")
    for path in [*FOLDER.glob("*.geo"), FOLDER / "make_meshes.sh"]:
        shutil.copy(path, folder)
    subprocess.run(["bash", folder / "make_meshes.sh", gmsh], check=True, timeout=PATIENCE)
    return folder


def square(*cards):
    """Return a deck of the square on rollers; its mesh stands beside it."""
    return ["*HEADING", "Square", "*INCLUDE, INPUT=square.mesh",
            "*NSET, NSET=LOW, ELSET=Bottom", "*NSET, NSET=LEFT, ELSET=left_side",
            "*NSET, NSET=HIGH, ELSET=top_side", "*SURFACE, NAME=HIGH", "TOP_SIDE",
            "*SURFACE, NAME=AROUND", "around",
            "*MATERIAL, NAME=BLOCK", "*ELASTIC", f"{YOUNG}, {POISSON}",
            "*SOLID SECTION, ELSET=block, MATERIAL=BLOCK", *cards]


def loaded(surface):
    """Return a step with a pressure on a surface."""
    return ["*STEP", "*STATIC", "*BOUNDARY", "LOW, 2", "LEFT, 1", "*DSLOAD",
            f"{surface}, P, {LOAD}", "*END STEP"]


def stresses(x, y):
    """Return the checks of uniform stresses."""
    return [(f"S{i}{i}", end, "LAST", value, LOAD * TOLERANCE, "ABS")
            for i, value in ((1, x), (2, y)) for end in ("MIN", "MAX")]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("plane", ["", "STRAIN"])
def test_pressed_square(tmp_path, meshes, kind, plane):
    """In plane stress, as the names of the elements say, or in plane strain, as *OPTIONS."""
    shutil.copy(meshes / f"{kind}.mesh", tmp_path / "square.mesh")
    down, across = -LOAD / YOUNG, LOAD * POISSON / YOUNG
    if plane:
        down, across = down * (1 - POISSON**2), across * (1 + POISSON)
    deck = square(*([f"*OPTIONS, PLANE={plane}"] if plane else []), *loaded("HIGH"))
    judge(tmp_path, deck, [*stresses(0.0, -LOAD), ("U2", "HIGH", "LAST", down, TOLERANCE),
                           ("U1", "MAX", "LAST", across, TOLERANCE)])
    assert "   Square" in next(line for line in (tmp_path / "deck.lst").read_text().splitlines()
                               if line.startswith("heading"))


@pytest.mark.parametrize("kind", KINDS)
def test_lines_all_around_are_all_outer_faces(tmp_path, meshes, kind):
    shutil.copy(meshes / f"{kind}.mesh", tmp_path / "square.mesh")
    judge(tmp_path, square(*loaded("AROUND")), stresses(-LOAD, -LOAD))


def test_lines_are_no_elements_of_the_result(tmp_path, meshes):
    shutil.copy(meshes / "quads8.mesh", tmp_path / "square.mesh")
    with h5py.File(judge(tmp_path, square(*loaded("HIGH")), stresses(0.0, -LOAD))) as file:
        assert len(file["VTKHDF/CellData/element_id"]) == 4
    listing = (tmp_path / "deck.lst").read_text()
    assert listing.count("*ELEMENT, TYPE=T3D3: lines are ignored") == 1


def test_refined_mesh(tmp_path, meshes):
    """Node sets and surfaces of lines follow."""
    shutil.copy(meshes / "triangles6.mesh", tmp_path / "square.mesh")
    judge(tmp_path, square("*REFINE, LEVELS=2", *loaded("HIGH")),
          [*stresses(0.0, -LOAD), ("U2", "HIGH", "LAST", -LOAD / YOUNG, TOLERANCE)])


def test_corners_alone(tmp_path, meshes):
    """ORDER=1 takes the midside nodes from elements and lines alike."""
    shutil.copy(meshes / "quads8.mesh", tmp_path / "square.mesh")
    judge(tmp_path, square("*OPTIONS, ORDER=1", *loaded("HIGH")), stresses(0.0, -LOAD))


def test_node_sets_that_gmsh_writes(tmp_path, meshes):
    """Mesh.SaveGroupsOfNodes: a node set of each physical group, points too."""
    shutil.copy(meshes / "everything.mesh", tmp_path / "square.mesh")
    step = loaded("HIGH")
    step[step.index("LOW, 2"):step.index("*DSLOAD")] = ["bottom, 2", "corner, 1"]
    judge(tmp_path, square(*step),
          [*stresses(0.0, -LOAD), ("U2", "top_side", "LAST", -LOAD / YOUNG, TOLERANCE)])


def refusal(folder, mesh, *cards):
    """Return what `thercon check` says of a deck with a mesh."""
    shutil.copy(mesh, folder / mesh.name)
    deck = [f"*INCLUDE, INPUT={mesh.name}", *cards, "*MATERIAL, NAME=M", "*ELASTIC", "1., 0.",
            "*SOLID SECTION, ELSET=block, MATERIAL=M", *loaded("HIGH")]
    process = run("check", write(folder / "deck.inp", deck))
    assert process.returncode == 1
    return process.stderr


def test_nine_nodes_are_refused_by_name(tmp_path, meshes):
    message = refusal(tmp_path, meshes / "quads9.mesh")
    assert "element type M3D9 is refused" in message
    assert "in gmsh set Mesh.SecondOrderIncomplete = 1" in message


@pytest.mark.parametrize(("name", "fault"), [
    ("inside", "lies inside a body, between two elements"),
    ("beside", "belongs to no side of an element")])
def test_a_line_that_is_no_face(tmp_path, meshes, name, fault):
    message = refusal(tmp_path, meshes / "inner_line.mesh", "*SURFACE, NAME=HIGH", name)
    assert f":3:1: error: line " in message
    assert fault in message


def test_a_curve_at_the_place_of_that_of_a_surface(tmp_path, meshes):
    """A drawing may have two curves in one place: the nodes of the second are those of no element."""
    message = refusal(tmp_path, meshes / "quads4.mesh", "*NODE", "901, 0., 1.", "902, 1., 1.",
                      "*ELEMENT, TYPE=T3D2, ELSET=TWIN", "901, 901, 902", "*SURFACE, NAME=HIGH", "TWIN")
    assert "line 901 from node 901 to 902 belongs to no side of an element, nor do its nodes" in message
    assert "such as a second one at the place of one that is" in message


@pytest.mark.parametrize(("plane", "warned"), [("", True), ("STRESS", False), ("STRAIN", False)])
def test_plane_stress_of_gmsh_is_warned_of_where_gmsh_wrote_it(tmp_path, plane, warned):
    """Once, at the first type of an element."""
    shutil.copy(FOLDER / "everything.mesh", tmp_path / "square.mesh")
    options = [f"*OPTIONS, PLANE={plane}"] if plane else []
    process = run("check", write(tmp_path / "deck.inp", options + square(*loaded("HIGH"))))
    assert process.returncode == 0, process.stderr
    assert ("gmsh calls all elements CPS, plane stress" in process.stderr) == warned
    if warned:
        line = int(process.stderr.partition("square.mesh:")[2].partition(":")[0])
        assert "CPS" in (tmp_path / "square.mesh").read_text().splitlines()[line - 1]
