"""Figs 1, 2 and 5: how a contact is represented, and the two models as the program reads them."""

import math
from pathlib import Path

from openclose_scripts import drawing
from openclose_scripts.drawing import BLOCK, INK, JOINT, METHOD_COLOUR, ROCK, Point, label
from openclose_scripts.examples.incline import Incline
from openclose_scripts.examples.plane_failure import PlaneFailure


def figure_1(file: Path) -> None:
    """Two blocks with the springs between a corner and an edge; not to scale."""
    figure, axes = drawing.sketch(8.4, 5.0)
    drawing.polygon(axes, [(0, -2.2), (13, -2.2), (13, 0), (0, 0)], ROCK)
    drawing.polygon(axes, [(4.1, 2.2), (9.6, 3.7), (8.6, 6.2), (2.4, 4.4)], BLOCK)
    corner, foot, anchor = (4.1, 2.2), (4.1, 0.0), (1.5, 2.2)
    drawing.spring(axes, corner, foot, 0.22, METHOD_COLOUR["soft"])
    drawing.spring(axes, corner, anchor, 0.22, METHOD_COLOUR["shi"])
    axes.plot([1.5, 1.5], [0.0, 2.6], color=INK, linewidth=2.2)
    axes.plot([4.1, 4.1], [2.2, 0.0], "o", color=INK, markersize=5)
    label(axes, (4.6, 1.35), "normal spring $k_n$: carries pressure (and tension up to $\\sigma_t$)", ha="left", color=METHOD_COLOUR["soft"])
    label(axes, (2.0, 2.95), "shear spring $k_s$", color=METHOD_COLOUR["shi"])
    label(axes, (4.6, 0.65), "shear slides when |T| reaches $c\\,L + N\\,\\tan\\varphi$", ha="left", color=METHOD_COLOUR["shi"])
    label(axes, (6.2, 4.2), "block A (its corner)")
    label(axes, (6.5, -1.1), "block B (its edge)")
    drawing.save_titled(figure, axes, "Fig. 1  Contact in the soft approach: corner of one block, edge of another (drawn apart)", file)


def figure_2(slider: Incline, file: Path) -> None:
    """The upper part of the incline with the block."""
    i, blocks = slider.inputs, slider.blocks()
    figure, axes = drawing.geometry(7.6, 5.6)
    drawing.polygon(axes, blocks["incline"], ROCK)
    drawing.polygon(axes, blocks["slider"], BLOCK)
    lower, lower_top, upper_top, upper = blocks["slider"]
    drawing.dimension(axes, upper_top, lower_top, 0.35, f"{i.length:.3g} m", 0.18)
    drawing.dimension(axes, lower_top, lower, 0.35, f"{i.height:.3g} m", 0.18)
    axes.plot(*zip(lower, upper), "o", color=JOINT, markersize=6)
    centre = (sum(p[0] for p in blocks["slider"]) / 4, sum(p[1] for p in blocks["slider"]) / 4)
    axes.plot(*centre, "+", color=INK, markersize=9)
    drawing.arrow(axes, centre, (centre[0], centre[1] - 0.75))
    label(axes, (centre[0] + 0.12, centre[1] - 0.55), "g", ha="left")
    _slope_angle(axes, slider)
    corner_stiffness = f"at each corner $k_n$ = $k_s$ = {i.normal_stiffness / 1e6:g} MPa/m x {i.length / 2:g} m"
    axes.annotate(corner_stiffness, xy=lower, xytext=(3.0, -4.9), arrowprops={"arrowstyle": "-", "color": JOINT}, color=JOINT, ha="center")
    label(axes, (5.4, -1.0), "measured: the centroid's\ndisplacement along the slope", ha="left")
    axes.set_xlim(-0.4, 9.4)
    axes.set_ylim(-5.4, 1.0)
    drawing.save_titled(figure, axes, "Fig. 2  Block on an inclined surface (the incline goes on to the right)", file)


def _slope_angle(axes, slider: Incline) -> None:
    alpha = slider.inputs.slope_angle_deg
    cosine, sine = slider.inputs.downhill
    corner = (6.2 * cosine / abs(cosine), 6.2 * sine / cosine)
    axes.plot([corner[0], corner[0] + 2.2], [corner[1], corner[1]], color=INK, linewidth=0.8, linestyle="--")
    drawing.angle_mark(axes, corner, 1.5, 0, -alpha, f"$\\alpha$ = {alpha:.3g}°", (corner[0] + 2.0, corner[1] - 0.55))


def figure_5(wedge: PlaneFailure, file: Path) -> None:
    i, blocks = wedge.inputs, wedge.blocks("initial")
    figure, axes = drawing.geometry(8.2, 5.4)
    drawing.polygon(axes, blocks["base"], ROCK)
    drawing.polygon(axes, blocks["wedge"], BLOCK)
    toe, back, crest = blocks["wedge"]
    axes.plot(*zip(toe, back), color=JOINT, linewidth=2.4)
    axes.plot(*crest, "o", color=INK, markersize=6)
    label(axes, (crest[0] - 3, crest[1] + 4), "measured point", ha="right")
    drawing.dimension(axes, (toe[0], crest[1]), toe, -12, f"{i.height:.4g} m", 4)
    axes.plot([toe[0], crest[0]], [crest[1], crest[1]], color=INK, linewidth=0.6, linestyle=":")
    axes.plot([toe[0], toe[0] + 34], [toe[1], toe[1]], color=INK, linewidth=0.8, linestyle="--")
    drawing.angle_mark(axes, toe, 28, 0, i.joint_angle_deg, f"joint {i.joint_angle_deg:.3g}°", (38, 10))
    drawing.angle_mark(axes, toe, 18, 0, i.face_angle_deg, f"face {i.face_angle_deg:.3g}°", (3, 19))
    _joint_text(axes, i, toe, back)
    axes.set_xlim(-26, 130)
    axes.set_ylim(-24, 72)
    drawing.save_titled(figure, axes, "Fig. 5  Plane failure of a slope: a wedge on a joint through the toe", file)


def _joint_text(axes, inputs, toe: Point, back: Point) -> None:
    length = math.dist(toe, back)
    text = (f"joint, {length:.4g} m long:\n"
            f"$\\varphi$ = {inputs.friction_angle_deg:g}°, c = {inputs.cohesion / 1e6:g} MPa, $\\sigma_t$ = {inputs.tensile_strength:g}\n"
            f"$k_n$ = {inputs.normal_stiffness / 1e9:g} GPa/m, $k_s$ = {inputs.shear_stiffness / 1e9:g} GPa/m")
    on_joint = (toe[0] + 0.72 * (back[0] - toe[0]), toe[1] + 0.72 * (back[1] - toe[1]))
    axes.annotate(text, xy=on_joint, xytext=(92, 15), ha="center", va="center", color=JOINT, arrowprops={"arrowstyle": "-", "color": JOINT})
