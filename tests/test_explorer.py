"""The page of an emulator in a browser: its numbers are Python's, and nothing leaves it."""

import html
import json
import re
import subprocess
from types import SimpleNamespace

import pytest
import yaml

import fingerpad
from fingerpad.emulator import explorer
from fingerpad.emulator.explorer import page
from test_browser import BROWSER, PHONE, walk
from test_emulator import OVER, SCENE, history, made_up, truth

pytestmark = pytest.mark.browser

DRIVE = """<script>
const found = [];
const knobs = [...document.querySelectorAll("input[type=range]")];
const boxes = [...document.querySelectorAll("input[type=number]")];
function look(what) {
  const answered = answer(state), last = answered.indentation_depth.length - 1;
  found.push({ what, scene: document.getElementById("scene").textContent, rows: rows(answered),
    beyond: document.getElementById("beyond")?.textContent,
    circles: [...document.querySelectorAll("#force .measured")].map(c => +c.getAttribute("r")),
    note: document.getElementById("note").textContent,
    elements: document.getElementById("elements").textContent,
    overlays: document.querySelectorAll("svg .outside").length,
    words: document.getElementById("numbers").textContent,
    boxes: boxes.map(box => [box.id.replace(/^knob-|-box$/g, ""), box.value]),
    shown: [...document.querySelectorAll("#numbers td:nth-child(2)")].map(cell => cell.textContent),
    impulses: impulses(answered.rate), outside: answered.outside.length,
    time: answered.time[last], error: answered.estimated_error,
    mute: [...document.querySelectorAll("svg")].filter(e => !e.getAttribute("aria-label")).length,
    broken: document.querySelector("main").innerHTML.includes("NaN"), link: link() });
}
look("start");
for (const knob of knobs) {
  const before = knob.value;
  for (const value of [knob.min, knob.max]) {
    knob.value = value;
    knob.dispatchEvent(new Event("input"));
    look(knob.id + " " + value);
  }
  knob.value = before;
  knob.dispatchEvent(new Event("input"));
}
const before = JSON.stringify(state);
state.modulus = 0.5;
for (const knob of model.knobs.filter(k => [FORCE, RATE].includes(k.key))) {
  state.values[knob.key] = knob.high;
}
draw();
look("outside");
Object.assign(state, JSON.parse(before));
const began = performance.now();
for (let k = 0; k < 20; k++) draw();
const milliseconds = (performance.now() - began) / 20;
for (const button of document.querySelectorAll("#surfaces button, #subjects button")) {
  button.click();
  look(button.textContent);
}
const typed = [], box = document.getElementById("knob-curvature-box");
const types = [["400", "input"], ["4", "input"], ["4", "change"], ["9999", "change"]];
for (const [value, kind] of [...types, ["", "change"]]) {
  const slider = document.getElementById("knob-curvature");
  box.value = value;
  box.dispatchEvent(new Event(kind));
  typed.push([box.value, state.values[CURVE], +slider.value]);
}
const saved = link();
state.hold = 0.1;
location.hash = saved;
readLink();
const linked = link() === saved;
const result = document.createElement("pre");
result.id = "result";
result.textContent = JSON.stringify({ found, linked, typed, milliseconds,
  knobs: knobs.map(k => k.id),
  pictures: [...document.querySelectorAll("svg")].map(e => e.id),
  unnamed: knobs.filter(k => !k.labels.length).length +
    boxes.filter(b => !b.getAttribute("aria-label")).length });
document.body.append(result);
</script></body>"""


CURVES = {"stimulus.curvature": {"range": ["0.01 1/m", "1300 1/m"]}}
SPHERE = {"kinematics": "axisymmetric", "stimulus": {"shape": "sphere", "curvature": "210 1/m"}}


@pytest.fixture(scope="module", params=[{}, SPHERE], ids=["cylinder", "sphere"])
def made(tmp_path_factory, request):
    """An emulator, its page, and what the browser found while every knob was turned."""
    if BROWSER is None:
        pytest.skip("no chromium here: apt-get install chromium")
    folder = tmp_path_factory.mktemp("explorer")
    thickness = {"specimen.outline.epidermis_thickness": {"range": ["0.5 mm", "1.2 mm"]}}
    pad = fingerpad.emulate(
        made_up(folder / "sweep", 128, over=OVER | CURVES | thickness, base=SCENE | request.param)
    )
    (folder / "site").mkdir()
    (folder / "site/explorer.html").write_text(page(pad), encoding="utf-8")
    result, console = drive(pad, folder)
    return pad, folder, result, console


