"""report.html in headless Chromium, from disk, with the network off."""

import os
import shutil
from pathlib import Path

import pytest

from tests.reports.report_folder import ATTACKS

pytestmark = [pytest.mark.browser, pytest.mark.needs("playwright", "chromium")]
CHROMIUM = next(
    (path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), None
)
SCREENS = {"desktop": {"width": 1280, "height": 900}, "phone": {"width": 390, "height": 844}}


@pytest.fixture(scope="module")
def browser():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def open_page(browser, attacked):
    """(screen, colour scheme) -> the page, and the list of what went wrong on it."""
    contexts = []

    def open_(screen="desktop", scheme="light"):
        context = browser.new_context(viewport=SCREENS[screen], color_scheme=scheme, offline=True)
        contexts.append(context)
        page, wrong = context.new_page(), []
        page.on("console", lambda message: wrong.append(message.text))
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("dialog", lambda dialog: (wrong.append(dialog.message), dialog.dismiss()))
        page.on("request", lambda request: request.url.startswith(("file:", "data:")) or wrong.append(request.url))
        page.goto((attacked / "report.html").as_uri())
        return page, wrong

    yield open_
    for context in contexts:
        context.close()


def seconds(page):
    return float(page.inner_text("#clock").split(" s of")[0])


def until(page, condition):
    """Wait for a condition; the page's policy forbids the eval that playwright's own waiting uses."""
    for _ in range(200):
        if condition():
            return
        page.wait_for_timeout(50)
    raise AssertionError("it never came to be")


def picture(page):
    return page.evaluate("document.getElementById('stage').toDataURL()")


@pytest.mark.parametrize("screen", SCREENS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_opens_without_an_error_and_fits_the_screen(screen, scheme, open_page):
    page, wrong = open_page(screen, scheme)
    assert page.evaluate("document.documentElement.scrollWidth") <= SCREENS[screen]["width"]
    keep = os.environ.get("GAINCERT_SCREENSHOTS")
    if keep:
        Path(keep).mkdir(parents=True, exist_ok=True)
        page.screenshot(path=Path(keep) / f"{screen}-{scheme}.png", full_page=True)
    assert wrong == []


def test_it_plays_pauses_and_scrubs(open_page):
    page, wrong = open_page()
    begin = picture(page)
    page.click("#play")
    until(page, lambda: seconds(page) > 0.2)
    page.click("#play")
    now = seconds(page)
    page.wait_for_timeout(200)
    assert seconds(page) == now
    assert picture(page) != begin
    page.fill("#scrub", "15")
    assert seconds(page) == 15
    page.fill("#scrub", "0")
    assert picture(page) == begin
    for box in ("trails", "links", "headings", "names"):
        page.fill("#scrub", "15")
        before = picture(page)
        page.uncheck(f"#{box}")
        assert picture(page) != before, box
    page.select_option("#view", "fleet")
    assert wrong == []


def test_it_stops_at_the_end_and_begins_again(open_page):
    page, wrong = open_page()
    page.fill("#scrub", "29.9")
    page.select_option("#speed", "10")
    page.click("#play")
    until(page, lambda: page.inner_text("#play") == "Play")
    assert seconds(page) == 30
    page.click("#play")
    until(page, lambda: seconds(page) < 29)
    assert wrong == []


def test_the_keyboard_suffices(open_page):
    page, wrong = open_page()
    page.focus("#player")
    page.keyboard.press("End")
    assert seconds(page) == 30
    page.keyboard.press("ArrowLeft")
    assert seconds(page) == pytest.approx(29.7)
    page.keyboard.press("Home")
    assert seconds(page) == 0
    page.keyboard.press("Space")
    until(page, lambda: seconds(page) > 0.1)
    page.keyboard.press("Space")
    assert page.inner_text("#play") == "Play"
    speed = float(page.input_value("#speed"))
    page.keyboard.press("+")
    assert float(page.input_value("#speed")) > speed
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.id") == "play"
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.id") == "scrub"
    page.keyboard.press("End")
    assert seconds(page) == 30
    assert wrong == []


def test_torque_bars_are_shares_of_the_limit(open_page):
    page, _ = open_page()
    shares = page.eval_on_selector_all(".torque .value", "all => all.map(one => parseFloat(one.textContent))")
    assert len(shares) == 6
    assert all(0 <= share <= 100 for share in shares)
    page.uncheck("#logarithmic")
    widths = page.eval_on_selector_all(
        ".torque",
        "all => all.map(row => Math.max(...[...row.querySelectorAll('i')].map(bar => parseFloat(bar.style.width))))",
    )
    assert widths == pytest.approx(shares, abs=0.02)


def test_names_stay_text(open_page):
    page, wrong = open_page()
    assert page.eval_on_selector_all(".torque .name", "all => all.map(one => one.textContent)") == list(ATTACKS)
    assert page.eval_on_selector_all("#gains tbody th", "all => all.map(one => one.textContent)") == list(ATTACKS)
    assert page.inner_text("h1") == "<h1>title</h1>"
    assert page.evaluate("document.querySelectorAll('img[src=x], main script').length") == 0
    assert wrong == []


def test_an_injected_script_would_not_run(open_page):
    page, wrong = open_page()
    page.evaluate(
        "document.body.append(Object.assign(document.createElement('script'), {textContent: 'window.bad = 1'}))"
    )
    assert page.evaluate("window.bad") is None
    assert "Content Security Policy" in wrong[0]


def test_formulas_are_typeset(open_page):
    page, _ = open_page()
    assert page.evaluate("document.querySelectorAll('.pair math').length") >= 1
    assert page.evaluate("document.querySelector('.pair math').namespaceURI").endswith("MathML")


def test_printing_opens_what_is_folded(open_page, tmp_path):
    page, wrong = open_page(scheme="dark")
    assert page.evaluate("document.querySelectorAll('details:not([open])').length") > 0
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.evaluate("document.querySelectorAll('details:not([open])').length") == 0
    page.pdf(path=tmp_path / "report.pdf", format="A4")
    assert (tmp_path / "report.pdf").stat().st_size > 50_000
    assert wrong == []
