"""Draws the figures, all of them or one."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from figures_geometry import figure_1, figure_2, figure_5
from figures_incline import figure_3, figure_4
from figures_plane_failure import figure_6
from figures_slopes import figure_7, figure_8, figure_9, figure_10
from openclose_scripts.examples.incline import Incline
from openclose_scripts.examples.plane_failure import PlaneFailure
from openclose_scripts.examples.slopes import JointedSlope, PlanarSlope


@dataclass(frozen=True)
class Examples:
    """What the figures show."""

    slider: Incline
    wedge: PlaneFailure
    planar: PlanarSlope
    jointed: JointedSlope
    printed: dict


@dataclass(frozen=True)
class Figure:
    draw: Callable[[Examples, Path], None]
    seconds: int  # that its runs and its drawing take alone, one run after the other; measured once, to be announced


FIGURES = {
    1: Figure(lambda e, file: figure_1(file), 1),
    2: Figure(lambda e, file: figure_2(e.slider, file), 1),
    3: Figure(lambda e, file: figure_3(e.slider, file), 5),
    4: Figure(lambda e, file: figure_4(e.slider, file), 25),
    5: Figure(lambda e, file: figure_5(e.wedge, file), 1),
    6: Figure(lambda e, file: figure_6(e.wedge, e.printed["plane_failure"], file), 2),
    7: Figure(lambda e, file: figure_7(e.planar, file), 1),
    8: Figure(lambda e, file: figure_8(e.jointed, e.printed["jointed_slope"], file), 5),
    9: Figure(lambda e, file: figure_9(e.jointed, file), 60),
    10: Figure(lambda e, file: figure_10(e.jointed, e.printed["table_4"], file), 100),
}


def draw(number: int, examples: Examples, folder: Path) -> Path:
    file = folder / f"fig{number}.png"
    FIGURES[number].draw(examples, file)
    return file


def draw_all(examples: Examples, folder: Path) -> None:
    for number in FIGURES:
        draw(number, examples, folder)
