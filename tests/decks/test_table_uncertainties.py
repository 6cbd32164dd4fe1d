"""Uncertainties of the numbers in tables, with ERRORS=FULL: they hold the exact values."""

import re

import numpy as np
import pytest
from deck_runs import CYLINDER, INPUT, run

HEAD = re.compile(r"   (UNCERTAINTIES \(95 %\) OF )?((?:NODES|TOTALS|CONTACT POINTS) OF \S+)\s*")
PRESSURE = 25.845094   # of Lame, as in the deck


def tables(listing):
    """Return the last tables of a listing: {(of uncertainties, title): {node: {column: number}}}."""
    found, rows = {}, None
    for line in listing.read_text().splitlines():
        if match := HEAD.fullmatch(line):
            rows = found[bool(match[1]), match[2]] = {}
            heads = None
        elif rows is None or not line.strip():
            rows = None
        elif heads is None:
            heads = line.split()
        else:
            words = line.split()
            key = 1 if heads[0] == "no." else 0
            rows[words[key] if heads[0] in ("no.", "node") else ""] = {
                head: float(word) for head, word in zip(heads, words, strict=True)
                if head not in ("no.", "node", "slave", "master", "zone")}
    return found


def solved(path, text, *options):
    """Solve a deck; return its tables."""
    path.write_text(text)
    process = run("run", "--quiet", path, "--out", path.parent, *options)
    assert process.returncode in (0, 4), process.stderr   # checks are for other meshes
    return tables(path.with_suffix(".lst"))


def with_prints(deck, *prints):
    """Return the text of a deck with tables of its step, without checks and *CONTACT PRINT."""
    text = deck.read_text().replace("*INCLUDE, INPUT=", f"*INCLUDE, INPUT={deck.parent}/")
    text = text[:text.index("*VERIFY")].replace("*CONTACT PRINT\nCDIS, CSTR\n", "").replace(
        "*CONTACT PRINT\n", "")
    return text.replace("*END STEP", "\n".join([*prints, "*END STEP"]))


def test_uncertainties_hold_the_closed_form_of_a_press_fit(tmp_path):
    deck = with_prints(INPUT / "examples" / "press_fit.inp", "*NODE PRINT, NSET=HUB.LEFT", "U",
                       "*NODE PRINT, NSET=RIM.RIGHT", "U", "*CONTACT PRINT")
    found = solved(tmp_path / "fit.inp", deck, "--errors", "full")
    exact = {"NODES OF HUB.LEFT": ("U1", -0.006563833), "NODES OF RIM.RIGHT": ("U1", 0.0354447),
             "CONTACT POINTS OF SEAT": ("p", PRESSURE)}
    for title, (column, value) in exact.items():
        for node, row in found[False, title].items():
            uncertainty = found[True, title][node][column]
            digits = 0.0051 if column == "p" else 0.0   # of 25.85
            assert abs(row[column] - value) < uncertainty + digits
            assert 0.0 < uncertainty < 2e-2 * abs(value)


@pytest.mark.parametrize("faces", ["NODES", "SURFACES"])
def test_uncertainties_hold_what_a_finer_mesh_has(tmp_path, faces):
    """The published cylinder at 180, on a mesh whose errors are a sixteenth or less."""
    prints = ("*NODE PRINT, NSET=TOP, TOTALS=ONLY, FREQUENCY=1000", "U, RF, RFL",
              "*NODE PRINT, NSET=AXIS, FREQUENCY=1000", "U, NT", "*CONTACT PRINT, FREQUENCY=1000")
    text = with_prints(CYLINDER, *prints).replace("20., 900.", "20., 180.").replace("900.\n", "180.\n")
    text = text.replace("PAIRING=NODES", f"PAIRING={faces}")
    assert "20., 180." in text and f"PAIRING={faces}" in text
    own = solved(tmp_path / "own.inp", text, "--errors", "full")
    fine = solved(tmp_path / "fine.inp", text.replace("*MATERIAL", "*REFINE, LEVELS=2\n*MATERIAL", 1)
                  .replace("20., 180.", "10., 180."), "--errors", "no")
    held = {}
    for (of_uncertainties, title), rows in own.items():
        for node, row in rows.items() if not of_uncertainties else ():
            for column, value in row.items():
                uncertainty = own[True, title].get(node, {}).get(column)
                if column in "xy" or uncertainty is None:
                    continue
                error = abs(value - fine[False, title][node][column]) - 1e-3 * abs(value)   # digits
                held.setdefault(column, []).append(error <= uncertainty)
    assert set(held) == {"U1", "U2", "NT", "RF1", "RF2", "RFL", "gap", "p", "tau", "slip", "T1", "T2",
                         "omega", "q"}
    assert np.mean(np.concatenate(list(held.values()))) >= 0.95


def test_what_is_prescribed_is_exact(tmp_path):
    deck = with_prints(CYLINDER, "*NODE PRINT, NSET=TOP, FREQUENCY=1000", "U, NT").replace(
        "20., 900.", "20., 60.")
    for row in solved(tmp_path / "own.inp", deck, "--errors", "full")[True, "NODES OF TOP"].values():
        assert row["U2"] == row["NT"] == 0.0


def test_without_a_finer_run_tables_stand_alone(tmp_path):
    deck = with_prints(INPUT / "examples" / "press_fit.inp", "*NODE PRINT, NSET=HUB.LEFT", "U")
    assert list(solved(tmp_path / "fit.inp", deck)) == [(False, "NODES OF HUB.LEFT")]
