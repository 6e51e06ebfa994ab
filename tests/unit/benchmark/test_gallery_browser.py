"""The gallery in headless Chromium: layers and lines are switched, scans are turned by key and pointer, nothing goes wrong."""

import base64
from typing import Any

import cv2
import numpy as np
import pytest
from jinja2 import Environment, PackageLoader, StrictUndefined

from benchmark.gallery_item import Item, View
from benchmark.gallery_layers import Layer
from benchmark.gallery_outlines import Shape
from benchmark.gallery_scans import Scan3D
from benchmark.report_gallery import Gallery, Shelf
from benchmark.report_pictures import data_uri

HOSTILE = "</script><img src=x onerror='window.broken = 1'>"
PAGE = """<!doctype html><html lang="en"><head><meta charset="utf-8"><title>gallery</title><script>
window.faults = []; addEventListener("error", (event) => faults.push(event.message));
console.error = (...words) => faults.push(words.join(" "));
</script><style>{% include "theme.css" %}{% include "report.css" %}{% include "gallery.css" %}</style></head>
<body><main>{% import "gallery.html.j2" as g %}{{ g.section(view) }}</main>
<script>{% include "gallery.js" %}</script><script>{% include "scan3d.js" %}</script></body></html>"""
CHECKS = """async () => {
const shown = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
const card = document.querySelector(".g-card:not(.g-scan)"), image = card.querySelector(".g-image"), found = {};
const visible = (one) => getComputedStyle(one).display !== "none";
const picture = image.getAttribute("href"), radios = [...card.querySelectorAll("input[type=radio]")];
found.tools = visible(card.querySelector(".g-tools"));
found.stacked = [...card.querySelectorAll(".g-layer img")].filter(visible).length;
found.scales = [...card.querySelectorAll(".g-layer")].filter(visible).length;
radios[1].click();
const depth = card.querySelector(".g-layer[data-layer=depth] img").getAttribute("src");
found.layer = image.getAttribute("href") === depth && depth !== picture;
found.scale = card.querySelector(".g-layers").innerText.includes("5.00 m");
radios[0].click();
found.back = image.getAttribute("href") === picture;
const lines = card.querySelector("input[value=answered]"), drawn = [...card.querySelectorAll("[data-kind=answered]")];
found.before = drawn.filter(visible).length;
lines.click();
found.after = drawn.filter(visible).length;
found.others = [...card.querySelectorAll("[data-kind=true]")].filter(visible).length;
found.reason = card.querySelector(".g-reason").textContent;
const scan = document.querySelector(".g-scan"), canvas = scan.querySelector("canvas");
const look = () => canvas.toDataURL(), how = { bubbles: true, cancelable: true };
const key = (name) => canvas.dispatchEvent(new KeyboardEvent("keydown", { key: name, ...how }));
const changes = (act) => { const seen = look(); act(); return look() !== seen; };
const point = (type, x) => canvas.dispatchEvent(new PointerEvent(type, { clientX: x, clientY: 40, pointerId: 1, bubbles: true }));
canvas.setPointerCapture = () => {};
const ground = () => canvas.getContext("2d").getImageData(2, 2, 1, 1).data[0];
await shown();
key("0");
const own = look();
found.keys = ["ArrowLeft", "ArrowUp", "+", "-"].filter((name) => changes(() => key(name))).length;
found.other = changes(() => key("q"));
found.reset = changes(() => key("0")) && look() === own;
found.drag = changes(() => { point("pointerdown", 20); point("pointermove", 90); point("pointerup", 90); });
found.free = changes(() => point("pointermove", 140));
found.colours = [...scan.querySelectorAll("input[type=radio]")].slice(1).filter((one) => changes(() => one.click())).length;
found.legend = scan.querySelector(".g-scan-legend").textContent;
found.pose = changes(() => scan.querySelector("input[type=checkbox]").click());
found.button = changes(() => scan.querySelector("[data-do=closer]").click());
found.pixels = canvas.width / canvas.clientWidth;
document.documentElement.dataset.theme = "dark";
await shown();
const dark = ground();
document.documentElement.dataset.theme = "light";
await shown();
return { ...found, grounds: [dark, ground()], faults: window.faults, broken: window.broken ?? 0 };
}"""


