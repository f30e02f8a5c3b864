"""Commands as a person would give them: what is printed, drawn, written and said of files that are wrong."""

import re
import sys
from pathlib import Path

from case import Case
from openclose_scripts import ROOT
from scenes import HILL, INTEGRATORS, METHODS, YARD, closely_jointed_slope, landing, leaning_columns, shaken_late, wall_with_points

sys.path.insert(0, str(ROOT / "stress"))

import masonry  # noqa: E402
import maps  # noqa: E402
import slopes  # noqa: E402
import tumbles  # noqa: E402
from scene import to_toml  # noqa: E402

COMMANDS = ("run", "fos", "cut", "check", "draw", "new", "study", "sweep", "report", "explain", "completion", "manual")
SHAKEN, INCLINE = "verification/scenes/shaken_block.toml", "paper/scenes/example_3_1.toml"
FAILING, SLOPE = "paper/scenes/example_3_4_post_failure.toml", "paper/scenes/example_3_4.toml"
TOE, COLUMNS = "paper/scenes/example_3_3_toe.toml", "paper/scenes/example_3_2.toml"
# Seeds that stay, so that the scenes are small; and how long they move.
SEEDS, END = range(3000, 3004), "0.3"
KINDS = {
    "slope": ["--height-m=12", "--face-angle-deg=90", "--bedding-dip-deg=35", "--bedding-spacing-m=2"],
    "wall": ["--courses=5", "--bricks=4", "--doors=1", "--door-bricks=1", "--door-courses=2", "--sill-courses=1", "--tilt-deg=7"],
    "arch": ["--voussoirs=12", "--thickness-m=0.3"],
}


def settings(*assignments: str) -> list[str]:
    return [word for assignment in assignments for word in ("--set", assignment)]


THETA = {"theta": settings("method.theta=0.5")}
ALL_BITS = settings("output.checkpoint_every_s=1e6")  # a checkpoint at the end


def texts() -> list[Case]:
    helps = Case("help of all commands", [["--help"], ["--version"], [], *([name, "--help"] for name in COMMANDS)])
    manuals = Case("manual pages", [["manual"], *(["manual", name] for name in COMMANDS)])
    shells = Case("completions", [["completion", shell] for shell in ("bash", "zsh", "fish", "tcsh")])
    keys = Case("tables of keys", [["explain", "--page"], ["explain", "--schema"], ["explain"]])
    words = Case("explained keys", [["explain", word] for word in ("theta", "joint.friction_angle_deg", "method", "frictoin", "dt", "vertices_m", "", "[method]", "solver.")])
    mistakes = Case("mistaken options", [["rum"], ["run"], ["run", "none.toml"], ["run", SHAKEN, "--contcat", "soft"], ["run", SHAKEN, "--contact", "sofd"],
                                         ["run", SHAKEN, "--set", "method.thetta=1"], ["run", SHAKEN, "--set", "theta"], ["run", SHAKEN, "--dt", "-1"],
                                         ["run", SHAKEN, "--end", "x"], ["fos", SLOPE, "--increase", "wind"], ["draw", "nowhere"], ["study", SHAKEN],
                                         ["sweep", SHAKEN, "--vary", "method.theta"], ["report", "nowhere"], ["cut", SHAKEN], ["new", "dam"], ["run", SHAKEN, SHAKEN]])
    return [helps, manuals, shells, keys, words, mistakes]


def drafts() -> list[Case]:
    """Each kind as it is and with other numbers: written, checked, drawn, and of walls and arches their factor."""
    cases = [Case(f"new {kind}", [["new", kind, "-o", "a.toml"], ["new", kind, *options, "-o", "b.toml"], ["check", "b.toml"], ["draw", "b.toml", "-o", "b.svg"],
                                  ["fos", "b.toml", "-o", "b"]]) for kind, options in KINDS.items()]
    wrong = [[f"{option.partition('=')[0]}={value}"] for options in KINDS.values() for option in options for value in ("0", "-1", "1", "1e9", "0.5", "x")]
    kinds = [kind for kind, options in KINDS.items() for _ in range(6 * len(options))]
    cases.append(Case("new with options at their limits", [["new", kind, *option, "-q", "-o", f"{i}.toml"] for i, (kind, option) in enumerate(zip(kinds, wrong))], together=True))
    return cases


