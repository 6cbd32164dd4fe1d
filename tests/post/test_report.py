"""post/report: one page that asks for nothing; its pictures follow the slider in a browser."""

import re
import shutil
import sys
from html.parser import HTMLParser
from pathlib import Path

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

POST = Path(__file__).resolve().parents[2] / "post"
sys.path.insert(0, str(POST.parent / "python"))

from program import CYLINDER, run, write_deck  # noqa: E402
from synthetic import write_result  # noqa: E402

from thercon.post import stresses  # noqa: E402
from thercon.post.cli import main as plot  # noqa: E402
from thercon.post.edge_curves import zeros_of  # noqa: E402
from thercon.post.report.cli import main  # noqa: E402
from thercon.post.fields import TITLES  # noqa: E402
from thercon.post.report.data import histories, in_words, kept_steps  # noqa: E402
from thercon.post.report.listing import read_listing  # noqa: E402
from thercon.post.report.tables import remark, target_cells  # noqa: E402
from thercon.post.result import Result  # noqa: E402


@pytest.fixture(scope="module")
def cylinder(tmp_path_factory):
    """Return the folder of the published cylinder, solved, with one check that fails."""
    folder = tmp_path_factory.mktemp("cylinder")
    failing = ["*VERIFY, KIND=ANALYTIC, SOURCE=\"a & b\"", "normal_force, FACE, LAST, 1., 1.E-3"]
    status, said = run(write_deck(folder / "cylinder.inp", end_cards=failing))
    assert status == 4, said
    assert main([str(folder / "cylinder.vtkhdf"), "--out", str(folder)]) == 0
    return folder


@pytest.fixture
def synthetic(usual, tmp_path):
    """Return a function that writes a synthetic result and its page, and gives the page's path."""

    def call(change=lambda file: None, **choices):
        path = tmp_path / "case.vtkhdf"
        if choices:
            write_result(path, **choices)
        else:
            shutil.copy(usual, path)
        with h5py.File(path, "r+") as file:
            change(file)
        assert main([str(path), "--out", str(tmp_path)]) == 0
        return tmp_path / "case.html"

    return call


class Tags(HTMLParser):
    """What a page says of its form."""

    EMPTY = {"meta", "link", "input", "br"}

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.found, self.attributes = [], [], set(), []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.found.add(tag)
        self.attributes += attrs
        self.ids += [value for key, value in attrs if key == "id"]
        if tag not in self.EMPTY:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_the_page_is_one_well_formed_file_that_asks_for_nothing(cylinder):
    page = cylinder / "cylinder.html"
    text = page.read_text()
    assert len(text) < 5e6
    tags = Tags(text)
    assert not tags.open and len(tags.ids) == len(set(tags.ids))
    assert {"title", "main", "nav", "h1", "caption"} <= tags.found
    assert ("lang", "en") in tags.attributes
    asked = [value for key, value in tags.attributes if key in ("src", "href", "data", "srcset")]
    assert all(value.startswith(("#", "data:")) for value in asked)
    assert not re.search(r"url\((?!#)|@import|fetch\(|XMLHttpRequest", text)


def test_the_tables_hold_summary_checks_and_deck(cylinder):
    text = (cylinder / "cylinder.html").read_text()
    with h5py.File(cylinder / "cylinder.vtkhdf") as file:
        value, uncertainty, *_ = file["uncertainty/FACE/normal_force"][-1]
    row = re.search(r'<th scope="row"[^>]*>normal force</th>(.*?)</tr>', text).group(1)
    cells = re.findall(r"<td[^>]*>(.*?)</td>", row)
    assert cells[0] == f"{value:.6g}"
    assert cells[1].startswith(f"± {uncertainty:.2g} (") and cells[2] == "MPa cm²"
    assert text.count('class="pass"') == 37 and text.count('class="fail"') == 1
    assert text.index('class="fail"') < text.index('class="pass"')
    assert "ANALYTIC: a &amp; b" in text and "37 passed, 1 failed" in text
    assert "<dt>outcome</dt><dd>check failed, 45 increments</dd>" in text
    assert "No warnings." in text and "*GAP LAW" in text


def test_the_slider_moves_every_picture_and_the_console_stays_empty(cylinder, browser):
    browser.open(cylinder / "cylinder.html")
    with h5py.File(cylinder / "cylinder.vtkhdf") as file:
        force, load = file["contact/FACE/normal_force"][()], file["history/load"][()]
        mises = file["VTKHDF/PointData/von_mises"][()].reshape(len(load), -1)
        temperature = file["VTKHDF/PointData/temperature"][()].reshape(len(load), -1)
    look = """const of = id => document.getElementById(id);
        const c = document.querySelector('#panel canvas');
        const pixels = c.toDataURL();
        return {now: of('now').textContent, totals: of('totals').textContent,
            range: of('range').textContent, pixels, drawn: pixels.length > 5000,
            bar: of('bars').textContent, note: of('field-note').textContent,
            tractions: of('tractions').innerHTML, flux: of('flux').innerHTML,
            zones: of('zones').querySelector('.upright').getAttribute('d'),
            history: of('history-0').textContent}"""
    seen = [browser.run(look)]
    for keys in (("left",), ("home", "right", "right")):
        browser.press("#load", *keys)
        seen.append(browser.run(look))
    for place, found in zip((-1, -2, 2), seen):
        assert f"temperature of TOP = {load[place]:g} °C" in found["now"]
        assert f"normal force {force[place]:.5g} MPa cm²" in re.sub(" ± [^ ]+", "", found["totals"])
        assert f"largest {mises[place].max():.5g} at node" in found["range"] and found["drawn"]
        assert f"{force[place]:.5g}" in found["history"]
    for key in ("now", "totals", "range", "pixels", "tractions", "flux", "zones", "history"):
        assert len({str(found[key]) for found in seen}) == 3, key

    choose = """const box = document.getElementById(arguments[0]); box.value = arguments[1];
        if (arguments[0] === 'fixed') box.checked = true;
        box.dispatchEvent(new Event('input', {bubbles: true}))"""
    browser.run(choose, "quantity", "0")
    hot = browser.run(look)
    assert f"largest {temperature[2].max():.5g} at node" in hot["range"]
    assert hot["pixels"] != seen[-1]["pixels"]
    browser.run(choose, "fixed", "on")
    assert "800" in browser.run(look)["bar"] and "800" not in hot["bar"]
    browser.run(choose, "scale", "0")  # now only the values can change the picture
    still = browser.run(look)["pixels"]
    browser.press("#load", "end")
    assert browser.run(look)["pixels"] != still
    browser.run(choose, "scale", "50")
    assert "50 times too large" in browser.run(look)["note"]
    assert "seem to overlap" in browser.run(look)["note"]
    browser.run(choose, "region", "near")
    assert browser.run(look)["pixels"] != still
    assert browser.messages() == []


