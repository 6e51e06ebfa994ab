"""The page in headless Chromium: what can be clicked and typed, what is fetched, who can read it, and words that mean harm."""

import importlib.util
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from benchmark import report, results
from benchmark.results import CaseHeading, Entry, Results
from estimators.api import Estimate, Outcome
from scenes.dataset import Dataset
from scenes.recording import Observation

HOSTILE = "<img src=x onerror='window.broken = 1'>"
REASON = "</script><script>window.broken = 2</script> & no {{ 7 * 7 }} corner"
LARGEST = 1_500_000  # bytes of a page of one small case
SIZES = {"desk": {"width": 1280, "height": 900}, "phone": {"width": 390, "height": 844}}


@pytest.fixture(scope="module")
def page_file(dataset: Dataset, toy: Any, judged_entry: Callable[..., Entry], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page of three methods: one that works, one that answers late, and one whose name and reasons are meant to do harm."""

    class Late(toy):  # type: ignore[misc]
        first, reason = 8, "not yet"

        def step(self, observation: Observation) -> Estimate:
            if observation.frame < self.first:
                return Estimate("nav", Outcome.NO_FEATURES, reason=self.reason)
            found: Estimate = super().step(observation)
            return found

    class Hostile(Late):
        first, reason = 15, REASON

    out = tmp_path_factory.mktemp("page")
    methods = {"toy": toy(), "late": Late(), HOSTILE: Hostile()}.items()
    entries = [
        judged_entry(dataset, out, str(place), title, estimator, parameters={"window_px": 5})
        for place, (title, estimator) in enumerate(methods)
    ]
    heading = CaseHeading(name="turn", description="θ from −20° to 20°")
    results.write(
        out,
        Results(title="A turning panel", command="hardlight bench <turn> --out out/turn", cases=(heading,), entries=tuple(entries)),
    )
    return report.write(out)


@pytest.fixture
def open_page(browser: Any, page_file: Path) -> Iterator[Any]:
    """open_page(size="desk", **options of the context) → the loaded page. Nothing may be said to the console or fetched."""
    contexts, said, asked = [], [], []

    def opened(size: str = "desk", fragment: str = "", **options: Any) -> Any:
        context = browser.new_context(viewport=SIZES[size], reduced_motion="reduce", **options)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("dialog", lambda dialog: said.append(dialog.message))
        page.on("request", lambda request: asked.append(request.url))
        page.goto(page_file.as_uri() + fragment)
        return page

    yield opened
    for context in contexts:
        context.close()
    outside = [url for url in asked if not url.startswith("data:") and url.partition("#")[0] != page_file.as_uri()]
    assert (said, outside) == ([], [])


def _column(page: Any, number: int) -> list[str]:
    cells = page.locator(f".board tbody tr > :nth-child({number})").all()
    return [cell.evaluate("one => one.firstChild.textContent.trim() || one.textContent.trim()") for cell in cells]


def test_the_page_is_small_and_its_parts_are_in_order(open_page: Any, page_file: Path) -> None:
    page = open_page()
    assert page_file.stat().st_size < LARGEST
    levels = page.eval_on_selector_all("h1, h2, h3, h4", "all => all.map(one => Number(one.tagName[1]))")
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(later <= earlier + 1 for earlier, later in pairwise(levels))
    targets = page.eval_on_selector_all("a[href^='#']", "all => all.map(one => one.hash.slice(1))")
    assert all(page.locator(f"[id='{target}']").count() == 1 for target in targets)
    assert page.locator(".made code").first.inner_text() == "hardlight bench <turn> --out out/turn"
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"


def test_columns_sort_by_click_and_by_key_with_missing_figures_last(open_page: Any) -> None:
    page = open_page()
    assert _column(page, 1)[0].startswith("1")
    header = page.locator(".board th", has_text="p95")
    header.locator("button").click()
    assert header.get_attribute("aria-sort") == "ascending"
    assert page.locator(".board th[aria-sort]").count() == 1
    upwards = _column(page, 5)
    header.locator("button").press("Enter")
    assert header.get_attribute("aria-sort") == "descending"
    downwards = _column(page, 5)
    assert upwards[-1] == downwards[-1] == "—"
    known = [float(one) for one in upwards if one != "—"]
    assert known == sorted(known)
    assert [float(one) for one in downwards if one != "—"] == known[::-1]
    assert "descending" in page.locator("[role=status]").first.inner_text()
    page.locator(".board th", has_text="answered").locator("button").press("Space")
    assert [float(one) for one in _column(page, 3)] == sorted(map(float, _column(page, 3)), reverse=True)


def test_one_method_is_shown_at_a_time_and_links_lead_to_each(open_page: Any) -> None:
    page = open_page()
    assert [one.is_visible() for one in page.locator("article.method").all()] == [True, False, False]
    page.locator(".board a", has_text="late").click()
    page.wait_for_selector("#method-late", state="visible")
    assert page.locator("article.method:visible").count() == 1
    assert page.locator("#method-list [aria-current]").inner_text() == "late"
    assert page.evaluate("document.activeElement.id") == "method-late-title"
    page.go_back()
    named = open_page(fragment="#method-late")
    assert named.locator("article.method:visible h3").inner_text() == "late"


def test_the_theme_follows_the_system_until_it_is_chosen(open_page: Any) -> None:
    page = open_page(color_scheme="dark")
    ground = "getComputedStyle(document.body).backgroundColor"
    dark = page.evaluate(ground)
    button = page.locator("button.theme")
    assert button.inner_text() == "Light theme"
    button.click()
    light = page.evaluate(ground)
    assert light != dark
    assert button.inner_text() == "Dark theme"
    page.reload()
    assert page.evaluate(ground) == light
    page.locator("button.theme").press("Enter")
    assert page.evaluate(ground) == dark


def test_a_browser_that_stores_nothing_has_the_whole_page(open_page: Any, browser: Any, page_file: Path) -> None:
    page = browser.new_page()
    page.add_init_script("Object.defineProperty(window, 'localStorage', { get() { throw new Error('denied'); } })")
    page.goto(page_file.as_uri())
    page.locator("button.theme").click()
    assert page.evaluate("document.documentElement.dataset.theme") in ("light", "dark")
    page.close()


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("size", ["desk", "phone"])
def test_an_audit_finds_nothing_serious(open_page: Any, size: str, theme: str) -> None:
    found = importlib.util.find_spec("axe_playwright_python")
    if found is None or found.origin is None:
        pytest.skip("axe-playwright-python is not installed")
    page = open_page(size, color_scheme=theme)
    page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    page.evaluate((Path(found.origin).parent / "axe.min.js").read_text(encoding="utf-8"))
    violations = page.evaluate("axe.run().then((found) => found.violations)")
    serious = [one for one in violations if one["impact"] in ("serious", "critical")]
    assert [(one["id"], [node["html"][:200] for node in one["nodes"]][:3]) for one in serious] == []


def test_a_phone_scrolls_down_alone(open_page: Any) -> None:
    page = open_page("phone")
    page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    assert page.evaluate("document.documentElement.scrollWidth") <= SIZES["phone"]["width"]
    regions = page.locator(".scroll").all()
    assert regions
    assert all(one.get_attribute("tabindex") == "0" and one.get_attribute("aria-label") for one in regions)


def test_names_and_reasons_from_outside_are_text_and_nothing_else(open_page: Any) -> None:
    page = open_page()
    page.locator(".board a", has_text=HOSTILE).click()
    shown = page.locator("article.method:visible")
    assert shown.locator("h3").inner_text() == HOSTILE
    assert REASON in shown.locator(".reasons-given").inner_text()
    assert page.locator("img[src='x']").count() == 0
    assert page.evaluate("window.broken ?? 0") == 0
    assert (shown.get_attribute("id") or "").replace("-", "").isalnum()


def test_without_javascript_all_is_there(open_page: Any) -> None:
    page = open_page(java_script_enabled=False)
    methods = page.locator("article.method").all()
    assert len(methods) == 3
    assert all(one.is_visible() for one in methods)
    assert page.locator("header button, .board button").count() == 0
    assert page.locator(".board th", has_text="rank").get_attribute("aria-sort") == "ascending"
    assert page.locator("#cases").is_visible()
    assert page.locator("#provenance").is_visible()
