"""One rule makes all numerical uncertainties; it knows what a number is and nothing of where it comes from."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RULE = ROOT / "src" / "accuracy" / "uncertainty_rule.f90"
CASES = r"pairing|mortar|node_pair|friction|corner|triang|quad|element|analysis|transient|step"
MOST_LINES, MOST_CONSTANTS = 60, 8


def code_of(text):
    """Return Fortran without comments."""
    return "\n".join(line.split("!")[0] for line in text.splitlines())


def procedures(text):
    """Return the procedures of a module."""
    return re.findall(r"^   (?:pure |elemental )*(?:function|subroutine) .*?^   end (?:function|subroutine)",
                      text, re.M | re.S)


def constants(text):
    """Return the numbers of the rule, of its file and of the tables of quantities."""
    own = re.findall(r"parameter :: \w+ = ([\d.]+)_dp", code_of(text))
    tables = "".join(code_of(file.read_text()) for file in [*(ROOT / "src" / "records").glob("*.f90"),
                                                            ROOT / "src" / "model" / "quantity_types.f90"])
    return set(own) | set(re.findall(r"\b(?:order|resolution) *= *([\d.]+)_dp", tables)) - {"0.0"}


def faults(text):
    """Return what is wrong with a rule."""
    found = [f"it uses {name}" for name in re.findall(r"^ *use (\w+)", text, re.M)
             if name not in ("kinds", "quantity_types")]
    found += [f"it knows of {word}" for word in re.findall(CASES, code_of(text), re.I)]
    found += ["it is not pure" for each in procedures(text) if not each.lstrip().startswith("pure ")]
    found += ["it is too long" for each in procedures(text) if each.count("\n") > MOST_LINES]
    return found


def test_the_rule_sees_no_pairing_element_friction_or_corner():
    text = RULE.read_text()
    assert len(procedures(text)) == 1
    assert not faults(text)


def test_the_rule_has_few_constants():
    assert 2 < len(constants(RULE.read_text())) <= MOST_CONSTANTS


def test_a_case_in_the_rule_is_found():
    text = RULE.read_text()
    planted = text.replace("      parts = [", "      if (has_friction) return\n      parts = [")
    assert planted != text
    assert faults(planted) == ["it knows of friction"]
    assert faults(text.replace("use kinds", "use contact_points"))


def test_uncertainties_are_made_by_the_rule_alone():
    """No other module of the folder has a number for an error but the rule, nor adds to its parts."""
    text = (ROOT / "src" / "accuracy" / "error_estimator.f90").read_text()
    assert not re.findall(r"%(?:total|change|scatter|iteration) = ", text.replace("self%iteration", ""))
    assert text.count("own = uncertainty_type(value, sum(parts), parts(1)") == 1