def test_low_loads_fill_the_axes_unless_all_loads_have_the_same_scale(cylinder, browser):
    """The height of each curve over that of its axes, at the first load and at the last."""
    browser.open(cylinder / "cylinder.html")
    look = """return ['tractions', 'flux', 'gap'].map(id => {
        const svg = document.getElementById(id).querySelector('svg');
        const tall = each => each.getBBox().height;
        const curves = [...svg.querySelectorAll('g > path[fill=none]:not(.upright)')];
        return Math.max(...curves.map(tall)) / tall(svg.querySelector('clipPath rect'))})"""
    seen = {}
    for same in (False, True):
        if same:
            browser.press("#same", " ")
        for key in ("home", "end"):
            browser.press("#load", key)
            seen[same, key] = browser.run(look)
    assert min(seen[False, "home"] + seen[False, "end"]) > 0.85
    assert seen[True, "home"][0] < 0.2 and seen[True, "home"][1] < 0.2
    assert seen[True, "end"][:2] == seen[False, "end"][:2]
    assert browser.messages() == []


def test_rounding_is_not_stretched_over_the_axes(synthetic, browser):
    def cold(file):
        file["contact/CYLINDER/heat_flux"][0] *= 1e-12

    browser.open(synthetic(cold))
    look = """return Math.max(...[...document.querySelectorAll('#flux .tick')].map(
        each => Number(each.textContent)))"""
    last = browser.run(look)
    browser.press("#load", "home")
    assert browser.run(look) == last