def drive(pad, folder):
    """What the browser found while every knob of a page was turned, and its console."""
    driven = folder / "driven.html"
    driven.write_text(page(pad).replace("</body>", DRIVE), encoding="utf-8")
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
    options += ["--enable-logging=stderr", f"--user-data-dir={folder / 'profile'}", "--dump-dom"]
    run = subprocess.run(
        [BROWSER, *options, driven.as_uri()], capture_output=True, text=True, timeout=300
    )
    text = re.search(r'<pre id="result">(.*?)</pre>', run.stdout, re.S)
    assert text, run.stderr[-2000:]
    return json.loads(html.unescape(text[1])), re.findall(r"CONSOLE[^\]]*\] (.*)", run.stderr)


def test_numbers_at_both_ends_of_every_knob_are_pythons(made):
    """What the page says of a scene, and what Python says of the scene that the page gives."""
    pad, _, result, _ = made
    looks = [look for look in result["found"] if not look["outside"]]
    assert len(result["knobs"]) == 6 and len(looks) > 12
    for look in looks:
        scene = yaml.safe_load(look["scene"])
        scene["outputs"] = {"receptors": {"depths": ["600 um", "915 um"]}}
        found = pad.predict(scene)
        last = found.isel(time=-1)
        energies = iter(range(2))
        assert look["time"] == pytest.approx(float(found.time[-1]), rel=1e-9)
        assert look["error"] == pytest.approx(found.attrs["estimated_error"], rel=1e-5)
        for row, shown in zip(look["rows"], look["shown"], strict=True):
            assert row["unit"] == shown.split()[1]
            scale = {"mm": 1e3, "kPa": 1e-3, "Pa": 1.0}[row["unit"]]
            at = next(energies) if row["name"] == "strain_energy_density" else ...
            for value, name in ((row["value"], ""), (row["band"], "_error")):
                exact = scale * float(last[row["name"] + name].values[at])
                assert value == pytest.approx(exact, rel=1e-5), (look["what"], row["label"])
            assert float(shown.split()[0]) == pytest.approx(row["value"], rel=6e-4)
        sent = fingerpad.respond(found)
        times = sent.impulse_time.values[0, 0, : int(sent.impulses[0, 0])]
        assert look["impulses"] == pytest.approx(times.tolist(), rel=1e-5)


def test_the_page_says_where_nothing_is_known(made):
    for look in made[2]["found"]:
        outside = bool(look["outside"])
        assert (look["shown"][0] == "\u2013") == outside == (not look["elements"]), look["what"]
        assert look["overlays"] == (len(made[2]["pictures"]) if outside else 0)
        assert bool(look["note"]) == outside
    notes = {look["what"]: look["note"] for look in made[2]["found"]}
    ranges = "Force from 5 to 30\u00a0gf and Rate of force from 20 to 40\u00a0gf/s"
    assert notes["outside"] == f"Unknown: not simulated. At stiffness 0.5, use {ranges}."


def test_numbers_have_no_exponents_and_do_not_break(made):
    for look in made[2]["found"]:
        assert not re.search(r"\de[+-]?\d|\d (k?Pa|mm)", look["words"]), look["words"]


def test_knobs_have_their_order_and_a_box_for_the_number(made):
    """A number that is typed is kept as it is; one outside the knob goes to its nearer end."""
    result = made[2]
    names = ["curvature", "force", "rate", "modulus", "epidermis_thickness", "hold"]
    assert result["knobs"] == [f"knob-{name}" for name in names]
    for look in result["found"]:
        values = dict(part.split("=") for part in look["link"][1:].split("&"))
        for name, value in look["boxes"]:
            assert float(value) == pytest.approx(float(values[name]), rel=1e-5), look["what"]
    typed = result["typed"]
    assert typed[:3] == [["400", 400, 123], ["4", 4, 1], ["4", 4, 1]]
    assert typed[3] == typed[4] == ["1300", 1300, 400]


