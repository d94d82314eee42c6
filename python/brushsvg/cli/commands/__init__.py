"""The commands, with a file for each.

A command calls the steps in order, prints warnings, refuses, and writes all files or none. It is imported, together
with what it needs, when it is run, so that other commands start without its imports.
"""

import importlib

_HOME = {
    name: module
    for module, names in {
        "drawings.batch": "batch_files",
        "setup.programs": "border_file first_run_file height_file",
        "brushes.brush": "brush_check brush_list brush_new brush_plot brush_show",
        "brushes.calibrate": "calibrate_file scan_file",
        "machines.cell": "cell_check cell_list cell_new cell_place cell_show",
        "brushes.chart": "chart_file",
        "drawings.check": "check_file",
        "brushes.compare": "compare_files",
        "drawings.convert": "convert_file",
        "installation.demo": "demo_picture",
        "installation.init": "init_project",
        "setup.inkscape": "install_plugin",
        "installation.doctor": "list_installation",
        "preview.paint": "preview_animation preview_paint",
        "preview.report": "preview_report",
        "preview.strokes": "preview_strokes",
        "brushes.simulate_photo": "simulate_photo_file",
        "drawings.text": "text_file",
    }.items()
    for name in names.split()
}

__all__ = sorted(_HOME)


def __getattr__(name: str):
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)
