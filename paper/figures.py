"""Draws all figures."""

from pathlib import Path

import figures_slopes
from figures_geometry import figure_1, figure_2, figure_5
from figures_incline import figure_3, figure_4
from figures_plane_failure import figure_6
from openclose_scripts.examples.incline import Incline
from openclose_scripts.examples.plane_failure import PlaneFailure
from openclose_scripts.examples.slopes import JointedSlope, PlanarSlope


def draw_all(slider: Incline, wedge: PlaneFailure, planar: PlanarSlope, jointed: JointedSlope, printed: dict, folder: Path) -> None:
    """Writes fig1.png to fig10.png."""
    figure_1(folder / "fig1.png")
    figure_2(slider, folder / "fig2.png")
    figure_3(slider, folder / "fig3.png")
    figure_4(slider, folder / "fig4.png")
    figure_5(wedge, folder / "fig5.png")
    figure_6(wedge, printed["plane_failure"], folder / "fig6.png")
    figures_slopes.draw(planar, jointed, printed, folder)
