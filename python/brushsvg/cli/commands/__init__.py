"""The commands, with a file for each.

A command calls the steps in order, prints warnings, refuses, and writes all files or none. It is imported, together
with what it needs, when it is run, so that other commands start without its imports.
"""

import importlib

_HOME = {
    "batch_files": "drawings.batch",
    "border_file": "setup.border",
    "brush_check": "brushes.brush",
    "brush_list": "brushes.brush",
    "brush_new": "brushes.brush",
    "brush_plot": "brushes.brush",
    "brush_show": "brushes.brush",
    "calibrate_file": "brushes.calibrate",
    "cell_check": "machines.cell",
    "cell_list": "machines.cell",
    "cell_new": "machines.cell",
    "cell_place": "machines.cell",
    "cell_show": "machines.cell",
    "chart_file": "brushes.chart",
    "check_file": "drawings.check",
    "compare_files": "brushes.compare",
    "convert_file": "drawings.convert",
    "demo_picture": "installation.demo",
    "first_run_file": "setup.first_run",
    "height_file": "setup.height",
    "init_project": "installation.init",
    "install_plugin": "setup.inkscape",
    "list_installation": "installation.doctor",
    "preview_animation": "preview.animation",
    "preview_paint": "preview.paint",
    "preview_report": "preview.report",
    "preview_strokes": "preview.strokes",
    "scan_file": "brushes.scan",
    "simulate_photo_file": "brushes.simulate_photo",
    "text_file": "drawings.text",
}

__all__ = sorted(_HOME)


def __getattr__(name: str):
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)
