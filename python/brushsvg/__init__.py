"""Turn vector lettering into brush strokes that a robot can paint.

__all__ lists the public names. Each name is imported when it is first used. Importing the package therefore
costs nothing, and only the parts in use are loaded.
"""

from __future__ import annotations

import importlib
import sys
import types

TYPE_CHECKING = False  # True for editors and type checkers; the module typing is slow to import
if TYPE_CHECKING:  # the names that the table below imports at run time
    from ._core import (
        Arc,
        Brush,
        Compensated,
        Footprint,
        FootprintTable,
        Marks,
        Paint,
        Pass,
        Plan,
        Profile,
        Settings,
        Stroke,
        area,
        compensate,
        coverage,
        flatten,
        overlap,
        simulate,
        target_outline,
        trace_outlines,
        unite,
        write_marks,
        write_plan,
    )
    from .calibration.chart.file import write_chart
    from .calibration.chart.layout import Chart, chart
    from .calibration.chart.page import chart_page
    from .calibration.numbers.from_widths import new_brush
    from .errors import Error
    from .jobs.batch.run import Batch, batch
    from .jobs.calibrating import BrushCalibration, calibrate
    from .jobs.checking import Check, check
    from .jobs.comparing import PaintedJob, compare
    from .jobs.conversion import Conversion, convert
    from .jobs.json_files import read_marks, read_plan
    from .jobs.placing import PaperPlacement, place_paper
    from .jobs.project import Project, find_project, read_project
    from .jobs.setting_up import SetupProgram, setup_border, setup_first_run, setup_height
    from .machine.cells.cell import Cell
    from .machine.cells.cell_file import cell_names, find_cell, read_cell, write_cell
    from .machine.writer import write_program
    from .model import laws
    from .model.library import brush_like, brush_names, find_brush, save_brush
    from .read import ReadOptions, read_drawing
    from .read.text import text_svg
    from .show.marks_png import marks_png
    from .show.marks_svg import marks_svg
    from .simulated.simulate_photo import SimulatedPhoto, simulate_photo
    from .strokes.corners import lifted_at_corners
    from .strokes.extraction import strokes
    from .strokes.path_objects import path_from_pass, path_from_stroke, stroke_from_path
    from .strokes.wide_shapes import within_reach

    __version__: str

_HOME = {  # the module of each name; other names are in _core
    name: module
    for module, names in {
        "errors": "Error",
        "read": "ReadOptions read_drawing",
        "read.text": "text_svg",
        "strokes.extraction": "strokes",
        "strokes.path_objects": "stroke_from_path path_from_stroke path_from_pass",
        "machine.cells.cell": "Cell",
        "model.library": "brush_like brush_names find_brush save_brush",
        "machine.cells.cell_file": "cell_names find_cell read_cell write_cell",
        "calibration.numbers.from_widths": "new_brush",
        "jobs.calibrating": "BrushCalibration calibrate",
        "calibration.chart.layout": "Chart chart",
        "calibration.chart.page": "chart_page",
        "calibration.chart.file": "write_chart",
        "jobs.checking": "Check check",
        "jobs.comparing": "PaintedJob compare",
        "jobs.conversion": "Conversion convert",
        "jobs.batch.run": "Batch batch",
        "jobs.project": "Project find_project read_project",
        "jobs.placing": "PaperPlacement place_paper",
        "jobs.setting_up": "SetupProgram setup_border setup_first_run setup_height",
        "jobs.json_files": "read_marks read_plan",
        "machine.writer": "write_program",
        "strokes.corners": "lifted_at_corners",
        "strokes.wide_shapes": "within_reach",
        "show.marks_png": "marks_png",
        "show.marks_svg": "marks_svg",
        "simulated.simulate_photo": "SimulatedPhoto simulate_photo",
    }.items()
    for name in names.split()
}

_MODULES = {"laws": "model.laws"}

__all__ = [
    "Arc",
    "Batch",
    "Brush",
    "BrushCalibration",
    "Cell",
    "Chart",
    "Check",
    "Compensated",
    "Conversion",
    "Error",
    "Footprint",
    "FootprintTable",
    "Marks",
    "Paint",
    "PaintedJob",
    "PaperPlacement",
    "Pass",
    "Plan",
    "Profile",
    "Project",
    "ReadOptions",
    "Settings",
    "SetupProgram",
    "SimulatedPhoto",
    "Stroke",
    "__version__",
    "area",
    "batch",
    "brush_like",
    "brush_names",
    "calibrate",
    "cell_names",
    "chart",
    "chart_page",
    "check",
    "compare",
    "compensate",
    "convert",
    "coverage",
    "find_brush",
    "find_cell",
    "find_project",
    "flatten",
    "laws",
    "lifted_at_corners",
    "marks_png",
    "marks_svg",
    "new_brush",
    "overlap",
    "path_from_pass",
    "path_from_stroke",
    "place_paper",
    "read_cell",
    "read_drawing",
    "read_marks",
    "read_plan",
    "read_project",
    "save_brush",
    "setup_border",
    "setup_first_run",
    "setup_height",
    "simulate",
    "simulate_photo",
    "stroke_from_path",
    "strokes",
    "target_outline",
    "text_svg",
    "trace_outlines",
    "unite",
    "within_reach",
    "write_cell",
    "write_chart",
    "write_marks",
    "write_plan",
    "write_program",
]


class _Package(types.ModuleType):
    def __setattr__(self, name: str, value) -> None:
        # Importing the module brushsvg.strokes must not hide the function with that name.
        if name in _HOME and isinstance(value, types.ModuleType):
            return
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package


def __getattr__(name: str):
    if name == "__version__":
        from importlib.metadata import version

        value = version("brushsvg")
    elif name in _MODULES:
        value = importlib.import_module(f".{_MODULES[name]}", __name__)
    elif name in __all__:
        value = getattr(importlib.import_module(f".{_HOME.get(name, '_core')}", __name__), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if core := sys.modules.get(f"{__name__}._core"):
        wrong_types = importlib.import_module(".wrong_types", __name__)
        wrong_types.with_classes_in_words(core)
        if getattr(core, name, None) is value and not isinstance(value, type):
            value = wrong_types.in_words(value)
    globals()[name] = value
    if "IPython" in sys.modules:
        importlib.import_module(".notebook", __name__)
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