def test_a_contact_in_pieces_has_a_page(synthetic, browser):
    def part(file):
        for contact in file["contact"].values():
            points = len(contact["s"])
            contact["piece"] = np.where(np.arange(points) < points // 2, 1, 2)

    browser.open(synthetic(part))
    assert browser.run("return document.querySelectorAll('#profiles svg, #zones svg').length") > 0


def test_every_picture_is_named_and_every_control_is_reached_and_labelled(cylinder, browser):
    browser.open(cylinder / "cylinder.html")
    bare = browser.run("""return [...document.querySelectorAll('svg')].filter(
        each => !each.getAttribute('aria-label')).length + [...document.querySelectorAll(
        'input, select')].filter(each => !each.labels.length || each.tabIndex < 0).length""")
    assert bare == 0
    reached = set()
    for _ in range(20):
        browser.type("tab")
        reached.add(browser.run("return document.activeElement.id || document.activeElement.href"))
    assert {"load", "interface", "same", "quantity", "region", "scale", "fixed", "apart"} <= reached
    browser.printed(cylinder / "cylinder.pdf")
    assert (cylinder / "cylinder.pdf").read_bytes()[:4] == b"%PDF"
    assert not browser.run("return document.querySelector('details').open"), "the deck is not printed"
    assert browser.messages() == []


@pytest.mark.parametrize("choices", [
    {"heat": False, "friction": None, "units": ""},
    {"contacts": ("LEFT", "RIGHT<&>")},
    {"contacts": (), "loads": (300.0,)},
    {"loads": (1.0, 5.0, 3.0), "fields_every": 2},
])
def test_pages_of_other_decks_are_drawn(synthetic, browser, choices):
    browser.open(synthetic(**choices))
    browser.press("#load", "home")
    found = browser.run("return [document.getElementById('range').textContent,"
                        "document.querySelectorAll('#zones circle, #zones path').length]")
    assert "largest" in found[0] and (found[1] > 0) == (choices.get("contacts") != ())
    assert browser.messages() == []


def test_bodies_whose_ranges_differ_tenfold_have_scales_of_their_own(synthetic, browser):
    def cool(file):
        data = file["VTKHDF/PointData/temperature"]
        points = len(file["VTKHDF/Points"])
        upper = np.tile(np.arange(points) < points // 2, 15)
        data[...] = np.where(upper, data[...], 20.0 + 0.01 * data[...])

    browser.open(synthetic(cool))
    browser.run("document.getElementById('quantity').value = '0';"
                "document.getElementById('quantity').dispatchEvent(new Event('input'))")
    assert browser.run("return document.querySelectorAll('#bars svg').length") == 1
    browser.press("#apart", " ")
    assert browser.run("return document.querySelectorAll('#bars svg').length") == 2
    note = browser.run("return document.getElementById('field-note').textContent")
    assert "have their own colours" in note


def test_a_uniform_field_and_a_reference_node_do_not_mislead(synthetic, browser):
    """One colour with its value; a node of no element has no smallest or largest value."""
    def change(file):
        stress, temperature = (file[f"VTKHDF/PointData/{key}"] for key in ("stress", "temperature"))
        stress[:, 1] = -100.0 + 0.04 * np.tile(np.linspace(-1.0, 1.0, len(stress) // 15), 15)
        points, connectivity = file["VTKHDF/Points"], file["VTKHDF/Connectivity"]
        lone = int(np.setdiff1d(connectivity[:8], connectivity[8:])[0])
        connectivity[:8] = connectivity[8:16]
        temperature[lone :: len(points)] = -5e4

    browser.open(synthetic(change))
    look = """const box = document.getElementById('quantity');
        box.value = [...box.options].find(each => each.text.includes(arguments[0])).value;
        box.dispatchEvent(new Event('input'))"""
    seen = "return ['bars', 'range'].map(id => document.getElementById(id).textContent)"
    browser.run(look, "yy")
    assert re.findall(r"−?\d+", browser.run(seen)[0]) == ["−100"]
    browser.run(look, "Temperature")
    assert "50000" not in browser.run(seen)[1]


def test_a_run_of_heat_begins_with_temperatures(synthetic, browser):
    def open_all(file):
        contact = file["contact/CYLINDER"]
        contact["pressure"][...] = contact["status"][...] = 0
        contact["slave_temperature"] = hot = 500.0 + contact["gap"][()]
        contact["master_temperature"] = hot - 100.0

    page = synthetic(open_all)
    browser.open(page)
    shown = """return [document.getElementById('quantity').selectedOptions[0].text,
        document.querySelectorAll('#tractions svg').length, document.getElementById('faces').textContent]"""
    quantity, tractions, faces = browser.run(shown)
    assert quantity.startswith("Temperature") and tractions == 0
    assert "Temperature of the faces" in faces and "master" in faces
    browser.open(synthetic())
    quantity, tractions, faces = browser.run(shown)
    assert quantity.startswith("von Mises") and tractions == 1 and not faces
    assert browser.messages() == []


def test_colours_of_most_of_the_area_have_arrows_where_values_lie_beyond(synthetic, browser):
    """A spike at a node, however large; a range that is chosen; drawings of rigid bodies."""
    def spike(file):
        mises, points = file["VTKHDF/PointData/von_mises"], len(file["VTKHDF/Points"])
        mises[int(np.argmax(file["VTKHDF/Points"][:, 1])) :: points] = 12345.0
        group = file.create_group("rigid_surfaces/DIE")
        group["points"] = np.array([[-1.0, -15.0], [-1.0, 5.0]])
        group.attrs["reference_node"], group.attrs["rotation_node"] = 1, 2

    browser.open(synthetic(spike))
    seen = """return [[...document.querySelectorAll('#bars text')].map(t => Number(t.textContent)).filter(
        Number.isFinite), document.querySelectorAll('.beyond').length, document.getElementById('range').textContent,
        document.querySelectorAll('path.rigid').length]"""
    ticks, arrows, words, rigid = browser.run(seen)
    assert max(ticks) < 100.0 and arrows == 1 and rigid == 1
    assert "largest 12345 at" in words and "values lie beyond the colours" in words
    for key, value in (("low", "10"), ("high", "20000")):
        browser.press(f"#{key}", value)
    ticks, arrows, words, _ = browser.run(seen)
    assert ticks[-1] == 20000.0 and arrows == 1, "now values lie below"
    assert browser.messages() == []


def test_titles_of_panels_become_words_without_formulas():
    for title, _ in TITLES.values():
        assert not set("\\$_{}") & set(in_words(title))
    assert in_words(TITLES["plastic_strain"][0]) == "Equivalent plastic strain \N{GREEK SMALL LETTER EPSILON}p"


def edges_of(browser):
    """Return how many curves of edges of contact and of stick the zones have."""
    return browser.run("""return [...document.querySelectorAll('#zones g > path[fill=none]')].map(
        path => path.getAttribute('d').split('M').length - 1)""")


def test_an_edge_goes_on_at_its_zone_where_two_edges_become_four(synthetic, browser):
    """Two run from the first increment to the last, and two about the gap for four increments."""

    def change(file):
        contact = file["contact/CYLINDER"]
        contact["status"][...] = 0
        contact["edges_contact"][...] = edges = np.array([[2.0, 12.0, np.nan, np.nan]] * 15)
        edges[8:12] = [2.0, 4.0, 6.0, 12.0]
        contact["edges_contact"][...] = edges
        contact["edges_stick"][...] = np.nan

    browser.open(synthetic(change))
    assert edges_of(browser) == [4]
    (path,) = browser.run("""return [...document.querySelectorAll('#zones g > path[fill=none]')].map(
        path => path.getAttribute('d'))""")
    heights = [{point.split()[1] for point in re.split("[ML]", curve) if point}
               for curve in path.split("M") if curve]
    assert [len(height) for height in heights] == [1, 1, 1, 1], "no curve leaves its place"


def test_the_open_part_that_carries_heat_is_shown(synthetic, browser):
    """By tractions, flux and gap; the zones say how much of the heat crosses what they leave out."""

    def change(file):
        file["contact/CYLINDER/heat_flux"][...] = 2.0

    browser.open(synthetic(change))
    ticks = """return [...document.querySelectorAll('#' + arguments[0] + ' text.tick')].map(
        each => each.textContent)"""
    for chart in ("tractions", "flux", "gap"):
        assert "20" in browser.run(ticks, chart)
    words = browser.run("return document.getElementById('zones').textContent")
    assert re.search(r"the part not shown is open,\s+and up to \d+ % of the heat crosses it", words)


def test_a_symmetric_contact_has_two_edges_and_no_chart_is_of_rounding(synthetic, browser):
    def change(file):
        contact = file["contact/CYLINDER"]
        contact["edges_contact"][:, 1] = contact["edge_contact"][()]
        contact["edges_contact"][:, 0] = 0.2 * contact["edge_contact"][()]
        contact["normal_force"] = np.linspace(1.0, 15.0, 15)
        contact["shear_force"] = np.linspace(1e-13, 2e-13, 15)
        file["history/force_imbalance"] = np.full(len(file["history/time"]), 1e-16)

    page = synthetic(change)
    browser.open(page)
    zones = browser.run("return document.getElementById('zones').textContent")
    assert "edge of contact" in zones and "further" not in zones
    assert edges_of(browser) == [2, 1], "two edges of contact and one of stick"
    charts = browser.run("return document.getElementById('histories').textContent")
    assert "Normal force" in charts and "hear force" not in charts and "imbalance" not in charts


def test_charts_can_be_read_where_a_browser_forces_darkness(cylinder, browser, tmp_path):
    """It darkens the page and leaves charts alone, which have what is behind them."""
    browser.look(1280, "light", forces=True)
    browser.open(cylinder / "cylinder.html")
    browser.run("document.getElementById('zones').scrollIntoView()")
    box = browser.run("""const box = document.querySelector('#zones svg').getBoundingClientRect();
        return [box.left, box.top, box.right, box.bottom].map(Math.round)""")
    browser.picture(tmp_path / "page.png")
    browser.look(1280, "light")
    with Image.open(tmp_path / "page.png") as picture:
        chart = np.asarray(picture.convert("L").crop(box))
    assert chart[2, 2] > 240 and np.mean(chart > 240) > 0.5 and np.mean(chart < 100) > 0.01


@pytest.mark.parametrize("mode", ["light", "dark"])
def test_the_page_can_be_read_in_both_schemes_and_on_a_telephone(cylinder, browser, mode):
    """Text and axes stand apart from what is behind them, and nothing runs out of 400 pixels."""
    browser.look(400, mode)
    browser.open(cylinder / "cylinder.html")
    colour = """const light = c => c.match(/[0-9.]+/g).slice(0, 3).reduce((s, v) => s + Number(v), 0);
        const of = (each, key) => light(getComputedStyle(each)[key]);
        const behind = of(document.body, 'backgroundColor');
        return [behind, ...['h1', 'td', '.facts dt', 'a'].map(
            each => Math.abs(of(document.querySelector(each), 'color') - behind)),
            ...['#zones text', '#zones rect[fill=none]'].map((each, k) => Math.abs(
            of(document.querySelector(each), k ? 'stroke' : 'fill') - behind))]"""
    behind, *apart = browser.run(colour)
    assert (behind > 384) == (mode == "light") and min(apart) > 250
    browser.run("document.getElementById('quantity').add(new Option('x'.repeat(80)))")
    assert browser.run("return document.documentElement.scrollWidth") <= 400
    right = """return Math.max(...[...document.querySelectorAll('td, tbody th, caption')].map(
        each => each.getBoundingClientRect().right))"""
    assert browser.run(right) <= 400, "no table is cut"
    head = "return getComputedStyle(document.querySelectorAll('td')[1], '::before').content"
    assert browser.run(head) == '"uncertainty (95 %)"'
    scheme = browser.run("return getComputedStyle(document.documentElement).colorScheme")
    assert set(scheme.split()) == ({"only", "light"} if mode == "light" else {"dark"})
    size = browser.run("return document.querySelector('#zones text').getBoundingClientRect().height")
    assert size > 10
    browser.look(1280, "light")


def test_no_label_of_a_chart_touches_another_on_a_telephone(synthetic, browser):
    """Of what has descenders beside the longest ticks, and of faces that wear."""
    def wear(file):
        contact = file["contact/CYLINDER"]
        contact["gap"][...] = 1e-4 * contact["gap"][()] / contact["gap"][()].max()
        contact["wear_slave"] = -1.2e-5 * np.ones(contact["gap"].shape)
        contact["x"][...] *= 1.4e-4

    browser.look(400, "light")
    browser.open(synthetic(wear))
    touching = """return [...document.querySelectorAll('figure svg')].flatMap(svg => {
        const found = [...svg.querySelectorAll('text')].map(t => [t.textContent, t.getBoundingClientRect()]);
        return found.flatMap(([a, one], k) => found.slice(k + 1).filter(([, other]) =>
            one.left < other.right + 5 && other.left < one.right + 5 && one.top < other.bottom &&
            other.top < one.bottom).map(([b]) => [a, b])); })"""
    labels = "return ['gap', 'wear'].map(id => document.querySelector(`#${id} text:last-of-type`).textContent)"
    assert browser.run(labels) == ["gap", "slave"]
    assert browser.run(touching) == []
    size = "return document.querySelector('#gap text').getBoundingClientRect().height"
    assert browser.run(size) > 13
    browser.look(1280, "light")


def test_a_fine_mesh_has_a_page_below_five_megabytes(synthetic):
    page = synthetic(columns=145, rows=145, loads=(450.0, 900.0))
    assert page.stat().st_size < 5e6
    assert "The mesh has 42050 elements" in page.read_text()


def test_friction_edges_and_histories_are_drawn_as_in_the_pictures(synthetic, browser):
    """Friction of both signs has a bound on either side; of one sign it is drawn positive."""

    def turn(file):
        contact = file["contact/CYLINDER"]
        shear = contact["shear"][()]
        shear[:14] = -np.abs(shear[:14])
        shear[14] = np.abs(shear[14]) * np.where(np.arange(shear.shape[1]) < 3, 1.0, -1.0)
        contact["shear"][...] = shear
        for column, part in ((1, 0.5), (2, 0.7)):
            contact["edges_stick"][5:, column] = part * contact["edges_stick"][5:, 0]
        contact["edges_stick"][...] = np.sort(contact["edges_stick"][()])

    browser.open(synthetic(turn))
    look = "return document.getElementById(arguments[0]).textContent"
    words = browser.run(look, "tractions")
    assert "\N{PLUS-MINUS SIGN}\N{GREEK SMALL LETTER MU}p" in words
    assert "friction \N{GREEK SMALL LETTER TAU}" in words
    assert edges_of(browser) == [1, 3]
    axes = browser.run("return document.querySelector('#history-0 svg').textContent")
    assert axes.endswith("MPa")
    browser.press("#load", "home")
    words = browser.run(look, "tractions")
    assert "friction \N{MINUS SIGN}\N{GREEK SMALL LETTER TAU}" in words
    assert "\N{PLUS-MINUS SIGN}" not in words
    assert browser.messages() == []


def test_tractions_end_at_the_edges_as_in_the_pictures(synthetic, browser):
    """Of a closed point between open ones, an edge, or both, may be at the point itself."""

    def close_one(file):
        contact = file["contact/CYLINDER"]
        s, pressure, status = contact["s"][()], contact["pressure"][()], contact["status"][()]
        pressure[:], status[:] = 0.0, 0
        pressure[:, 7], status[:, 7] = 50.0, 1
        contact["pressure"][...], contact["status"][...] = pressure, status
        contact["edges_contact"][...] = [s[7], 0.5 * (s[7] + s[8]), np.nan, np.nan]
        contact["edges_contact"][0] = [s[7], s[7], np.nan, np.nan]
        del contact["shear"]

    page = synthetic(close_one)
    browser.open(page)
    curve = "return document.querySelector('#tractions g path[stroke-width]').getAttribute('d')"
    for key, row in (("end", 14), ("home", 0)):
        browser.press("#load", key)
        path = re.findall(r"([\d.]+) ([\d.]+)", browser.run(curve))
        drawn = np.array(path, dtype=float)
        with Result(page.with_suffix(".vtkhdf")) as result:
            contact = result.contact("CYLINDER")
            edges, before = zeros_of(contact, row, contact.pieces[0])
            places = np.insert(contact["x"], before, contact.edge_on_axis(edges, contact["x"]))
            heights = np.insert(contact["pressure"][row], before, 0.0)
        inside = np.ptp(drawn[:, 0]) / np.ptp(places)
        np.testing.assert_allclose(drawn[:, 0] - drawn[0, 0], (places - places[0]) * inside, atol=0.11)
        np.testing.assert_array_equal(drawn[:, 1] < drawn[0, 1] - 1, heights > 0.0)


def test_a_listing_of_another_deck_is_not_taken(cylinder, tmp_path):
    for name in ("cylinder.vtkhdf", "cylinder.lst"):
        shutil.copy(cylinder / name, tmp_path)
    with h5py.File(tmp_path / "cylinder.vtkhdf", "r+") as file:
        file["deck"][1] = b"Another heading"
    assert main([str(tmp_path / "cylinder.vtkhdf"), "--out", str(tmp_path)]) == 0
    text = (tmp_path / "cylinder.html").read_text()
    assert "beside the result is missing, incomplete or of another deck" in text
    assert "37 passed, 1 failed" in text
    assert "No warnings" not in text


def test_warnings_and_reasons_of_failure_are_taken_from_the_listing(tmp_path):
    listing = tmp_path / "case.lst"
    listing.write_text("""SUMMARY
-------
   solved, 3 increments

VERIFICATION
  card  kind       quantity                 where                  time       expected
   531  ANALYTIC   pressure                 MAX                    LAST  0.0000000E+00\
              -         -  1.00E-15 REL FAIL
        source: theory
        failed: no such time

REQUESTED ACCURACY
------------------
   - requested accuracy not reached after 2 rounds: the last two came
     no nearer
   - FACE normal force met

     round   CPU seconds
         1          0.11

WARNINGS
--------
   - the first, which goes on
     below
   - the second

DECK
----
       1  *HEADING
""")
    cards = ["*HEADING"]
    found = read_listing(listing, cards)
    assert found.outcome == "solved, 3 increments"
    assert found.accuracy == [
        "requested accuracy not reached after 2 rounds: the last two came no nearer",
        "FACE normal force met"]
    (check,) = found.checks
    assert (check.verdict, check.source, check.failed) == ("FAIL", "theory", "no such time")
    assert found.warnings == ["the first, which goes on below", "the second"]
    assert read_listing(tmp_path / "none.lst", cards) is None

    whole = listing.read_text()
    begun = "solved, 3 increments; round 2 is being solved"
    listing.write_text(whole.replace("solved, 3 increments", f"{begun}, or see ENDED EARLY at the end"))
    assert read_listing(listing, cards).outcome == begun
    with listing.open("a") as file:
        file.write("\nENDED EARLY\n-----------\n   memory ran out\n   The results are those of round 1."
                   "\n\n   ITERATION HISTORY\n")
    found = read_listing(listing, cards)
    assert found.outcome == "solved, 3 increments"
    assert found.ended_early == "memory ran out. The results are those of round 1."
    assert found.warnings[1:] == ["the second"]
    listing.write_text(listing.read_text().replace("memory ran out", "it does not hold; after\n   2 cut-backs")
                       .replace("round 1.\n", "round 1.\n   attempt 1 of size 2, to time 2, not kept: it\n"
                                "   does not hold\n   attempt 2 of size 1, to time 1, not kept: no\n", 1))
    assert read_listing(listing, cards).ended_early == (
        "it does not hold; after 2 cut-backs. The results are those of round 1. Attempt 1 of size 2, to time "
        "2, not kept: it does not hold. Attempt 2 of size 1, to time 1, not kept: no")


def test_a_gap_that_is_zero_in_all_that_is_shown_has_no_chart(synthetic, browser):
    """It has where it differs from zero there at another load."""
    def close(file):
        contact = file["contact/CYLINDER"]
        contact["heat_flux"][...] = np.where(contact["status"][()] > 0, contact["heat_flux"][()], 0.0)
        contact["gap"][...] = np.where(contact["x"][()] < 12.0, 0.0, contact["gap"][()])

    def close_last(file):
        file["contact/CYLINDER/gap"][-1] = 0.0

    for change, most in ((close, 0), (close_last, 1)):
        browser.open(synthetic(change))
        assert browser.run("return document.querySelectorAll('#gap svg').length") == most


def test_the_rounds_of_a_requested_accuracy_are_told(synthetic):
    def ask(file):
        group = file.create_group("accuracy")
        group["cpu_seconds"], group["unknowns"] = [0.125, 0.3], [100, 900]
        group["elements"], group["increments"] = [10, 40], [15, 30]
        group.attrs["reached"], group.attrs["later_round_begun"] = 0, 1
        file["run"].attrs["seconds_iterate"] = 12.5
        judged = group.create_group("uncertainty/CYLINDER")
        judged["normal_force"] = [[1, 5.0, np.nan, 0.1], [1, 5.1, 0.25, 0.1]]
        judged["peak_pressure"] = [[1, 5000.0, 1320.0, 0.1], [1, 5.1, 0.1, 0.1]]
        judged["heat_rate"] = np.zeros((2, 4))
        file["uncertainty/time"] = [900.0]

    text = synthetic(ask).read_text()
    assert "<dd>not reached after 2 rounds; round 3 was begun</dd>" in text
    rounds = re.search("<caption>Rounds of the requested accuracy.*?</table>", text)[0]
    assert re.findall(r"<td[^>]*>(.*?)</td>", rounds) == \
        ["100", "10", "15", "0.12", "900", "40", "30", "0.30"]
    judged = re.search("<caption>Uncertainties .95 %. of each round.*?</table>", text)[0]
    rows = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in judged.split("</tr>")[1:-1]]
    assert [row[0] for row in rows] == ["heat rate", "normal force", "peak pressure"]
    assert rows[0][1:3] == ["–", "–"] and rows[0][-1].startswith("nothing to judge")
    assert rows[1][1:4] == ["no estimate", "0.25", "0.1"] and ">not met<" in rows[1][-1]
    assert rows[2][1:4] == ["1300", "0.1", "0.1"] and ">met<" in rows[2][-1]
    assert "<dd>12.50 s in round 2; all rounds took 0.42 CPU seconds</dd>" in text
    assert "Rounds of the" not in synthetic().read_text()


@pytest.mark.vectors
def test_increments_without_an_uncertainty_say_so(synthetic, browser, tmp_path, monkeypatch):
    """On the page and in pictures: a requested accuracy looks at the ends of steps."""
    save = Figure.savefig
    monkeypatch.setattr(Figure, "savefig", lambda figure, path, **options:
                        save(figure, path, **options) if path.suffix == ".svg" else None)

    def ask(file):
        group = file.create_group("accuracy")
        for key in ("cpu_seconds", "unknowns", "elements", "increments"):
            group[key] = [1]
        group.create_group("uncertainty")
        file["uncertainty/time"] = [900.0]

    browser.open(synthetic(ask))
    note = "return document.getElementById('unjudged').textContent"
    assert browser.run(note) == ""
    browser.press("#load", "left")
    assert browser.run(note).startswith("Increment 14 is inside a step")
    for picture, marked in (("zones", 1), ("courses", 2)):
        assert plot([picture, str(tmp_path / "case.vtkhdf"), "--out", str(tmp_path)]) == 0
        drawn = (tmp_path / f"case.{picture}.svg").read_text()
        assert "dotted lines are ends of steps; the accuracy is judged at these alone" in drawn
        assert drawn.count("stroke: #8c8c8c") == marked
    assert plot(["profiles", str(tmp_path / "case.vtkhdf"), "--increment", "14", "15", "--out",
                 str(tmp_path)]) == 0
    drawn = (tmp_path / "case.profiles-840-900.svg").read_text()
    assert re.search(r"<!-- 840[^>]*: -->(?s:.)*<!-- inside a step: the mesh is not refined", drawn)
    with Result(tmp_path / "case.vtkhdf") as opened:
        assert opened.load_words(13).endswith("(inside a step: the mesh is not refined for this time)")
        assert "step" not in opened.load_words(14)


def test_a_coupling_below_the_accuracy_of_its_gain_has_no_chart(synthetic, browser):
    for size, charts in ((1e-7, 0), (0.1, 2)):
        def couple(file, size=size):
            for key in ("coupling_gain", "coupling_gain_max"):
                file[f"history/{key}"] = np.full(15, size)

        browser.open(synthetic(couple))
        words = browser.run("return document.getElementById('histories').textContent")
        assert words.count("oupling gain") == charts
        assert ("Largest real coupling gain" in words) == (charts > 0)


def test_checks_of_an_earlier_round_are_told_without_a_table(tmp_path):
    """With a requested accuracy the listing is that of the last round, the checks of the first."""
    deck = tmp_path / "roller.inp"
    for name in ("roller.inp", "roller.gmsh"):
        shutil.copy(CYLINDER.parents[1] / "examples" / name, tmp_path)
    status, said = run(deck, "--accuracy", "edge=1%")
    assert status == 0, said
    assert main([str(deck.with_suffix(".vtkhdf")), "--out", str(tmp_path)]) == 0
    checks = (tmp_path / "roller.html").read_text().split('id="checks-title"')[1].split("<section")[0]
    assert "They were judged in round 1, on the deck as written." in checks
    assert "<table" not in checks


def test_a_target_that_is_missed_by_little_shows_it():
    cells = target_cells(np.array([[1, 5.0, 0.2, 0.1], [1, 5.1, 0.1003, 0.1]]), "W", "")
    assert cells[:4] == ["0.2", "0.1003", "0.1", "W"] and ">not met<" in cells[4]
    cells = target_cells(np.array([[1, 5.0, 0.2, 0.1], [1, 5.1, 0.0999, 0.1]]), "W", "")
    assert cells[:4] == ["0.2", "0.1", "0.1", "W"] and ">met<" in cells[4]


@pytest.mark.parametrize(("said", "shown"), [
    ("no estimate, target 5 %, step 1 with 6.5 MPa: peak grows with the mesh",
     ", step 1 with 6.5 MPa: peak grows with the mesh"),
    ("uncertainty 7 % of 5 MPa cm^2, target 5 %, step 2; the peak is at an end of the face",
     ", step 2; the peak is at an end of the face"),
    ("no estimate, target 5 %: not unique", ": not unique")])
def test_step_and_reason_stand_beside_a_target_that_is_missed(said, shown):
    lines = ["requested accuracy not reached after 4 rounds", "A heat rate                    met: uncertainty 2 %",
             "AA peak pressure               not met: uncertainty 9 %, target 5 % (another)",
             f"A peak pressure                not met: {said}"]
    assert remark(lines, "A peak pressure") == shown
    assert remark(lines, "A heat rate") == remark([], "A peak pressure") == ""


def page_of_example(folder, name, *options, status=0):
    """Solve an example in a folder; return the text of its page."""
    for end in ("inp", "mesh"):
        shutil.copy(CYLINDER.parents[1] / "examples" / f"{name}.{end}", folder)
    found, said = run(folder / f"{name}.inp", *options)
    assert found == status, said
    assert main([str(folder / f"{name}.vtkhdf"), "--out", str(folder)]) == 0
    return (folder / f"{name}.html").read_text()


@pytest.mark.parametrize(("full", "reason"), [(False, "*VERIFY; ERRORS=FULL"),
                                              (True, "only for *VERIFY")])
def test_a_worn_volume_says_what_estimates_it(synthetic, full, reason):
    def wear(file):
        file["contact/CYLINDER/worn_volume_slave"] = 1e-3 * file["history/load"][()]
        if full:
            file.require_group("uncertainty/increment")
            file["uncertainty/time"] = file["history/time"][()]

    row = re.search(r'<th scope="row"[^>]*>worn volume of the slave</th>(.*?)</tr>', synthetic(wear).read_text())[1]
    assert re.findall(r"<td[^>]*>(.*?)</td>", row)[1] == f"no estimate: {reason}"


def test_the_totals_have_the_heat_of_friction_and_no_volume_where_nothing_is_worn(synthetic, browser):
    """In the table as beside the slider, in the order of the summary."""
    def rub(file):
        load = file["history/load"][()]
        contact = file["contact/CYLINDER"]
        contact["worn_volume_slave"], contact["worn_volume_master"] = 1e-3 * load, 0.0 * load
        contact["normal_force"], contact["heat_rate"] = 10.0 + load, 20.0 + load
        file["history/heat_friction"] = 0.5 * load

    page = synthetic(rub)
    rows = dict(re.findall(r'<th scope="row"[^>]*>([^<]*)</th><td[^>]*>([^<]*)</td>', page.read_text()))
    names = ["normal force", "heat rate", "peak pressure", "edge of contact, s", "edge of stick, s",
             "worn volume of the slave", "heat of friction"]
    assert [name for name in rows if name in names or "worn" in name] == names
    assert rows["heat of friction"] == "450"
    browser.open(page)
    words = browser.run("return document.getElementById('totals').textContent")
    assert "heat of friction 450 W" in words and "master" not in words
    charts = browser.run("return document.getElementById('histories').textContent")
    assert "Heat of friction" in charts and "Heat friction" not in charts


def test_charts_of_what_is_rounding_beside_its_kind_are_left_out(synthetic, browser):
    """Imbalances are relative to the largest rate, whatever its unit makes of it."""
    for size, are_shown in ((0.5e-9, False), (2e-9, True)):
        def change(file, size=size):
            for key, value in (("heat_in", 1e-3), ("heat_imbalance_pointwise", size), ("ALLSE", 2.0),
                               ("ALLFD", 2.0 * size)):
                file[f"history/{key}"] = np.full(15, value)
            file["contact/CYLINDER/heat_flux"][...] = 0.0

        browser.open(synthetic(change))
        charts = browser.run("return document.getElementById('histories').textContent")
        assert "Elastic energy (ALLSE)" in charts and "Heat in" in charts
        for words in ("Imbalance of heat at the end of the increment", "Energy dissipated by friction (ALLFD)"):
            assert (words in charts) == are_shown


def test_an_edge_at_the_end_of_the_face_has_no_uncertainty(tmp_path):
    text = page_of_example(tmp_path, "press_fit")
    row = re.search(r'<th scope="row"[^>]*>edge of contact, s</th>(.*?)</tr>', text)[1]
    assert re.findall(r"<td[^>]*>(.*?)</td>", row) == ["10", "none: end of the face", "mm", "–", "–", "–"]
    assert re.search(r'<th scope="row"[^>]*>peak pressure</th>.*?<td[^>]*>± ', text)


@pytest.fixture(scope="module", params=["LAST", "FULL"])
def uncertain(request, tmp_path_factory):
    """Return a result of four increments, for whose last one or for all of which there are
    uncertainties, as the second value says."""
    deck = write_deck(tmp_path_factory.mktemp("uncertain") / "cylinder.inp",
                      [f"*OPTIONS, ERRORS={request.param}"])
    cards, _ = deck.read_text().replace("\n20., 900.", "\n225., 900.").split("\n*VERIFY", 1)
    deck.write_text(cards + "\n")
    status, said = run(deck)
    assert status == 0, said
    return deck.with_suffix(".vtkhdf"), request.param == "FULL"


def test_every_increment_shows_its_own_uncertainties(uncertain, browser):
    path, is_full = uncertain
    with h5py.File(path) as file:
        rows = file["uncertainty/FACE/normal_force"][()]
        times = file["uncertainty/time"][()].tolist()
        heat = file["uncertainty/increment/heat_in"][()] if is_full else None
        every = file["history/time"][()].tolist()
    assert times == (every if is_full else every[-1:])
    assert main([str(path), "--out", str(path.parent)]) == 0
    browser.open(path.with_suffix(".html"))
    assert browser.run("return document.body.textContent.includes('Body 2 (BASE of LOWER, first node 1001) at')")
    for key, time in (("end", every[-1]), ("left", every[-2]), ("home", every[0])):
        browser.press("#load", key)
        totals, *charts = browser.run("""const of = id => document.getElementById(id);
            const charts = [...document.querySelectorAll('#histories figure')];
            return [of('totals').textContent, ...charts.map(box => [box.textContent,
                (box.querySelector('.uncertainty') || {getAttribute: () => ''}).getAttribute('d')])]""")
        found = re.search(r"normal force ([\d.]+)(?: ± ([\d.]+))? MPa", totals)
        drawn = next(each for each in charts if "Normal force:" in each[0])
        assert drawn[1].count("M") == len(times)
        if time in times:
            expected = rows[times.index(time), :2]
            assert float(found[1]) == float(f"{expected[0]:.5g}")
            assert float(found[2]) == float(f"{expected[1]:.2g}")
            assert f" ± {found[2]} MPa" in drawn[0]
        else:
            assert found[2] is None and "±" not in drawn[0]
        if is_full:
            value, off = heat[times.index(time), :2]
            words, bars = next(each for each in charts if "Heat in:" in each[0])
            told = re.search(r"Heat in: ([\d.]+) ± ([\d.]+) W", words)
            assert float(told[1]) == float(f"{value:.5g}") and float(told[2]) == float(f"{off:.2g}")
            assert bars.count("M") == len(times)


@pytest.mark.parametrize("size", [0.9, 20.0])
def test_bars_of_uncertainty_end_within_the_frame_or_leave_it_to_the_curve(uncertain, browser, tmp_path, size):
    """Bars that are longer than the curve is high would make it flat."""
    path, _ = uncertain
    copy = shutil.copy(path, tmp_path)
    with h5py.File(copy, "r+") as file:
        rows = file["uncertainty/FACE/normal_force"]
        rows[:, 1] = size * rows[:, 0].max()
    assert main([str(copy), "--out", str(tmp_path)]) == 0
    browser.open(tmp_path / "cylinder.html")
    frame, bars, curve = browser.run("""const box = document.querySelector('#history-0');
        const frame = box.querySelector('clipPath rect');
        return [[+frame.getAttribute('y'), +frame.getAttribute('height')],
            ...['.uncertainty', 'g path[fill=none]'].map(e => box.querySelector(e).getAttribute('d'))]""")
    ends = [float(y) for y in re.findall(r"[ V]([-\d.]+)", bars)]
    heights = [float(y) for y in re.findall(r" ([-\d.]+)", curve)]
    assert len(ends) >= 2 and (frame[0] < min(ends) < max(ends) < sum(frame)) == (size < 1.0)
    assert size < 1.0 or max(heights) - min(heights) > 0.5 * frame[1]


def test_a_chart_of_a_temperature_shows_the_range_of_its_values(synthetic, browser):
    """A pulse of 2.6 degrees; the rounding of what stays as it is is no pulse."""
    def heat(file):
        times = file["history/time"][()]
        for name, size in (("PULSE", 2.6), ("STILL", 1e-9)):
            group = file.create_group(f"history/nodes/{name}")
            group["node"], group["time"], group["increment"] = [7], times, np.arange(1, len(times) + 1)
            group["temperature"] = 20.0 + size * np.sin(np.arange(len(times)))[:, None] ** 2

    browser.open(synthetic(heat))
    ticks = browser.run("""return [...document.querySelectorAll('#histories figure')].filter(
        e => e.querySelector('figcaption').textContent.startsWith('Temperature of ')).map(
        e => [...e.querySelectorAll('.tick[text-anchor=end]')].map(tick => Number(tick.textContent)))""")
    assert 19.0 < min(ticks[0]) <= 20.0 < 21.5 < max(ticks[0]) < 24.0
    assert min(ticks[1]) < 15.0 and max(ticks[1]) > 25.0


def test_energies_and_times_have_the_units_of_the_deck(synthetic):
    def spend(file):
        for key, unit in (("ALLFD", "MPa mm^3"), ("solid_time", "s"), ("period", "time")):
            file[f"history/{key}"] = file["history/time"][()]
            file[f"history/{key}"].attrs["unit"] = unit

    with Result(synthetic(spend).with_suffix(".vtkhdf")) as opened:
        found = {each["key"]: each["unit"] for each in histories(opened)}
    assert (found["ALLFD"], found["solid_time"], found["period"]) == ("N mm", "s", "")


def test_a_card_without_an_expectation_is_no_check_but_its_value_is_shown(tmp_path):
    deck = write_deck(tmp_path / "cylinder.inp")
    cards = deck.read_text().replace("\n20., 900.", "\n450., 900.").split("\n*VERIFY", 1)[0]
    deck.write_text(f"{cards}\n*Verify, KIND=NONE\nNT, TOP, LAST\nMISES, MAX, LAST\n"
                    "heat_in, , LAST\nNT reaches 500., BASE, LAST\n")
    assert run(deck)[0] == 0
    assert main([str(deck.with_suffix(".vtkhdf")), "--out", str(tmp_path)]) == 0
    page = (tmp_path / "cylinder.html").read_text()
    assert "<dt>checks</dt><dd>none: KIND=NONE asks for values alone</dd>" in page
    assert "<p>None: KIND=NONE asks for values alone.</p>" in page and 'class="pass"' not in page
    table = page[page.index("<caption>*VERIFY"):].split("</table>")[0]
    heads = re.findall(r'<th scope="col"[^>]*>(.*?)</th>', table)
    rows = [dict(zip(heads, re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row)))
            for row in re.findall("<tr>(.*?)</tr>", table)[1:]]
    assert heads == ["card", "quantity", "where", "time", "found", "uncertainty (95 %)", "unit",
                     "verdict", "kind and source"]
    assert [[row[key] for key in ("quantity", "found", "unit", "verdict")] for row in rows] == [
        ["NT", "9.0000000E+02", "°C", "–"], ["MISES", rows[1]["found"], "MPa", "–"],
        ["heat_in", rows[2]["found"], "W", "–"], ["NT reaches 500", "–", "", "– never reached"]]
    assert re.fullmatch(r"TOP \(node \d+\)", rows[0]["where"]) and rows[1]["where"] == "MAX"
    known = [row["uncertainty (95 %)"] for row in rows]
    assert known[0] == known[2] == "no estimate: needs ERRORS=FULL"
    assert known[1].startswith("± ") and known[3] == ""


def test_results_of_earlier_versions_have_their_uncertainties(uncertain, tmp_path):
    """These name the group and its columns otherwise."""
    path, is_full = uncertain
    seen = {}
    for columns in ("value uncertainty change scatter iteration",
                    "value bound mesh increments iteration"):
        copy = shutil.copy(path, tmp_path)
        with h5py.File(copy, "r+") as file:
            rows = file["errors/FACE"]
            del file["uncertainty" if "bound" in columns else "errors"]
            for key in set(rows) - {"no_estimate"}:
                rows[key].attrs["components"] = columns
            rows = rows["normal_force"][-1]
        assert main([str(copy), "--out", str(tmp_path)]) == 0
        page = (tmp_path / "cylinder.html").read_text()
        seen[columns] = re.search("<caption>Interface FACE at the last (.*?)</table>", page)[1]
        for part in columns.split()[2:]:
            assert f">by {part}</th>" in seen[columns]
        row = seen[columns].split("normal force")[1].split("</tr>")[0].replace("−", "-")
        cells = re.findall(r"<td[^>]*>(.*?)</td>", row)[3:]
        assert list(map(float, cells)) == [float(f"{part:.2g}") for part in rows[2:]]
    former, present = (re.sub(' data-head="[^"]*"', "", table.split("<tbody>")[1]) for table in seen.values())
    assert former == present
    assert ("Heat of the model at the last increment" in page) == is_full


def test_the_page_takes_step_and_reason_from_the_listing(tmp_path):
    text = page_of_example(tmp_path, "brake_pad", "--accuracy", "5%", status=4)
    assert '<span class="fail">not met</span>, step 1 with ' in text
    assert "MPa: at a corner</td>" in text


def test_the_page_says_what_there_is_where_nothing_is_judged(tmp_path):
    """In the words of the listing, if there is one."""
    text = page_of_example(tmp_path, "press_fit", "--accuracy", "3%")
    assert re.findall(r">(nothing to judge.*?)</td>", text) == [
        "nothing to judge: whole face", "nothing to judge: no heat"]
    (tmp_path / "press_fit.lst").unlink()
    assert main([str(tmp_path / "press_fit.vtkhdf"), "--out", str(tmp_path)]) == 0
    text = (tmp_path / "press_fit.html").read_text()
    assert re.findall(r">(nothing to judge.*?)</td>", text) == ["nothing to judge"] * 2


def test_what_is_no_result_is_refused(tmp_path, capsys):
    assert main([str(tmp_path / "none.vtkhdf")]) == 2
    assert capsys.readouterr().err.endswith("none.vtkhdf: no such file\n")
    assert main([]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_fields_of_many_increments_are_thinned_to_the_last():
    assert kept_steps(5, 10) == [0, 1, 2, 3, 4]
    thinned = kept_steps(1000, 14000)
    assert len(thinned) == 100 and thinned[-1] == 999 and thinned[0] == 0
    assert kept_steps(9, 10**9) == [8]


def test_principal_radial_and_hoop_stress():
    stress = np.array([[3.0, -1.0, 0.5, 2.0], [10.0, -4.0, 7.0, 0.0]])
    # Mohr's circle: centre 1, radius sqrt(4 + 4).
    expected = [[1.0 + 8.0**0.5, 0.5, 1.0 - 8.0**0.5], [10.0, 7.0, -4.0]]
    np.testing.assert_allclose(stresses.principal(stress), expected, rtol=1e-14)
    points = np.array([[1.0, 1.0], [0.0, 2.0]])
    # At 45 degrees (xx + yy)/2 + xy; on the y axis yy.
    np.testing.assert_allclose(stresses.radial(stress, points, False), [3.0, -4.0], rtol=1e-14)
    np.testing.assert_allclose(stresses.hoop(stress, points, False), [-1.0, 10.0], atol=1e-14)
    np.testing.assert_array_equal(stresses.radial(stress, points, True), stress[:, 0])
    np.testing.assert_array_equal(stresses.hoop(stress, points, True), stress[:, 2])


@pytest.mark.parametrize(("cards", "expected"), [
    (["*ELEMENT, TYPE=CAX8, ELSET=A"], True),
    (["*Element, elset=A, type=cax4r"], True),
    (["*ELEMENT, TYPE=CPE8"], False),
    (["*OPTIONS, PLANE=AXISYMMETRIC", "*ELEMENT, TYPE=CPS8"], True),
    (["*OPTIONS, PLANE=STRAIN", "*ELEMENT, TYPE=CAX8"], False),
    (["** *ELEMENT, TYPE=CAX8"], False),
])
def test_the_cards_tell_an_axisymmetric_model(cards, expected):
    assert stresses.is_axisymmetric(cards) == expected
