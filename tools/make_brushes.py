"""Write the brush files that come with brushsvg.

    python tools/make_brushes.py [FOLDER]

Equal numbers give equal bytes. A test compares the shipped files with the files that this script makes.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from brushsvg import _core
from brushsvg.calibration.numbers.from_widths import GAP_PER_HALF, WIDEST_PER_HALF
from brushsvg.files import write_files
from brushsvg.model.footprint_shapes import disc, drop

SHIPPED = Path(__file__).parents[1] / "python" / "brushsvg" / "data" / "brushes"

ARTICLE = '"Physically Motivated Model of a Painting Brush for Robotic Painting and Calligraphy"'

# Values of round-6; coefficients are in ascending powers of the depth. The floor of the widest section is 0.3
# times the half width. It keeps outlines at small depths from turning into half ellipses with their base at
# the tip.
ROUND_WIDEST = [-2.35, 2.75, -0.42, 0.024]
ROUND_HALF_WIDTH_PER_DEPTH = 0.42
ROUND_FLOOR_PER_DEPTH = 0.126
ROUND_DIP_MM = 7.0

PEN_HALF_WIDTH_MM = 0.5

# Values of liner-1, which nobody has measured. Long, narrow bristles trail far. People press a liner down by
# a quarter of the length of its bristles at most.
LINER_DEEPEST_MM = 5
LINER_HALF_WIDTH_MM = (0.5, 1.0)
LINER_LAG_MM = [10.0, 1.0]


def round_outline(depth: float) -> list[list[float]]:
    """Return the outline at a depth [mm], a drop.

    The drop is at most as long as the dip into the paint, where the widest section leaves room for this.
    """
    half = ROUND_HALF_WIDTH_PER_DEPTH * depth
    widest = max(sum(c * depth**i for i, c in enumerate(ROUND_WIDEST)), ROUND_FLOOR_PER_DEPTH * depth)
    return drop(half, widest, min(half, max(ROUND_DIP_MM - widest, 0.25 * half)))


def round_6() -> dict:
    """Return round-6, the round synthetic brush of 6 mm that the article measured."""
    return {
        "format": "brushsvg/brush",
        "version": 1,
        "name": "round-6",
        "kind": "round",
        "about": "Round synthetic brush of 6 mm, dipped 7 mm into the paint.",
        "depth_range_mm": [0, 10],
        "max_speed_mm_s": 25,
        "paint_depth_mm": 5,
        "lag": {
            "coefficients": [3.1, 0.86, 0.31, -0.05, 0.0021],
            "calibrated_mm": [1, 10],
            "source": f"{ARTICLE}, equation (25), from calibration strokes. The coefficient of the fourth "
            "power, p1, is printed there as 2.1e-4 and read here as 2.1e-3: as printed the lag at depth 10 "
            "mm would be -5.2 mm, where section 3.4 works with 13.0 mm; 2.1e-3 gives 13.7 mm.",
            "assumed": False,
            "half_interval_95": [0.9, 1.57, 0.68, 0.103, 0.0051],
            "rmse_mm": 0.58,
        },
        "tip_gap": {
            "coefficients": [0, 0.52],
            "calibrated_mm": [1, 10],
            "source": f"{ARTICLE}, equation (26), from video; no constant term by construction.",
            "assumed": False,
            "half_interval_95": [0, 0.09],
            "rmse_mm": 0.85,
        },
        "tip_to_widest": {
            "coefficients": ROUND_WIDEST,
            "floor": 0,
            "floor_slope": ROUND_FLOOR_PER_DEPTH,
            "calibrated_mm": [1, 10],
            "source": f"{ARTICLE}, equation (24), from footprints on matte glass; no intervals are printed. "
            "Its floor there is 0; 0.126 d, three tenths of the assumed half width, is assumed here as in "
            "the outlines.",
            "assumed": False,
            "rmse_mm": 0.51,
        },
        "half_width": {
            "coefficients": [0, ROUND_HALF_WIDTH_PER_DEPTH],
            "source": "The article prints no law for the width: 0.42 d is assumed until a real brush is measured.",
            "assumed": True,
        },
        "footprints": {
            "dragged": [{"depth_mm": d, "outline_mm": round_outline(d)} for d in range(1, 11)],
            "pressed": [],
            "source": "The article prints no shapes. Assumed: straight flanks from the tip to the widest "
            "section and half an ellipse in front of it, 7 mm long at most where the widest section allows; "
            "the same when pressed straight down.",
            "assumed": True,
        },
    }


def round_6_angles() -> dict:
    """Return round-6 with the article's laws from angles of bristles (section 3.3)."""
    brush = round_6()
    brush["name"] = "round-6-angles"
    brush["about"] = "round-6 by the article's laws from angles, whose scatter is larger: to compare with."
    brush["lag"] = {
        "coefficients": [3.4, 1.39, 0.047, -0.00456, -0.000456],
        "calibrated_mm": [1, 10],
        "source": f"{ARTICLE}, section 3.3, from angles of the bristles by (20) and (23), least absolute residuals.",
        "assumed": False,
        "half_interval_95": [10.0, 16.13, 6.457, 0.8754, 0.0396],
        "rmse_mm": 1.98,
    }
    brush["tip_gap"] = {
        "coefficients": [0, 0.21],
        "calibrated_mm": [1, 10],
        "source": f"{ARTICLE}, equation (27), from angles; its interval and the video's, 0.52 +- 0.09 of (26), do not "
        "touch.",
        "assumed": False,
        "half_interval_95": [0, 0.14],
        "rmse_mm": 1.21,
    }
    return brush