@pytest.mark.parametrize(
    ("receptors", "gone"),
    [([0, 2], {"energy"}), ([1, 3], {"energy", "time", "rate"})],
    ids=["middle", "side"],
)
def test_a_short_hold_and_receptors_of_one_place(tmp_path, receptors, gone):
    """The hold starts within the sweep's; pictures that would be empty are not there."""
    if BROWSER is None:
        pytest.skip("no chromium here: apt-get install chromium")
    motion = [{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "0.5 s"}]
    outputs = {"receptors": {"depths": ["600 um", "915 um"], "offsets": [f"{receptors[0]} mm"]}}
    sweep = made_up(
        tmp_path / "sweep",
        64,
        base=SCENE | {"motion": motion, "outputs": outputs},
        show=lambda scene: history(scene).isel(receptor=receptors),
    )
    result, console = drive(fingerpad.emulate(sweep), tmp_path)
    scene = yaml.safe_load(result["found"][0]["scene"])
    assert scene["motion"][1] == {"hold": "0.5 s"} and not console
    pictures = {"section", "force", "pressure", "energy", "time", "rate"}
    assert set(result["pictures"]) == pictures - gone - {"force"}
    for look in result["found"]:
        assert not look["mute"] and not look["broken"], look["what"]


def test_measured_fingers_are_drawn_beside_the_force_under_a_plate(made):
    """Four fingers of four points each; the one that is chosen is larger. Of spheres none."""
    pad, _, result, _ = made
    chosen = [look for look in result["found"] if look["what"].startswith("finger")]
    assert len(chosen) == (0 if pad.turned else 4)
    for look in chosen:
        assert sorted(look["circles"]) == 12 * [3] + 4 * [5] and "Do not" not in look["beyond"]
    if not pad.turned:
        assert "not flat, the hold is shorter than 2" in result["found"][0]["beyond"]


def test_the_factor_of_a_measured_finger_is_found_again(tmp_path, monkeypatch):
    """Of a made-up finger 1.3 times as stiff as the made-up pad."""
    pad = fingerpad.emulate(made_up(tmp_path / "flat", 96, over=OVER | CURVES, base=SCENE))
    rate = pad.base["motion"][0]["rate"]

    def point(force):
        depth = truth(0.01, force, rate, 1e9)[0]
        return SimpleNamespace(
            subject="me", value=1.3 * force, source="made up", place=lambda *_: depth
        )

    rows = [point(force) for force in (0.06, 0.1, 0.2, 0.4)]
    monkeypatch.setattr(explorer, "datasets", lambda names: {"force_plate": rows})
    (me,) = explorer.measured_subjects(pad)
    assert me["modulus"] == pytest.approx(1.3, rel=0.015) and len(me["points"]) == 4


def test_every_picture_has_words_and_no_number_is_missing(made):
    for look in made[2]["found"]:
        assert not look["mute"] and not look["broken"], look["what"]
    assert made[2]["unnamed"] == 0


def test_a_link_keeps_the_knobs(made):
    assert made[2]["linked"]


def test_the_console_is_silent_and_nothing_leaves_the_page(made):
    _, folder, _, console = made
    text = (folder / "site/explorer.html").read_text(encoding="utf-8")
    assert not console
    assert "default-src 'none'" in text
    assert set(re.findall(r"https?://[^\"' ]+", text)) <= {"http://www.w3.org/2000/svg"}


def test_it_fits_a_phone(made, tmp_path):
    found, console = walk(made[1] / "site", ["/explorer.html"], PHONE, tmp_path)
    assert found["/explorer.html"]["width"] <= PHONE and not console


def test_colours_can_be_read_on_both_grounds():
    """Text 4.5 to 1, lines 3 to 1 (WCAG 2.2, 1.4.3 and 1.4.11)."""
    css = page_css()
    for block in re.findall(r":root \{(.*?)\}", css, re.S):
        colours = dict(re.findall(r"--(\w+): (#[0-9a-f]{6});", block))
        for name, least in {"ink": 7, "quiet": 4.5, "mark": 4.5, "line": 3, "skin": 3}.items():
            assert contrast(colours[name], colours["back"]) >= least, name
        for name in ("second", "third", "fourth"):
            assert contrast(colours[name], colours["back"]) >= 3, name


def page_css():
    from importlib.resources import files

    return (files("fingerpad.emulator") / "page.css").read_text(encoding="utf-8")


def contrast(one, other):
    """The ratio of WCAG of two colours such as #a0b0c0."""

    def luminance(colour):
        parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        r, g, b = (p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
        return 0.2126 * r + 0.7152 * g + 0.0722 * b

    low, high = sorted(map(luminance, (one, other)))
    return (high + 0.05) / (low + 0.05)
