"""The page in a browser: chromium, which Debian's package of that name installs."""

import shutil

import isoshell
import numpy as np
import pytest

pytest.importorskip("k3d", reason="a report needs k3d: pip install 'isoshell[report]'")
playwright = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
if not CHROMIUM:
    pytest.skip("there is no chromium: apt install chromium", allow_module_level=True)

pytestmark = pytest.mark.filterwarnings("ignore::isoshell.RunWarning")
TIMEOUT_MS = 600_000  # that only a page that hangs reaches
DRAWS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"]
DOES_NOT_DRAW = ["--disable-gpu", "--disable-3d-apis", "--no-sandbox"]


@pytest.fixture(scope="module")
def page_file(tmp_path_factory, ball):
    """Of a ball with a hole."""
    vertices, faces = ball
    source = vertices, faces[vertices[faces][:, :, 2].max(axis=1) < 0.95]
    path = tmp_path_factory.mktemp("report") / "holed.html"
    isoshell.report(isoshell.remesh(source, stats=True, vertices=150, resolution=32), path, source=source)
    return path


@pytest.fixture(scope="module")
def browsers():
    with playwright.sync_playwright() as started:
        open_ones = {}

        def browser(arguments):
            key = tuple(arguments)
            if key not in open_ones:
                open_ones[key] = started.chromium.launch(executable_path=CHROMIUM, args=arguments)
            return open_ones[key]

        yield browser
        for one in open_ones.values():
            one.close()


class Opened:
    """The page, with all that it tells and asks for."""

    def __init__(self, browser, path, **settings):
        self.errors, self.asked = [], []
        self.page = browser.new_context(**{"viewport": {"width": 900, "height": 900}, **settings}).new_page()
        self.page.set_default_timeout(TIMEOUT_MS)
        self.page.on("console", lambda message: self.errors.append(message.text) if message.type == "error" else None)
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.route("**/*", self.answer)
        self.page.goto(path.as_uri())

    def answer(self, route):
        self.asked.append(route.request.url)
        route.continue_() if len(self.asked) == 1 else route.abort()

    def wait_until_drawn(self):
        self.page.wait_for_selector("body[data-drawn=yes]", timeout=TIMEOUT_MS)
        return self

    def cameras(self):
        return np.array(self.page.evaluate(
            "isoshellReport.views.map((view) => view.plot.getWorld().controls.getCameraArray())"))

    def picture(self, side):
        """Different colours of the canvas."""
        self.page.wait_for_timeout(300)
        return self.page.evaluate(
            """(side) => {
              const canvas = document.querySelector(`#${side} canvas`), copy = document.createElement('canvas');
              copy.width = copy.height = 64;
              copy.getContext('2d').drawImage(canvas, 0, 0, 64, 64);
              return Array.from(copy.getContext('2d').getImageData(0, 0, 64, 64).data);
            }""", side)


@pytest.fixture(scope="module")
def opened(browsers, page_file):
    return Opened(browsers(DRAWS), page_file).wait_until_drawn()


def test_both_surfaces_are_drawn_in_every_colouring(opened):
    seen = set()
    modes = ["shape", "deviation", "quality", "valence", "gaps", "creases"]  # the rim of the cap is one
    assert opened.page.locator("label:has(input[name=mode]):visible").count() == len(modes)
    rounds = 100  # of which a machine that draws at once needs one
    while rounds and len(seen) <= len(modes):
        rounds -= 1
        look_at(opened, modes, seen)
    assert len(seen) > len(modes)


def look_at(opened, modes, seen):
    for mode in modes:
        opened.page.locator(f"label:has(input[value={mode}])").click()
        for side in ("before", "after"):
            seen.add((side, tuple(becomes(opened, lambda picture: len(colors_in(picture)) > 20, side))))
        assert (opened.page.locator("#legend").inner_text() != "") == (mode != "shape")


def test_both_panes_have_one_camera(opened):
    opened.page.locator("#reset").click()
    first = opened.cameras()
    assert np.allclose(first[0], first[1])
    box = opened.page.locator("#before canvas").bounding_box()
    opened.page.mouse.move(box["x"] + 100, box["y"] + 100)
    opened.page.mouse.down()
    opened.page.mouse.move(box["x"] + 200, box["y"] + 130, steps=4)
    opened.page.mouse.up()
    turned = opened.cameras()
    assert np.allclose(turned[0], turned[1]) and not np.allclose(turned[0], first[0])


def test_a_click_moves_the_cameras_to_the_place(opened):
    opened.page.locator("#reset").click()
    wide = opened.cameras()[0]
    button = opened.page.locator("[data-place='0']")
    button.click()
    near = opened.cameras()
    place = opened.page.evaluate("JSON.parse(document.getElementById('data').textContent).places[0]")
    assert np.allclose(near[:, 3:6], place["at"])
    assert np.linalg.norm(near[0, :3] - near[0, 3:6]) < np.linalg.norm(wide[:3] - wide[3:6])
    assert np.dot(near[0, :3] - near[0, 3:6], place["from"]) > 0  # from outside
    assert button.get_attribute("aria-pressed") == "true"


def test_no_request_leaves_the_page_and_nothing_goes_wrong(opened, page_file):
    assert opened.asked == [page_file.as_uri()]
    assert opened.errors == []


def test_in_the_dark_it_is_dark(browsers, page_file):
    dark = Opened(browsers(DRAWS), page_file, color_scheme="dark").wait_until_drawn()
    becomes(dark, lambda picture: picture[:3] < [60, 60, 60])
    assert dark.page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(20, 23, 26)"
    assert dark.errors == []