def runs() -> list[Case]:
    cases = []
    for method in METHODS:
        contact = ["--contact", method, *ALL_BITS]
        cases += [
            Case(f"sliding block, {method}", [["run", INCLINE, *contact, "--end", "0.2", "-o", "r"]]),
            Case(f"columns in motion, {method}", [["run", COLUMNS, *contact, "--end", "0.3", *settings("method.start=unloaded"), "-o", "r"]]),
            Case(f"shaken block, {method}", [["run", SHAKEN, *contact, "--end", "1", *settings("output.snapshots_every_s=0.25"), "-o", "r"],
                                             ["draw", "r", "--state", "t=0.5", "--colour", "velocity", "--forces", "-o", "a.svg"],
                                             ["draw", "r", "--cracks", "-o", "b.svg"], ["report", "r", "-o", "page.html"]]),
            Case(f"shaken wall, {method}", [["run", "examples/shaken_wall/scene.toml", *contact, "--end", "0.2", "-o", "r"]]),
            Case(f"rockfall and a restart, {method}", [["run", "examples/rockfall/scene.toml", *contact, "--end", "0.5", "-o", "r"],
                                                       ["run", "examples/rockfall/scene.toml", *contact, "--end", "0.7", "--restart", "r/checkpoint.bin", "-o", "r"]]),
            Case(f"fast landing, {method}", [["run", "landing.toml", *contact, "-o", "r"]], {"landing.toml": to_toml(landing())}, must_succeed=True),
            Case(f"rest after two steps, {method}", [["run", "yard.toml", *contact, "--dt", "0.01", "--end", "0.1", *settings(
                "method.start=settled", "solver.skip_resting=true", "rest.time_s=0.02"), "-o", "r"]], {"yard.toml": to_toml(YARD)}, must_succeed=True),
            Case(f"a pulse wakes blocks, {method}", [["run", "pile.toml", *contact, "-o", "r"]], {"pile.toml": to_toml(shaken_late(1.0))}, must_succeed=True),
            Case(f"a pulse wakes blocks of a millimetre, {method}", [["run", "pile.toml", *contact, "-o", "r"]], {"pile.toml": to_toml(shaken_late(1e-3))}, must_succeed=True),
            Case(f"toe in motion, {method}", [["run", TOE, *contact, "--dt", "1e-3", "--end", "0.2", *settings("run.strength_reduction_factor=3"), "-o", "r"]]),
        ]
    leaning = [leaning_columns(3, [10, 20, 40, 20, 40, 10, 20, 40], 7e-4, 0.387, 3.048), leaning_columns(3, [10, 20, 40, 10, 40, 10, 10], 7e-3, 0.4764, 1.531),
               leaning_columns(4, [40, 40, 40, 40], 1.75e-4, 0.4124, 5.022)]
    cases += [
        *(Case(f"columns that close, {i}", [["run", "columns.toml", *ALL_BITS, "-o", "r"]], {"columns.toml": to_toml(scene)}, must_succeed=True) for i, scene in enumerate(leaning)),
        Case("483 blocks in failure, soft", [["run", FAILING, *ALL_BITS, "--end", "0.3", "-o", "r"]]),
        Case("483 blocks in failure, hard", [["run", FAILING, "--contact", "hard", *ALL_BITS, "--end", "0.1", "-o", "r"]]),
        Case("a film", [["run", SHAKEN, "--end", "0.5", *settings('output.formats=["vtk", "svg"]', "output.snapshots_every_s=0.25", "output.milestones_m=[1e-4, 1e-3]"), "-o", "r"]]),
        Case("states of every step", [["run", SHAKEN, "--dt", "0.01", "--end", "0.05", *settings("output.snapshots_every_s=0.01"), *ALL_BITS, "-o", "r"]], must_succeed=True),
        Case("an adaptive step", [["run", INCLINE, "--end", "0.5", *settings("step.adaptive=true", "step.look_ahead=0.5"), *ALL_BITS, "-o", "r"]]),
        Case("json of a run", [["run", INCLINE, "--end", "0.02", "--json", "-o", "r"], ["check", INCLINE, "--json"], ["check", SHAKEN, "--spectrum", "spectrum.csv"]]),
    ]
    return cases


def pages() -> list[Case]:
    """Of what holds and pushes blocks; of so many blocks and states that some are left out; and what is said to programs."""
    wall = [["new", "wall", "--courses=44", "--bricks=40", "-q", "-o", "wall.toml"],
            ["run", "wall.toml", "--dt", "2e-3", "--end", "0.02", *settings("output.snapshots_every_s=2e-3"), "-q", "-o", "r"]]
    yard, hill = {"yard.toml": to_toml(YARD)}, {"hill.toml": to_toml(HILL)}
    return [
        Case("page of a yard", [["run", "yard.toml", *settings("output.snapshots_every_s=0.01"), "-o", "r"], ["report", "r", "--json", "-o", "page.html"]], yard, must_succeed=True),
        Case("page of a large wall", [*wall, ["report", "r", "--most-mb", "1", "-o", "page.html"], ["report", "r", "--most-mb", "2", "-q", "-o", "second.html"]], together=True,
             must_succeed=True),
        Case("json of a cut", [["cut", "hill.toml", "--json", "-o", "blocks.toml"], ["draw", "hill.toml", "--json", "-o", "a.svg"], ["check", "hill.toml", "--json"]], hill,
             must_succeed=True),
        Case("a study of a yard", [["study", "yard.toml", "--dt", "1e-2,5e-3,2.5e-3", "--contact", "soft,dem", "--end", "0.02", "-q", "-o", "r"]], yard),
    ]


