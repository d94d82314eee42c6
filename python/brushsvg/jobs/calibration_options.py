"""Options of a calibration, and which options exclude each other.

Nothing heavy is imported here, so that usage errors are reported at once.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..photo import PHOTOS

if TYPE_CHECKING:
    from .. import _core
    from ..calibration.chart.layout import Chart
    from ..machine.cells.cell import Cell

AIMS = ("edges", "overlap")
# Limits of the resolution in which a scan can be measured. The lower limit is 4 pixels per mm.
MIN_DPI, MAX_DPI = 102.0, 20000.0


@dataclass(frozen=True, kw_only=True)
class CalibrationOptions:
    """The options of `brushsvg calibrate`. A path that is not given is None.

    For measured numbers:
    absolute: minimize absolute residuals instead of squares.
    total: use total least squares for series of angles.

    For painted marks and photographs:
    machine: any of "lean", "axes", "tilt", "backlash", "field", to estimate as well.
    cell: the machine; only parts that this cell can undo are estimated.
    paint: estimate how marks narrow along the way.
    aim: "edges" or "overlap".

    For photographs of a chart:
    chart: its chart.json, or the Chart itself.
    bar_mm: the measured length of the printed bar.
    dpi: the resolution of a flatbed scan without a printed page.
    mirrored: the photograph was taken through a clear sheet.
    height_mm: the standard deviation of the height of the paper.
    spread: a .json of `compare --sheets`.
    brush: the brush whose lag (for dabs) or outlines (for strokes) are known.

    For photographs of a job:
    plan: the painted plan.json, or the Plan itself.
    prior: the brush that painted it.
    """

    absolute: bool = False
    total: bool = False
    machine: tuple[str, ...] = ()
    cell: str | Cell | None = None
    paint: bool = False
    aim: str = "edges"
    chart: str | Chart | None = None
    bar_mm: float | None = None
    dpi: float | None = None
    mirrored: bool = False
    height_mm: float | None = None
    spread: str | None = None
    brush: str | _core.Brush | None = None
    plan: str | _core.Plan | None = None
    prior: str | _core.Brush | None = None


def is_photograph(path) -> bool:
    return not isinstance(path, Mapping) and os.path.splitext(os.fspath(path))[1].lower() in PHOTOS


def find_contradiction(source, options: CalibrationOptions) -> str:
    """Return why options exclude each other, or "" if they do not.

    The sentence names the flags of the command.
    """
    photos = [source] if isinstance(source, (str, Mapping)) else list(source)
    other = next((path for path in photos if not is_photograph(path)), "")
    is_photo = all(map(is_photograph, photos))
    rules = [
        (options.cell is not None and not options.machine, "--cell needs --machine, whose errors it limits"),
        (len(photos) > 1 and not is_photo, f"you can give several photographs, but {other} is not one"),
    ]
    if options.plan is not None or options.prior is not None:
        is_incomplete = options.plan is None or options.prior is None
        rules.append((is_incomplete, "--plan and --prior go together: the painted plan, and the brush that painted it"))
        for flag in ("chart", "bar_mm", "dpi", "mirrored", "total", "brush", "height_mm", "paint"):
            flag_name = flag.removesuffix("_mm")
            rules.append((bool(getattr(options, flag)), f"--{flag_name} is not for a job (--plan)"))
        rules.append((options.absolute, "--norm is not for a job (--plan)"))
        rules.append((options.aim != "edges", "--aim is not for a job (--plan): edges update the brush"))
        rules.append((not is_photo, "--plan needs photographs of the painted job"))
        return next((why for is_broken, why in rules if is_broken), "")
    rules += [
        (options.paint and options.brush is not None, "--paint fits a new brush: leave --brush out"),
        (options.paint and options.aim != "edges", "--paint fits the edges of marks: leave --aim overlap out"),
    ]
    if is_photo:
        for is_given, flag in ((options.absolute, "--norm absolute"), (options.total, "--total")):
            why = f"{flag} is for measured numbers: the fit of painted marks detects outliers itself"
            rules.append((is_given, why))
        is_wrong_scan = options.dpi is not None and (len(photos) > 1 or options.bar_mm is not None)
        rules += [
            (
                options.aim != "edges" and options.brush is not None,
                "--aim overlap is not for a photograph with --brush, which keeps its outlines",
            ),
            (
                options.chart is None,
                "photographs need --chart, the chart.json that was written with the page",
            ),
            (is_wrong_scan, "--dpi is for one scan of a sheet without markers: leave --bar and other photographs out"),
        ]
    else:
        for flag in ("mirrored", "chart", "bar_mm", "dpi", "brush", "spread", "height_mm"):
            given = getattr(options, flag) not in (None, False)
            flag_name = flag.removesuffix("_mm")
            rules.append((given, f"--{flag_name} is for photographs ({' '.join(PHOTOS)})"))
    return next((why for is_broken, why in rules if is_broken), "")