@pytest.mark.parametrize("settings", [{}, {"java_script_enabled": False}])
def test_without_webgl_or_scripts_the_numbers_remain(browsers, page_file, settings):
    plain = Opened(browsers(DOES_NOT_DRAW), page_file, **settings)
    assert plain.page.locator("#unseen").is_visible() and not plain.page.locator("#look").is_visible()
    assert plain.page.locator("svg").count() == 4 and "Closed 2-manifold" in plain.page.inner_text("body")
    assert plain.errors == [] and len(plain.asked) == 1


@pytest.fixture(scope="module")
def page_of_regions(tmp_path_factory):
    """Of three layers; the middle one has a name with marks in it."""
    layers = np.zeros((12, 12, 12), np.uint8)
    layers[1:11, 1:11, 1:4], layers[1:11, 1:11, 4:8], layers[1:11, 1:11, 8:11] = 1, 2, 7
    labels = isoshell.Labels(layers, names={2: "<b>bone & skin</b>"})
    path = tmp_path_factory.mktemp("report") / "layers.html"
    isoshell.report(isoshell.remesh(labels, vertices=500), path, source=labels)
    return path


@pytest.fixture(scope="module")
def page_of_ball(tmp_path_factory, ball):
    path = tmp_path_factory.mktemp("report") / "ball.html"
    isoshell.report(isoshell.remesh(ball, stats=True, vertices=150, resolution=32), path, source=ball)
    return path


@pytest.fixture(scope="module")
def page_of_part(tmp_path_factory):
    """Of a cube, which has creases; with requirements, whose names have hyphens."""
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    sides = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    path = tmp_path_factory.mktemp("report") / "part.html"
    result = isoshell.remesh((corners, sides), vertices=200, resolution=32, stats=True,
                             require="closed,manifold,no-self-intersections,min-angle=20,max-deviation=0.1,genus=0")
    isoshell.report(result, path, source=(corners, sides))
    return path


PHONE = {"width": 390, "height": 844}
CUT = """() => {
  const cut = [];
  for (const row of document.querySelectorAll('.choice')) {
    const outer = row.getBoundingClientRect();
    for (const label of row.querySelectorAll('label:not([hidden])')) {
      const inner = label.getBoundingClientRect();
      if (inner.left < outer.left || inner.right > Math.min(outer.right, innerWidth)) cut.push(label.innerText);
    }
  }
  return cut;
}"""


@pytest.mark.parametrize("page, modes", [("page_of_ball", 4), ("page_file", 6), ("page_of_part", 5), ("page_of_regions", 6)])
def test_on_a_phone_nothing_is_cut_and_no_name_is_broken(browsers, request, page, modes):
    phone = Opened(browsers(DRAWS), request.getfixturevalue(page), viewport=PHONE).wait_until_drawn()
    assert phone.page.locator("label:has(input[name=mode]):visible").count() == modes
    assert phone.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert phone.page.evaluate(CUT) == []
    lines = "Array.from(document.querySelectorAll('.choice label:not([hidden]) span, .name'), (e) => [e.innerText, %s])"
    heights = {words: height for words, height in phone.page.evaluate(lines % "e.clientHeight") if height}
    assert len(set(heights.values())) == 1, heights
    broken = [words for words, count in phone.page.evaluate(lines % "e.getClientRects().length") if count > 1]
    assert broken == []
    assert (page == "page_of_part") == ("no-self-intersections" in phone.page.locator(".name").all_inner_texts())


def hues_in(picture):
    """Different colours that are no grey."""
    return {tuple(color[:3]) for color in np.array(picture).reshape(-1, 4).tolist() if max(color[:3]) - min(color[:3]) > 40}


def colors_in(picture):
    return {tuple(color) for color in np.array(picture).reshape(-1, 4).tolist()}


def becomes(opened, fits, side="after"):
    """The picture of the result, or of the input, once it is as it should be: drawing takes a while."""
    for _ in range(TIMEOUT_MS // 300):
        picture = opened.picture(side)
        if fits(picture):
            return picture
    raise AssertionError("the picture did not become what it should be")


def test_regions_have_colours_hide_by_a_click_and_are_pulled_apart(browsers, page_of_regions):
    opened = Opened(browsers(DRAWS), page_of_regions).wait_until_drawn()
    buttons = opened.page.locator("[data-region]")
    assert buttons.all_inner_texts() == ["1", "<b>bone & skin</b> (2)", "7"]
    words = opened.page.inner_text("body")
    assert "3 regions, each is closed" in words and "Edges of three faces or more in the input" not in words
    becomes(opened, hues_in, "before")
    together = becomes(opened, hues_in)
    opened.page.locator("#apart").fill("60")
    becomes(opened, lambda picture: picture != together)
    opened.page.locator("#apart").fill("0")
    becomes(opened, lambda picture: picture == together)
    buttons.nth(1).click()
    assert buttons.nth(1).get_attribute("aria-pressed") == "false"
    becomes(opened, lambda picture: picture != together)
    for number in (0, 2):
        buttons.nth(number).click()
    becomes(opened, lambda picture: not hues_in(picture))
    for number in range(3):
        buttons.nth(number).click()
    becomes(opened, lambda picture: picture == together)
    opened.page.locator("label:has(input[value=quality])").click()
    assert not opened.page.locator("#pull").is_visible() and buttons.count() == 0
    assert opened.errors == [] and len(opened.asked) == 1


def test_a_page_without_regions_offers_none(opened):
    assert not opened.page.locator("#pull").is_visible() and opened.page.locator("input[value=regions]").count() == 0