def asked_in_vain() -> list[Case]:
    """What a scene that is right cannot be asked, and what one of the three definitions of the factor can be."""
    rockfall = (ROOT / "examples/rockfall/scene.toml").read_text(encoding="utf-8")
    files = {"no_step.toml": re.sub(r"dt_s = .*", "", rockfall), "fixed.toml": rockfall.replace('name = "slab"', 'name = "slab"\nfixed = true'), "yard.toml": to_toml(YARD)}
    motion = [("strength_reduction.curve=[1, 2]", "strength_reduction.curve_time_s=0.05"), ("strength_reduction.curve_time_s=0.05",), ("settle.criterion=paper",)]
    of_motion = [["fos", TOE, *settings(f"strength_reduction.definition={definition}", *keys), "-o", "r"]
                 for definition in ("small_displacements", "joint_closures", "large_displacements") for keys in motion]
    return [Case("asked in vain", [["check", "no_step.toml", "--spectrum", "s.csv"], ["run", "no_step.toml"], ["fos", "fixed.toml", "-o", "r"],
                                   ["sweep", "yard.toml", "--vary", "method.theta=0.5:1:0.25", "--quantity", "high.displacement_x_m", "-o", "r"], *of_motion], files)]


def measured_at_the_rim() -> dict:
    """Points to the right of which there is no room for their names, and below the title."""
    return landing() | {"measured_point": [{"name": "a point whose name is too long to stand to the right of it", "block": "ground", "point_m": [5, 0]},
                                           {"name": "top", "block": "block", "point_m": [0, 1.33]}]}


def searches() -> list[Case]:
    cases = []
    for name in ("planar_slope", "toppling_slope", "roof_wedge", "tilting_arch", "retaining_blocks"):
        scene = f"examples/{name}/scene.toml"
        cases += [Case(f"fos {name}, {method}", [["fos", scene, "--contact", method, "-o", "r"], ["draw", "r", "-o", "a.svg"],
                                                 ["draw", "r", "--state", "stable", "--forces", "-o", "b.svg"],
                                                 ["report", "r", "-o", "page.html"]]) for method in (("soft", "dem") if name == "planar_slope" else ("soft",))]
    cases += [
        Case(f"fos {Path(scene).stem}, {definition}", [["fos", scene, *settings(f"strength_reduction.definition={definition}"), "-o", "r"]])
        for scene in (TOE, "paper/scenes/example_3_3_wedge.toml", "verification/scenes/slope_face_60_columns_m70.toml")
        for definition in ("small_displacements", "joint_closures", "large_displacements")
    ]
    cases += [Case(f"fos {scene.stem}", [["fos", f"verification/blind/{scene.name}", "-o", "r"]]) for scene in sorted((ROOT / "verification/blind").glob("*.toml"))]
    cases += [
        Case("fos by loads", [["fos", "examples/retaining_blocks/scene.toml", "--increase", load, "-o", f"r{i}"]
                              for i, load in enumerate(("gravity_x", "-gravity_x", "gravity_y", "gravity", "surcharges", "loads", "surcharge 1"))]),
        *(Case(f"fos with measured points, {definition}", [["fos", "wall.toml", *settings(f"strength_reduction.definition={definition}"), "-o", "r"]],
               {"wall.toml": to_toml(wall_with_points())}, must_succeed=True) for definition in ("small_displacements", "large_displacements")),
        Case("fos of a fallen tower", [["fos", "examples/dry_stone_tower/scene.toml", *settings("gravity_m_per_s2=[9.81,-9.81]"), "-o", "r"]]),
        Case("fos of an open slope", [["fos", SLOPE, "--json", "-o", "r"]]),
        Case("fos with a curve", [["fos", TOE, *settings("strength_reduction.curve=[1, 2]", "strength_reduction.curve_time_s=0.05", "step.dt_s=1e-3"), "-o", "r"]]),
        Case("settling as the paper", [["fos", TOE, *settings("settle.criterion=paper", "step.dt_s=1e-3", "settle.max_time_steps=200"), "-o", "r"]]),
        Case("a study", [["study", SHAKEN, "--dt", "1e-2,5e-3", "--contact", "soft,hard", "--end", "0.5", "-q", "-o", "r"],
                         ["study", "examples/rockfall/scene.toml", "--dt", "8e-3,4e-3", "--end", "0.4", "--quantity", "slab.displacement_x_m", "--reference", "1", "-q", "-o", "s"]]),
        Case("a sweep", [["sweep", "examples/planar_slope/scene.toml", "--vary", "joint[0].friction_angle_deg=20:30:5", "-o", "r"]]),
        Case("cuts", [["cut", scene, "-o", f"{i}.toml"] for i, scene in enumerate((SLOPE, "verification/scenes/slope_face_60_joints_20_m70.toml", TOE))]),
        Case("labels at the rim", [["draw", "landing.toml", "-o", "a.svg"]], {"landing.toml": to_toml(measured_at_the_rim())}, must_succeed=True),
        Case("pictures of scenes", [["draw", scene, *option, "-o", f"{i}.svg"]
                                    for i, (scene, option) in enumerate(((SLOPE, []), ("examples/retaining_blocks/scene.toml", []), (SHAKEN, []), ("examples/rockfall/scene.toml", [])))]),
    ]
    return cases


