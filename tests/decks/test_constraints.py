"""Equations between degrees of freedom, couplings and axes of nodes: CalculiX on the same decks, and
closed forms."""

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from calculix import DIGITS, assert_within, calculix, differences, thercon
from changes import note_changes
from deck_runs import solve
from physics import judge, material, mesh

STATIC = ["*STEP", "*STATIC", "1., 1."]
HEATED = ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1."]
PRINTS = ["*NODE PRINT, NSET=BODY", "U", "*EL PRINT, ELSET=BODY", "S"]
LEFT_HELD = ["*BOUNDARY", "BODY.LEFT, 1, 2"]


def body(kind="CPE8", poisson=0.3, xs=(0.0, 1.0, 2.0), ys=(0.0, 1.0), **options):
    """Return a body of E = 1000, alpha = 1e-5, K = 2."""
    return [*mesh("BODY", list(xs), list(ys), kind, 1, **options),
            *material("BODY", (1000.0, poisson), 1e-5, 2.0),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0."]


def lines(*parts):
    """Return one list of cards."""
    return without_unused_surfaces([card for part in parts for card in part])


def both(folder, *parts):
    """Return what CalculiX and thercon print of one deck."""
    deck = write(folder / "deck.inp", lines(*parts))
    return calculix(deck), thercon(deck)


def pull(*cards):
    """Return a step that loads the corners 9 and 10 and a midside node."""
    return [*STATIC, *LEFT_HELD, "*CLOAD", "10, 1, 30.", "13, 2, -5.", *cards, *PRINTS,
            "*END STEP"]


EQUATIONS = ["*EQUATION", "2", "10, 1, 1., 9, 1, -1.", "3", "12, 2, 1., 9, 2, -0.7, 10, 2, 0.4"]


@pytest.mark.changes("EQUATION")
def test_equations_of_displacements_as_in_calculix(tmp_path):
    weaker = [card.replace("-0.7", "-0.3") for card in EQUATIONS]
    for equations in (weaker, EQUATIONS):
        theirs, ours = both(tmp_path, body(), equations, pull())
        assert_within(differences(theirs, ours), DIGITS)
        assert ours[1.0, "U1"][10,] == ours[1.0, "U1"][9,]
    note_changes(weaker, EQUATIONS)


def test_a_node_of_no_element_pulls_what_equations_relate_to_it(tmp_path):
    """A force on it is shared; a displacement of it is that of all, and its reaction their sum."""
    follow = ["*NODE, NSET=PULLED", "1000, 5., 5.", "*EQUATION",
              *(f"2\n{n}, 1, 1., 1000, 1, -1." for n in (9, 10, 12))]
    theirs, ours = both(tmp_path, body(), follow, STATIC, LEFT_HELD, ["*CLOAD", "1000, 1, 30."],
                        PRINTS, ["*END STEP"])
    assert_within(differences(theirs, ours), DIGITS)
    judge(tmp_path, lines(body(poisson=0.0), follow, STATIC, LEFT_HELD,
                          ["*BOUNDARY", "1000, 1, 1, 0.02", "*END STEP"]),
          [("RF1", "PULLED", "LAST", 10.0, 1e-9), ("S11", "MIN", "LAST", 10.0, 1e-9),
           ("force_imbalance", "", "LAST", 0.0, 1e-10, "ABS")])


def test_equations_of_temperatures_as_in_calculix(tmp_path):
    theirs, ours = both(
        tmp_path, body(), ["*NODE", "1000, 5., 5.", "*EQUATION", "2", "10, 11, 1., 9, 11, -1.", "3",
                           "12, 11, 2., 9, 11, -1., 1000, 11, -1."], HEATED,
        ["*BOUNDARY", "BODY.LEFT, 11, 11, 3.", "1000, 11, 11, 20.", "*CFLUX", "13, 11, 5.",
         "*NODE PRINT, NSET=BODY", "NT", "*EL PRINT, ELSET=BODY", "HFL", "*END STEP"])
    assert_within(differences(theirs, ours), DIGITS)


def test_sets_of_an_equation_are_taken_node_by_node(tmp_path):
    """Opposite faces of a periodic cell: equal displacements leave a mean strain of zero along x,
    under a temperature rise: sigma_xx = -E alpha T (nu = 0)."""
    sets = ["*EQUATION", "2", "BODY.RIGHT, 1, 1., BODY.LEFT, 1, -1.", "2",
            "BODY.RIGHT, 2, 1., BODY.LEFT, 2, -1."]
    hold = ["*BOUNDARY", "1, 1, 2", "*TEMPERATURE", "BODY, 100.", "*END STEP"]
    judge(tmp_path, lines(body(poisson=0.0), sets, STATIC, hold),
          [("S11", "MIN", "LAST", -1.0, 1e-9), ("S11", "MAX", "LAST", -1.0, 1e-9),
           ("S22", "MAX", "LAST", 0.0, 1e-9, "ABS")])


def coupled_to(node, degrees, name="BODY.RIGHT"):
    """Return a coupling to a reference node at (3, 2)."""
    return [f"*NODE, NSET={node}", "1000, 3., 2.", f"*COUPLING, REF NODE={node}, SURFACE={name}, "
            "CONSTRAINT NAME=GRIP", "*KINEMATIC", degrees]


def written_out(nodes=((9, 0.0), (10, 1.0), (12, 0.5))):
    """Return the equations of this coupling, with a node for the rotation."""
    cards = ["*NODE, NSET=GRIP", "1000, 3., 2.", "*NODE, NSET=TURN", "1001, 3., 2.", "*EQUATION"]
    for number, y in nodes:
        cards += ["3", f"{number}, 1, 1., 1000, 1, -1., 1001, 1, {y - 2.0}",
                  "3", f"{number}, 2, 1., 1000, 2, -1., 1001, 1, {3.0 - 2.0}"]
    return cards


@pytest.mark.parametrize(("coupled", "plain"), [
    (["*CLOAD", "1000, 1, 30.", "1000, 2, 7."], ["*CLOAD", "1000, 1, 30.", "1000, 2, 7."]),
    (["*CLOAD", "1000, 6, 5."], ["*CLOAD", "1001, 1, 5."]),
    (["*BOUNDARY", "1000, 1, 1, 0.01", "1000, 6, 6, 0.02"],
     ["*BOUNDARY", "1000, 1, 1, 0.01", "1001, 1, 1, 0.02"]),
    (["*BOUNDARY", "GRIP, ENCASTRE", "*CLOAD", "13, 2, 3."],
     ["*BOUNDARY", "1000, 1, 2", "1001, 1, 1", "*CLOAD", "13, 2, 3."])],
    ids=["force", "moment", "turned", "held"])
def test_a_coupling_is_the_equations_of_a_rigid_face(tmp_path, coupled, plain):
    """CalculiX runs the equations, written out."""
    grip = coupled_to("GRIP", "1, 2")
    ours = thercon(write(tmp_path / "coupled.inp",
                         [*body(), *grip, *STATIC, *LEFT_HELD, *coupled, *PRINTS, "*END STEP"]))
    theirs = calculix(write(tmp_path / "deck.inp", lines(
        body(), written_out(), STATIC, LEFT_HELD, plain, PRINTS, ["*END STEP"])))
    assert_within(differences(theirs, ours), DIGITS)


def extension(reference, surface, degrees):
    """Return a deck in which a force of 10 pulls a face without Poisson's effect."""
    xs = [0.0, 1.0, 2.0]
    return [*mesh("BODY", xs, [0.0, 1.0], "CPE8", 1), *material("BODY", (1000.0, 0.0), 1e-5, 2.0),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.",
            "*NODE, NSET=ONE", "1000, 2.5, 0.5", "*NODE, NSET=OTHER", "1001, 3., 0.5",
            f"*COUPLING, REF NODE={reference}, SURFACE={surface}, CONSTRAINT NAME=GRIP", "*KINEMATIC",
            *degrees, *STATIC, *LEFT_HELD, "*CLOAD", f"{reference}, 1, 10."]


@pytest.mark.changes("COUPLING, REF NODE", "COUPLING, SURFACE", "KINEMATIC")
def test_reference_node_surface_and_degrees_of_a_coupling(tmp_path):
    """A pull along the middle line stretches by F L/(E A), wherever on it the reference node is."""
    first = extension("1000", "BODY.RIGHT", ["1, 2"])
    other = [card.replace("BODY.RIGHT, CONSTRAINT", "BODY.TOP, CONSTRAINT")
             for card in extension("OTHER", "BODY.RIGHT", ["1"])]
    note_changes(first, other)
    judge(tmp_path, without_unused_surfaces([*first, "*END STEP"]),
          [("U1", "ONE", "LAST", 0.02, 1e-9), ("U1", "BODY.RIGHT", "LAST", 0.02, 1e-9)])
    judge(tmp_path, without_unused_surfaces([*extension("OTHER", "BODY.RIGHT", ["1"]), "*END STEP"]),
          [("U1", "OTHER", "LAST", 0.02, 1e-9), ("S11", "MAX", "LAST", 10.0, 1e-9)])


def test_a_coupling_of_temperatures_is_isothermal(tmp_path):
    """Heat into the reference node warms the face evenly: T = Q L/(K A)."""
    cards = [*body(), *coupled_to("GRIP", "11"), *HEATED, "*BOUNDARY", "BODY.LEFT, 11, 11, 3.",
             "*CFLUX", "1000, 11, 4.", "*END STEP"]
    judge(tmp_path, without_unused_surfaces(cards), [("NT", "BODY.RIGHT", "LAST", 7.0, 1e-9),
                                                     ("NT", "GRIP", "LAST", 7.0, 1e-9)])


SLANT = np.radians(30.0)
RECTANGULAR = ["*TRANSFORM, NSET=BODY.RIGHT, TYPE=R",
               f"{np.cos(SLANT):.15g}, {np.sin(SLANT):.15g}, 0., -0.5, 1., 0."]
ROUND = ["*TRANSFORM, NSET=BODY.RIGHT, TYPE=C", "0.5, -1., 0., 0.5, -1., 1."]


@pytest.mark.changes("TRANSFORM", "TRANSFORM, TYPE", "TRANSFORM, NSET", "NODE PRINT, GLOBAL")
def test_supports_and_forces_along_axes_of_nodes_as_in_calculix(tmp_path):
    """Rectangular axes, cylindrical ones about an axis and its reverse, and those of other nodes."""
    cards = [*STATIC, *LEFT_HELD, "10, 1, 1, 0.01", "12, 2, 2, -0.004", "*CLOAD", "9, 1, 3.",
             "9, 2, -1.", "12, 1, 2.", "*NODE PRINT, NSET=BODY, GLOBAL=YES", "U",
             "*EL PRINT, ELSET=BODY", "S", "*END STEP"]
    decks = []
    for axes in (RECTANGULAR, ROUND, [ROUND[0], "0.5, -1., 0., 0.5, -1., -1."],
                 [ROUND[0].replace("RIGHT", "TOP"), ROUND[1]]):
        for choice in ("GLOBAL=YES", "GLOBAL=NO"):
            decks.append([*axes, *(c.replace("GLOBAL=YES", choice) for c in cards)])
            theirs, ours = both(tmp_path, body(), decks[-1])
            assert_within(differences(theirs, ours), DIGITS)
            assert (ours[1.0, "U1"][10,] == 0.01) == (choice == "GLOBAL=NO")
    for other in decks[1:]:
        note_changes(decks[0], other)


@pytest.mark.parametrize("points, place", [
    # Axis 2, or axis 1, is along z: degrees of freedom of the others, and the sign of the second.
    ("{c}, {s}, 0., {c}, {s}, 2.", {1: (1, 1), 2: (3, -1)}),
    ("{c}, {s}, 0., 0., 0., -1.", {1: (1, 1), 2: (3, 1)}),
    ("0., 0., 1., {c}, {s}, 5.", {1: (2, 1), 2: (3, 1)}),
    ("0., 0., -2., {c}, {s}, 0.", {1: (2, 1), 2: (3, -1)})])
def test_one_of_the_axes_of_nodes_may_be_out_of_the_plane(tmp_path, points, place):
    """Supports, forces, equations and springs are those along the axes that are in the plane."""
    def deck(axes, place):
        (one, _), (two, sign) = place[1], place[2]
        out = 6 - one - two
        return [*body(), *RECTANGULAR[:1], axes, "*ELEMENT, TYPE=SPRING1, ELSET=SPRING", "99, 12",
                "*SPRING, ELSET=SPRING", f"{two}", "50.", "*EQUATION", "2", f"9, {two}, {sign}., 6, 2, -1.",
                *STATIC, *LEFT_HELD, f"10, {one}, {one}, 0.01", f"10, {out}", "*CLOAD", f"9, {one}, 3.",
                f"12, {two}, {2 * sign}.", "*NODE PRINT, NSET=BODY, GLOBAL=YES", "U", "*END STEP"]
    axes = {"c": repr(float(np.cos(SLANT))), "s": repr(float(np.sin(SLANT)))}
    plain = deck(RECTANGULAR[1], {1: (1, 1), 2: (2, 1)})
    plain.remove("10, 3")
    expected = thercon(write(tmp_path / "plain.inp", lines(plain)))
    found = thercon(write(tmp_path / "deck.inp", lines(deck(points.format(**axes), place))))
    assert_within(differences(expected, found), DIGITS)


def test_equations_along_axes_of_nodes_as_in_calculix(tmp_path):
    theirs, ours = both(tmp_path, body(), RECTANGULAR, EQUATIONS, pull())
    assert_within(differences(theirs, ours), DIGITS)


def test_an_inclined_roller_pushes_along_its_axis(tmp_path):
    """The reaction of a slanted support has no component along the support."""
    cards = lines(body(), RECTANGULAR, STATIC, LEFT_HELD,
                  ["10, 1, 1, 0.01", "*NODE PRINT, NSET=BODY, GLOBAL=YES", "U, RF", "*END STEP"])
    ours = thercon(write(tmp_path / "deck.inp", cards))
    u = np.array([ours[1.0, f"U{i}"][10,] for i in (1, 2)])
    force = np.array([ours[1.0, f"RF{i}"][10,] for i in (1, 2)])
    axis = np.array([np.cos(SLANT), np.sin(SLANT)])
    assert axis @ u == pytest.approx(0.01, rel=1e-6)
    assert abs(force[0] * axis[1] - force[1] * axis[0]) < 1e-6 * np.hypot(*force)
    assert axis @ force > 0.0


ROUND_THE_AXIS = ["*NSET, NSET=ENDS",
                  *(f"{n}.{side}" for n in ("INNER", "OUTER") for side in ("BOTTOM", "TOP")),
                  "*TRANSFORM, NSET=ENDS, TYPE=C", "0., 0., 0., 0., 0., 1."]


def sector(kind="CPE8", begin=20.0, width=30.0, sides=(3, 3), friction=0.0):
    """Return two tubes, one pressed on the other, as a sector between radii at these angles."""
    def to(x, y):
        angle = np.radians(begin + width * y)
        return float(x * np.cos(angle)), float(x * np.sin(angle))
    inner, outer = ([float(v) for v in np.linspace(0.0, 1.0, n + 1)] for n in sides)
    return [*mesh("INNER", [1.0, 1.25, 1.5], inner, kind, 1, to=to),
            *mesh("OUTER", [1.5, 1.75, 2.0], outer, kind, 1001, to=to),
            *material("INNER", (1000.0, 0.3), 1e-5, 2.0), *material("OUTER", (1000.0, 0.3), 1e-5, 2.0),
            "*SURFACE INTERACTION, NAME=FACES", *(["*FRICTION", f"{friction}"] if friction else []),
            "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "INNER.RIGHT, OUTER.LEFT",
            "*CLEARANCE, SLAVE=INNER.RIGHT, MASTER=OUTER.LEFT, VALUE=-0.001"]


def test_hanging_nodes_follow_their_side_whose_axes_supports_hold(tmp_path):
    """A body whose nodes all move along one slanted axis does so where it is refined locally, too."""
    axis = np.array([np.cos(SLANT), np.sin(SLANT)])
    cards = [*body(xs=(0.0, 1.0, 2.0, 3.0), ys=(0.0, 1.0, 2.0)), "*REFINE, SURFACE=BODY.RIGHT, LEVELS=1",
             "*TRANSFORM, NSET=BODY, TYPE=R",
             f"{axis[0]:.15g}, {axis[1]:.15g}, 0., {-axis[1]:.15g}, {axis[0]:.15g}, 0.", *STATIC,
             "*BOUNDARY", "BODY, 2", "BODY.BOTTOM, 1", "BODY.TOP, 1, 1, 0.02",
             "*NODE PRINT, NSET=BODY, GLOBAL=YES", "U", "*END STEP"]
    ours = thercon(write(tmp_path / "deck.inp", cards))
    assert max(ours[1.0, "U1"].values()) == pytest.approx(0.02 * axis[0])
    for node, u in ours[1.0, "U1"].items():
        assert ours[1.0, "U2"][node] == pytest.approx(u * axis[1] / axis[0], rel=2e-6, abs=1e-12)


def test_a_sector_between_radii_carries_contact_up_to_its_ends(tmp_path):
    """Two tubes with an interference: the pressure is Lame's on the radii, too, where both nodes are
    held round the axis and free along it."""
    cards = [*sector(), *ROUND_THE_AXIS, *STATIC, "*BOUNDARY", "ENDS, 2, 2", "*END STEP"]
    young, nu = 1000.0 / (1.0 - 0.09), 0.3 / 0.7
    a, b, c = 1.0, 1.5, 2.0
    give = b / young * ((c * c + b * b) / (c * c - b * b) + nu + (b * b + a * a) / (b * b - a * a) - nu)
    judge(tmp_path, without_unused_surfaces(cards), [("pressure", "FACE", "LAST", 0.001 / give, 2e-3)])


@pytest.mark.parametrize("kind, sides, friction", [
    ("CPE4", (5, 7), 0.0), ("CPE4", (7, 5), 0.3), ("CPE8", (3, 4), 0.3)])
def test_a_quarter_between_slanted_radii_is_the_quarter_between_x_and_y(tmp_path, kind, sides, friction):
    """Contact of faces that do not match, whose normals at the ends are not along the radii."""
    straight = [*sector(kind, 0.0, 90.0, sides, friction), *STATIC, "*BOUNDARY", "INNER.BOTTOM, 2, 2",
                "OUTER.BOTTOM, 2, 2", "INNER.TOP, 1, 1", "OUTER.TOP, 1, 1", "*END STEP"]
    slanted = [*sector(kind, 25.0, 90.0, sides, friction), *ROUND_THE_AXIS, *STATIC, "*BOUNDARY",
               "ENDS, 2, 2", "*END STEP"]
    found = []
    for name, cards in (("straight", straight), ("slanted", slanted)):
        deck = write(tmp_path / f"{name}.inp", without_unused_surfaces(cards))
        with h5py.File(solve(deck)) as file:
            face = file["contact/FACE"]
            found.append([face["pressure"][-1], face["shear"][-1]])
    assert np.min(found[0][0]) > 0.0
    np.testing.assert_allclose(found[1], found[0], atol=1e-9 * np.max(found[0]))
