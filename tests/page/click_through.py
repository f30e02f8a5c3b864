"""Clicks through the page of results in a headless browser and compares what it shows with the tables.

    python3 tests/page/click_through.py OPENCLOSE [--keep FOLDER]      (needs chromium, chromium-driver and python3-selenium; make verify-page installs them)

--keep writes pages and screenshots into a folder, to be looked at.
"""

import argparse
import csv
import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.support.ui import Select

# The page shows six digits.
DIGITS = 1e-5
# Pictures a second that a film of 10,000 blocks has to reach.
FRAMES_PER_S = 30
SECONDS_MEASURED = 1.2
ATTEMPTS = 6

# Motions have seven digits in the page, here of some metres.
PLACES_DIFFER_M = 1e-5
# The page shows places with ten digits.
SHOWN_PLACES_DIFFER_M = 1e-3
# Contacts of which the next one is nearer lie at the crossing of joints, where a click cannot mean one alone.
ALONE_M = 1e-3
# Within which a click means a contact.
REACH_PX = 7

SLOPE = """
title = "Slope <b>with</b> </script> two sets"
[[material]]
name = "rock"
density_kg_per_m3 = 2600
[[joint]]
materials = ["rock", "rock"]
normal_stiffness_pa_per_m = 1e10
shear_stiffness_pa_per_m = 2e9
friction_angle_deg = 35
cohesion_pa = 20e3
[domain]
material = "rock"
vertices_m = [[499970, 3999980], [500110, 3999980], [500110, 4000060], [500035, 4000060], [500000, 4000000], [499970, 4000000]]
[[joint_set]]
dip_deg = 25
spacing_m = 8
origin_m = [500000, 4000003]
[[joint_set]]
dip_deg = -65
spacing_m = 10
origin_m = [500000, 4000000]
[[fixed_line]]
from_m = [499970, 3999980]
to_m = [500110, 3999980]
[[fixed_line]]
from_m = [500110, 3999980]
to_m = [500110, 4000060]
[step]
dt_s = 5e-3
[end]
time_s = 1
[output]
snapshots_every_s = 0.1
"""


def wall(courses: int) -> str:
    """Bricks of which the upper half is thrown aside."""
    length, height = 0.4, 0.2
    blocks = []
    for row in range(courses):
        for column in range(courses):
            x, y = column * length + (length / 2 if row % 2 else 0), row * height
            corners = f"[[{x:g}, {y:g}], [{x + length:g}, {y:g}], [{x + length:g}, {y + height:g}], [{x:g}, {y + height:g}]]"
            thrown = f"velocity_m_per_s = [{0.5 + 0.02 * row:g}, 0]\n" if row > courses // 2 else ""
            blocks.append(f'[[block]]\nname = "c{row}_{column}"\nmaterial = "brick"\nvertices_m = {corners}\n{thrown}')
    end = courses * length + 5
    return f"""
title = "Wall of bricks"
[[material]]
name = "brick"
density_kg_per_m3 = 2000
[[joint]]
materials = ["brick", "brick"]
normal_stiffness_pa_per_m = 1e9
shear_stiffness_pa_per_m = 4e8
friction_angle_deg = 30
[[block]]
name = "base"
material = "brick"
fixed = true
vertices_m = [[-5, -1], [{end}, -1], [{end}, 0], [-5, 0]]
[method]
contact = "dem"
start = "unloaded"
[step]
dt_s = 1e-3
[end]
time_s = 0.05
[output]
snapshots_every_s = 2e-3
every_s = 0.01
[[measured_point]]
name = "corner"
block = "c0_0"
point_m = [0, 0]
""" + "\n".join(blocks)


def require(holds: bool, what: str) -> None:
    if not holds:
        sys.exit(f"click_through: {what}")


def rows_of(path: Path, **where: str) -> list[dict[str, str]]:
    with open(path, newline="", encoding="utf-8") as stream:
        return [row for row in csv.DictReader(stream) if all(row[key] == value for key, value in where.items())]


def same(shown: str, expected: float, scale: float = 0.0) -> bool:
    """To the digits that are shown; what is tiny against a scale may be off by its rounding."""
    return shown != "" and abs(float(shown) - expected) <= DIGITS * max(abs(expected), scale) + 1e-300


def same_place(shown: str, expected: float) -> bool:
    """The origin of the scene is a million metres away: digits alone would say nothing."""
    return shown != "" and abs(float(shown) - expected) <= SHOWN_PLACES_DIFFER_M