def liner_1() -> dict:
    """Return a liner like the one in section 3.5 of the article.

    The article prints only the size of the liner, so all laws are assumed.
    """
    depths = [0.5 * k for k in range(1, 2 * LINER_DEEPEST_MM + 1)]
    printed = f"{ARTICLE}, section 3.5, prints marks 1 to 2 mm wide and bristles of 20 mm, and no law."
    half = [LINER_HALF_WIDTH_MM[0], (LINER_HALF_WIDTH_MM[1] - LINER_HALF_WIDTH_MM[0]) / LINER_DEEPEST_MM]
    shares = {"tip_gap": GAP_PER_HALF, "tip_to_widest": WIDEST_PER_HALF}
    return {
        "format": "brushsvg/brush",
        "version": 1,
        "name": "liner-1",
        "kind": "liner",
        "about": "Liner of 1 mm with bristles of 20 mm; only its size was measured, all laws are assumed.",
        "depth_range_mm": [0, LINER_DEEPEST_MM],
        "max_speed_mm_s": 25,
        "paint_depth_mm": LINER_DEEPEST_MM / 2,
        "lag": {
            "coefficients": LINER_LAG_MM,
            "source": f"{printed} Assumed: 10 mm at touch-down, half of the bristles, and 1 mm more for each mm of "
            "depth.",
            "assumed": True,
        },
        **{
            name: {
                "coefficients": [round(share * c, 6) for c in half],
                "source": f"Assumed: {share:g} half widths, as in round brushes.",
                "assumed": True,
            }
            for name, share in shares.items()
        },
        "half_width": {
            "coefficients": half,
            "source": f"{printed} Assumed: that they are 1 mm wide where it just touches and 2 mm at the greatest "
            "depth, evenly in between.",
            "assumed": True,
        },
        "footprints": {
            "dragged": [
                {"depth_mm": d, "outline_mm": drop(h, WIDEST_PER_HALF * h, h)}
                for d in (0.01, *depths)  # outlines shrink below the least depth
                for h in [half[0] + half[1] * d]
            ],
            "pressed": [],
            "source": "Assumed: drops, as in round brushes; the same when pressed straight down.",
            "assumed": True,
        },
    }


def rigid() -> dict:
    """Return a felt pen of 1 mm, without lag; the contact is the disc under the TCP."""
    to_centre = {"coefficients": [PEN_HALF_WIDTH_MM], "source": "Radius of the nib.", "assumed": False}
    outline = disc(PEN_HALF_WIDTH_MM)
    return {
        "format": "brushsvg/brush",
        "version": 1,
        "name": "rigid",
        "kind": "pen",
        "about": "Rigid pen with a round nib of 1 mm: the mark follows the tool.",
        "depth_range_mm": [0, 1],
        "max_speed_mm_s": 100,
        "paint_depth_mm": 0.2,
        "lag": {"coefficients": [0], "source": "A rigid pen does not trail.", "assumed": False},
        "tip_gap": to_centre,
        "tip_to_widest": to_centre,
        "half_width": to_centre,
        # A pen draws at full width as soon as it touches the paper. Outlines shrink below the least depth, so
        # the least depth is tiny.
        "footprints": {
            "dragged": [{"depth_mm": d, "outline_mm": outline} for d in (0.01, 1)],
            "pressed": [],
        },
    }


def brush_files() -> dict[str, str]:
    """Return the text of every shipped brush by file name."""
    brushes = [round_6(), round_6_angles(), liner_1(), rigid()]
    return {f"{b['name']}.json": _core.write_brush(_core.read_brush(json.dumps(b))) for b in brushes}


def main() -> None:
    """Write the files to the given folder, or to the folder of the shipped brushes."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else SHIPPED
    write_files({folder / name: text for name, text in brush_files().items()})


if __name__ == "__main__":
    main()