def strangers() -> list[Case]:
    """Scenes of the campaign's seeds, by all methods that serve."""
    cases = []
    for part, methods in ((slopes, ("soft",)), (maps, ("soft",)), (masonry, ("soft", "dem")), (tumbles, METHODS)):
        for seed in SEEDS:
            scene = part.draw(seed)
            files = {"scene.toml": to_toml(scene.document)}
            ends = ["--end", END, *ALL_BITS] if scene.command == "run" else []
            cases += [Case(f"{scene.name}, {method}", [[scene.command, "scene.toml", "--contact", method, *ends, "-o", "r"]], files) for method in methods]
    return cases


def integrators() -> list[Case]:
    """Blocks thrown about, by each integrator, at steps as they are drawn and so long that a step needs other ways to its end."""
    cases = []
    for seed in SEEDS:
        scene = tumbles.draw(seed)
        for factor in (1, 10):
            step = ["--dt", repr(factor * scene.document["step"]["dt_s"]), "--end", END, *ALL_BITS]
            cases.append(Case(f"{scene.name}, all integrators, {factor} times the step",
                              [["run", "scene.toml", "--contact", "soft", "--integrator", name, *step, "-o", name] for name in INTEGRATORS],
                              {"scene.toml": to_toml(scene.document)}, together=True))
    files = {"slope.toml": to_toml(closely_jointed_slope())}
    cases += [Case(f"a thousand blocks in failure, {name}", [["run", "slope.toml", "--integrator", name, *THETA.get(name, []), *ALL_BITS, "-o", "r"]], files, must_succeed=True)
              for name in INTEGRATORS]
    return cases


def attacks() -> list[Case]:
    """What `check` says of everything that has been thrown at the reader of scenes, and of each line of a scene left out or written twice."""
    corpus = sorted((ROOT / "tests/fuzz/corpus/scene").iterdir())
    found = [Case(f"check of what was found by attack, {i}", [["check", path.name]], together=True, files={path.name: text})
             for i, path in enumerate(corpus) if (text := readable(path)) is not None]
    text = (ROOT / "examples/retaining_blocks/scene.toml").read_text()
    lines = text.splitlines(keepends=True)
    used = [i for i, line in enumerate(lines) if re.match(r"[\w\[]", line)]
    less = {f"{i}.toml": "".join(lines[:i] + lines[i + 1:]) for i in used}
    twice = {f"{i}_twice.toml": "".join(lines[:i + 1] + lines[i:]) for i in used}
    return [*found, Case("check of a scene with a line less", [["check", name] for name in less], less, together=True),
            Case("check of a scene with a line twice", [["check", name] for name in twice], twice, together=True)]


def records() -> list[Case]:
    """Accelerograms of every form, whole and broken, as the base's motion."""
    files, tried = {}, []
    for i, path in enumerate(sorted((ROOT / "tests/fuzz/corpus/record").iterdir())):
        for ending in ("csv", "at2"):
            name, text = f"record_{i}.{ending}", readable(path)
            if text is None:
                continue
            files[name] = text
            files[f"{name}.toml"] = to_toml(YARD | {"base_motion": {"kind": "record", "horizontal_file": name, "vertical_file": name, "factor": 0.5}})
            tried.append(["run", f"{name}.toml", "--end", "0.05", "-q", "-o", f"{i}_{ending}_yard"])
    return [Case("records", tried, files, together=True)]


def readable(path: Path) -> str | None:
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return None


def cases() -> list[Case]:
    return [*texts(), *drafts(), *runs(), *pages(), *asked_in_vain(), *searches(), *strangers(), *integrators(), *attacks(), *records()]