def _gallery() -> Gallery:
    grey = np.tile(np.arange(0, 240, 6, dtype=np.uint8), (30, 1))
    picture = Layer("picture", "Picture", data_uri(grey), low="grey values")
    depth = Layer("depth", "Depth", data_uri(cv2.applyColorMap(grey, cv2.COLORMAP_JET)), ("#000000", "#ffffff"), "5.00 m", "6.00 m")
    shapes = (Shape("true target", "M1,1 30,2 20,20Z"), Shape("true", "M3,3 20,4 9,18Z"), Shape("answered", "M4,4 22,4 9,20Z"))
    view = View("nav", 40, 30, (picture, depth), shapes)
    card = Item(
        key="gallery-0", modality="mono", method=f"m {HOSTILE}", series=0, badge="worst answer", heading="case, panel, frame 3",
        verdict="off by 20°: wrong", conditions="3 s", reason=HOSTILE, command="hardlight render x", is_answered=True,
        is_wrong=True, views=(view,),
    )  # fmt: skip
    return Gallery((Shelf("gallery-mono", "One camera", (card,)),), (_scan(),))


def _scan() -> Scan3D:
    rng = np.random.default_rng(1)
    count, code = 500, lambda values: base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()
    corners = [[x, y, 60 + z] for x in (-1, 1) for y in (-1.5, 1.5) for z in (-0.5, 0.5)]
    pose = {"name": HOSTILE, "series": None, "corners": corners, "axes": [[0, 0, 60], [2, 0, 60], [0, 2, 60], [0, 0, 62]]}
    data: dict[str, Any] = {
        "count": count, "origin": [0.0, 0.0, 60.0], "step": 1e-4, "centre": [0.0, 0.0, 60.0], "parts": ["nothing", HOSTILE],
        "poses": [pose, pose | {"series": 1}], "xyz": code(rng.integers(-10000, 10000, (count, 3)).astype("<i2")),
        "strength": code(rng.integers(0, 256, count).astype(np.uint8)), "fate": code((np.arange(count) % 3).astype(np.uint8)),
        "part": code(np.ones(count, np.uint8)), "lost": code((np.arange(count) % 3 == 2).astype(np.uint8)),
    }  # fmt: skip
    return Scan3D("scan3d-0", f"run {HOSTILE}", "500 returns", "hardlight render x", data)


@pytest.fixture(scope="module")
def found(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the checks saw in the page."""
    file = tmp_path_factory.mktemp("page") / "page.html"
    loader = PackageLoader("benchmark", "templates")
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    file.write_text(environment.from_string(PAGE).render(view=_gallery()), encoding="utf-8")
    context = browser.new_context(viewport={"width": 900, "height": 1400}, device_scale_factor=2)
    page = context.new_page()
    page.goto(file.as_uri())
    seen: dict[str, Any] = page.evaluate(CHECKS)
    context.close()
    return seen


def test_layers_and_lines_are_switched(found: dict[str, Any]) -> None:
    assert found["tools"]
    assert found["stacked"] == 0  # the pictures that stand in for the script
    assert found["scales"] == 1
    assert found["layer"]
    assert found["scale"]
    assert found["back"]
    assert (found["before"], found["after"], found["others"]) == (1, 0, 2)


def test_a_scan_is_turned_by_keys_pointer_and_buttons_and_coloured(found: dict[str, Any]) -> None:
    assert found["keys"] == 4
    assert not found["other"]
    assert found["reset"]
    assert found["drag"]
    assert not found["free"]  # without a button held
    assert found["colours"] == 3
    assert found["pose"]
    assert found["button"]
    assert found["pixels"] == pytest.approx(2.0, abs=0.05)


def test_the_canvas_follows_the_theme(found: dict[str, Any]) -> None:
    dark, light = found["grounds"]
    assert dark < 60
    assert light > 200


def test_nothing_goes_wrong_and_untrusted_words_stay_words(found: dict[str, Any]) -> None:
    assert found["faults"] == []
    assert found["broken"] == 0
    assert found["reason"] == HOSTILE
    assert HOSTILE in found["legend"]