class Page:
    """A page of results in the browser, used as a person would."""

    def __init__(self, browser: webdriver.Chrome, path: Path) -> None:
        self.browser = browser
        browser.get(path.as_uri())
        self.canvas = browser.find_element(By.ID, "view")
        self.require_quiet()

    def require_quiet(self) -> None:
        faults = [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"]
        require(not faults, f"the browser reports: {faults}")

    def ask(self, script: str, *arguments: object) -> object:
        return self.browser.execute_script("return " + script, *arguments)

    def text(self, element: str) -> str:
        return self.browser.find_element(By.ID, element).text

    def settle(self) -> None:
        """Until what was asked for is drawn."""
        self.browser.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")

    def click(self, x: float, y: float) -> dict[str, str]:
        """A real click at these pixels of the canvas; what the page shows then."""
        width, height = self.canvas.size["width"], self.canvas.size["height"]
        ActionChains(self.browser).move_to_element_with_offset(self.canvas, round(x - width / 2), round(y - height / 2)).click().perform()
        self.settle()
        return dict(self.ask("Object.fromEntries([...document.querySelectorAll('#values-table tr')].map((row) => [row.dataset.key, row.cells[1].textContent]))"))

    def wheel(self, x: float, y: float, by: int) -> None:
        width, height = self.canvas.size["width"], self.canvas.size["height"]
        origin = ScrollOrigin.from_element(self.canvas, round(x - width / 2), round(y - height / 2))
        ActionChains(self.browser).scroll_from_origin(origin, 0, by).perform()
        self.settle()

    def choose_state(self, name: str) -> None:
        names = list(self.ask("openclose.results.states.map((state) => state.name)"))
        Select(self.browser.find_element(By.ID, "state-name")).select_by_index(names.index(name))
        self.settle()

    def place(self, x: float, y: float) -> list[float]:
        """Pixels of a place [m]."""
        return list(self.ask("openclose.view.toScreen(arguments[0] - openclose.results.data.origin[0], arguments[1] - openclose.results.data.origin[1])", x, y))

    def pixel(self, x: float, y: float) -> list[int]:
        return list(self.ask("[...openclose.view.context.getImageData(arguments[0] * openclose.view.ratio, arguments[1] * openclose.view.ratio, 1, 1).data]", x, y))


def colour_of(text: str) -> list[int]:
    return [int(text[i:i + 2], 16) for i in (1, 3, 5)]


def check_blocks(page: Page, results: Path, state: str) -> int:
    """Clicks the middles of blocks; every number shown is that of the table."""
    compared = 0
    motions = rows_of(results / "block_states.csv", state=state)
    farthest = max(math.hypot(float(r["displacement_x_m"]), float(r["displacement_y_m"])) for r in motions)
    for row in motions[:: max(1, len(motions) // 8)]:
        shown = page.click(*page.place(float(row["x_m"]), float(row["y_m"])))
        if "block" not in shown:
            continue  # a contact lies there
        require(shown["block"] == row["block"], f"{state}: a click on {row['block']} shows {shown['block']}")
        for key in row:
            if key in ("state", "time_s", "block") or row[key] == "":
                continue
            scale = farthest if key.startswith("displacement") else 0.0
            is_same = same_place(shown[key], float(row[key])) if key in ("x_m", "y_m") else same(shown[key], float(row[key]), scale)
            require(is_same, f"{state}: {key} of {row['block']} is {row[key]} and shown as {shown[key]}")
            compared += 1
        properties = rows_of(results / "block_properties.csv", block=row["block"])[0]
        require(same(shown["area_m2"], float(properties["area_m2"])), f"area of {row['block']}")
        require(same(shown["mass_kg"], float(properties["mass_kg"])), f"mass of {row['block']}")
    return compared


def check_places(page: Page, results: Path, state: str) -> None:
    """Every vertex is drawn where the table has it."""
    rows = rows_of(results / "blocks.csv", state=state)
    origin = page.ask("openclose.results.data.origin")
    drawn = list(page.ask("[...openclose.view.places]"))
    require(len(drawn) == 2 * len(rows), f"{state}: {len(drawn) / 2} vertices are drawn of {len(rows)}")
    off = max(math.hypot(drawn[2 * i] + origin[0] - float(row["x_m"]), drawn[2 * i + 1] + origin[1] - float(row["y_m"])) for i, row in enumerate(rows))
    require(off < PLACES_DIFFER_M, f"{state}: a vertex is drawn {off:.3g} m from where it is")


def nearest_other(rows: list[dict[str, str]], row: dict[str, str]) -> float:
    """[m] From the place of a contact to that of the next one."""
    x, y = float(row["x_m"]), float(row["y_m"])
    return min(math.hypot(float(other["x_m"]) - x, float(other["y_m"]) - y) for other in rows if other is not row)


def check_contacts(page: Page, results: Path, state: str) -> int:
    """Zooms in with the wheel on contacts until they lie alone, and clicks them."""
    rows = rows_of(results / "contacts.csv", state=state)
    alone = [row for row in rows if nearest_other(rows, row) > ALONE_M]
    compared = 0
    for row in alone[:: max(1, len(alone) // 6)]:
        x, y = float(row["x_m"]), float(row["y_m"])
        page.browser.find_element(By.ID, "fit").click()
        page.settle()
        at = page.place(x, y)
        for turn in range(30):
            before = float(page.ask("openclose.view.scale"))
            if before * nearest_other(rows, row) > 2 * REACH_PX and turn > 0:
                break
            page.wheel(*at, -400)
            require(float(page.ask("openclose.view.scale")) > 1.5 * before, "the wheel does not zoom")
            now = page.place(x, y)
            # The pointer is at whole pixels.
            require(math.hypot(now[0] - at[0], now[1] - at[1]) < 2, "the place below the pointer does not stay there")
            at = now
        shown = page.click(*at)
        require("contact" in shown, f"{state}: a click on the contact of {row['block_a']} and {row['block_b']} shows {shown}")
        require(shown["contact"] == f"corner of {row['block_a']} on {row['block_b']}", f"{state}: another contact: {shown['contact']}")
        require(shown["status"] == row["status"], f"{state}: status {shown['status']} for {row['status']}")
        for key in ("normal_force_n", "shear_force_n", "gap_m", "length_m", "x_m", "y_m"):
            is_same = same_place(shown[key], float(row[key])) if key in ("x_m", "y_m") else same(shown[key], float(row[key]))
            require(is_same, f"{state}: {key} is {row[key]} and shown as {shown[key]}")
            compared += 1
    page.browser.find_element(By.ID, "fit").click()
    page.settle()
    return compared


def check_player(page: Page, results: Path) -> None:
    """Slider, keys, a drag, and a film to its end."""
    names = list(page.ask("openclose.results.states.map((state) => state.name)"))
    times = {row["state"] for row in rows_of(results / "block_states.csv")}
    require({"initial"} | times - {"final"} <= set(names), f"states are missing: {times - set(names)}")
    slider = page.browser.find_element(By.ID, "state")
    slider.send_keys(Keys.HOME)
    require(page.ask("openclose.view.state") == 0, "the slider does not go to the drawing")
    slider.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
    require(page.ask("openclose.view.state") == 2, "the slider does not step")
    before = page.ask("[openclose.view.x, openclose.view.y, openclose.view.scale]")
    ActionChains(page.browser).drag_and_drop_by_offset(page.canvas, 60, 30).perform()
    page.settle()
    after = page.ask("[openclose.view.x, openclose.view.y, openclose.view.scale]")
    require(abs((before[0] - after[0]) * after[2] - 60) < 1 and abs((after[1] - before[1]) * after[2] - 30) < 1, "dragging does not move the picture")
    page.canvas.send_keys(Keys.HOME)
    page.browser.find_element(By.ID, "play").click()
    for _ in range(100):
        time.sleep(0.1)
        if page.text("play") == "play":
            break
    require(page.ask("openclose.view.state") == len(names) - 1, "the film does not come to its end")


def check_run(browser: webdriver.Chrome, results: Path, path: Path) -> str:
    page = Page(browser, path)
    summary = json.loads((results / "summary.json").read_text())
    require(page.text("title") == summary["title"], "the title is not the scene's")
    require("run to t = 1 s" in page.text("answer"), "the answer is missing")
    require(page.ask("performance.getEntriesByType('resource').length") == 0, "the page asks for other files")
    watch = page.text("trust-table")
    require(f"{summary['watch']['checks']}" in watch, "the watch is not shown")
    numbers = 0
    for state in ("t=0.5", "t=1"):
        page.choose_state(state)
        check_places(page, results, state)
        numbers += check_blocks(page, results, state)
    contacts = check_contacts(page, results, "t=1")
    require(numbers >= 60 and contacts >= 12, f"only {numbers} numbers of blocks and {contacts} of contacts were compared")
    check_player(page, results)
    fixed = next(row["block"] for row in rows_of(results / "block_properties.csv", fixed="1") if float(row["area_m2"]) > 10)
    at = rows_of(results / "block_states.csv", state="t=1", block=fixed)[0]
    page.browser.find_element(By.ID, "fit").click()
    page.settle()
    colour = colour_of(str(page.ask("openclose.results.data.colours.fixed")))
    require(page.pixel(*page.place(float(at["x_m"]), float(at["y_m"])))[:3] == colour, "a fixed block has not its colour")
    check_curves(page, results)
    page.require_quiet()
    return f"{numbers} numbers of blocks, {contacts} of contacts"


def check_curves(page: Page, results: Path) -> None:
    """A click on a curve takes the player to that time; the curves are those of the tables."""
    charts = page.browser.find_elements(By.CSS_SELECTOR, ".picture canvas")
    titles = [element.text for element in page.browser.find_elements(By.CSS_SELECTOR, ".picture h2")]
    require("Measured points" in titles and "Energy ledger" in titles, f"pictures: {titles}")
    page.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", charts[0])
    ActionChains(page.browser).move_to_element(charts[0]).click().perform()
    page.settle()
    state = str(page.ask("openclose.results.states[openclose.view.state].name"))
    require(state in ("t=0.5", "t=0.4", "t=0.6"), f"a click in the middle of the curves goes to {state}")
    energy = rows_of(results / "energy.csv")
    for column in ("kinetic_j", "friction_j", "imbalance_j"):
        shown = list(page.ask("[...columnsOf(openclose.results.data.energy, openclose.results.data.energy.curves[0])[arguments[0]]]", column))
        require(len(shown) == len(energy) and all(abs(a - float(b[column])) <= 1e-6 * abs(float(b[column])) for a, b in zip(shown, energy)), f"the curve of {column}")


def check_labels(page: Page) -> None:
    """The labels of the bracket lie over no point of the curve and over no other label."""
    labels, points = page.ask(
        "[document.querySelector('.picture canvas').chart].map((chart) => [chart.labels, chart.series[0].x.map((x, i) => [chart.atX(x), chart.atY(chart.series[0].y[i])])])[0]"
    )
    require(len(labels) == 3 and labels[0]["text"].startswith("stable "), f"labels of the bracket: {labels}")
    for k, label in enumerate(labels):
        inside = [point for point in points if label["left"] <= point[0] <= label["right"] and label["top"] <= point[1] <= label["bottom"]]
        require(not inside, f"{label['text']} covers points at {inside}")
        for other in labels[:k]:
            apart = label["right"] <= other["left"] or other["right"] <= label["left"] or label["bottom"] <= other["top"] or other["bottom"] <= label["top"]
            require(apart, f"{label['text']} lies over {other['text']}")


def check_factor(browser: webdriver.Chrome, results: Path, path: Path) -> str:
    page = Page(browser, path)
    summary = json.loads((results / "summary.json").read_text())
    require(f"factor of safety {summary['factor_of_safety']:.6g}" in page.text("answer"), f"the answer is {page.text('answer')}")
    trust = page.text("trust-table")
    for number in (summary["bracket"]["stable"], summary["bracket"]["failed"], summary["limit_analysis"]["factor"]):
        require(f"{number:.6g}" in trust, f"{number:.6g} is not among what the answer rests on")
    shown = [element.text for element in page.browser.find_elements(By.CSS_SELECTOR, "#warnings li")]
    require(shown == summary["warnings"], "the warnings are not those of the summary")
    trials = rows_of(results / "trials.csv")
    cells = list(page.ask("[...document.querySelectorAll('#trials-table tr')].slice(1).map((row) => [...row.cells].map((cell) => cell.textContent))"))
    require(len(cells) == len(trials), f"{len(cells)} trials are shown of {len(trials)}")
    words = {"1": "stable", "0": "failed", "undecided": "undecided"}
    for cell, row in zip(cells, trials):
        require(same(cell[0], float(row["srf"])) and cell[1] == words[row["stable"]] and same(cell[5], float(row["displacement_m"]), 1e-9), f"trial {row}")
    check_labels(page)
    moving = 0
    page.choose_state("failed")
    check_places(page, results, "failed")
    for row in rows_of(results / "mechanism.csv")[::4]:
        motion = rows_of(results / "block_states.csv", state="failed", block=row["block"])[0]
        values = page.click(*page.place(float(motion["x_m"]), float(motion["y_m"])))
        require(values.get("block") == row["block"], f"a click on {row['block']} of the mechanism shows {values}")
        for key in ("velocity_x", "velocity_y", "rotation_per_m"):
            require(same(values[key], float(row[key]), 0.01), f"{key} of {row['block']} is {row[key]} and shown as {values[key]}")
            moving += 1
    amplitude = page.browser.find_element(By.ID, "amplitude")
    amplitude.send_keys(Keys.HOME)
    page.settle()
    drawn = page.ask("Math.max(...openclose.view.places.map((place, k) => Math.abs(place - openclose.results.vertices[k])))")
    require(drawn == 0, "at amplitude 0 the mechanism is not the drawing")
    page.choose_state("stable")
    # It has no velocities to be coloured by: the colours are those of the materials then.
    free = next(row["block"] for row in rows_of(results / "block_properties.csv", fixed="0") if float(row["area_m2"]) > 10)
    at = rows_of(results / "block_states.csv", state="stable", block=free)[0]
    require(page.pixel(*page.place(float(at["x_m"]), float(at["y_m"])))[:3] == colour_of(str(page.ask("openclose.results.data.colours.fills[0]"))), "colours without velocities")
    contacts = check_contacts(page, results, "stable")
    require(moving >= 9 and contacts >= 12, f"only {moving} numbers of the mechanism and {contacts} of contacts were compared")
    page.require_quiet()
    return f"{len(trials)} trials, {moving} numbers of the mechanism, {contacts} of contacts"


def check_speed(browser: webdriver.Chrome, path: Path) -> str:
    """Pictures a second while a film plays with its default layers; every picture is drawn anew. The best of some attempts, as other work goes on beside."""
    page = Page(browser, path)
    blocks = page.ask("openclose.results.count")
    require(blocks >= 10000, f"only {blocks} blocks")
    page.browser.execute_script(
        "const {view, player} = openclose, draw = () => { view.request(); requestAnimationFrame(draw); }; player.speed = 20; draw();")
    best, each = 0.0, 0.0
    for _ in range(ATTEMPTS):
        page.browser.execute_script(
            "const {view, player} = openclose; player.stop(); player.go(0); player.toggle();"
            "window.begin = [performance.now(), view.pictures, view.drawingTime];")
        time.sleep(SECONDS_MEASURED)
        elapsed, pictures, drawing = page.ask(
            "[performance.now() - begin[0], openclose.view.pictures - begin[1], openclose.view.drawingTime - begin[2]]")
        if 1000 * pictures / elapsed > best:
            best, each = 1000 * pictures / elapsed, drawing / pictures
        if best >= FRAMES_PER_S:
            break
    require(best >= FRAMES_PER_S, f"{best:.1f} pictures a second of {blocks} blocks, {each:.1f} ms each; {FRAMES_PER_S} are wanted")
    page.require_quiet()
    return f"{blocks} blocks at {best:.0f} pictures a second ({each:.1f} ms each)"


def start_browser() -> webdriver.Chrome:
    options = Options()
    # No sandbox: it cannot be had as root, nor in most containers; the page is our own.
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1500,1100", "--force-device-scale-factor=1"):
        options.add_argument(argument)
    options.binary_location = "/usr/bin/chromium"
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("openclose", type=Path)
    parser.add_argument("--keep", type=Path)
    arguments = parser.parse_args()
    openclose = arguments.openclose.resolve()
    with tempfile.TemporaryDirectory() as place:
        folder = arguments.keep.resolve() if arguments.keep else Path(place)
        folder.mkdir(parents=True, exist_ok=True)
        browser = start_browser()
        try:
            for name, scene, command, check in (("run", SLOPE, "run", check_run), ("fos", SLOPE, "fos", check_factor), ("wall", wall(100), "run", None)):
                (folder / f"{name}.toml").write_text(scene, encoding="utf-8")
                subprocess.run([openclose, command, f"{name}.toml", "-o", name, "-q"], cwd=folder, check=True, stderr=subprocess.DEVNULL)
                subprocess.run([openclose, "report", name, "-o", f"{name}.html", "-q"], cwd=folder, check=True)
                page = folder / f"{name}.html"
                said = check(browser, folder / name, page) if check else check_speed(browser, page)
                if arguments.keep:
                    browser.execute_script("window.scrollTo(0, 0)")
                    browser.save_screenshot(str(folder / f"{name}.png"))
                print(f"page of {name}: {said}")
        finally:
            browser.quit()


if __name__ == "__main__":
    main()
