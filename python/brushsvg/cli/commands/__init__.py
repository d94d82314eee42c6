"""What the commands do, a file for each: call the steps in order, warn, refuse, write everything or nothing.

A command is imported when it is run, and with it what it needs: the others start without that.
"""

import importlib

_HOME = {
    "animate_file": "animate",
    "article_files": "article",
    "batch_files": "batch",
    "border_file": "border",
    "brush_check": "brush",
    "brush_list": "brush",
    "brush_new": "brush",
    "brush_plot": "brush",
    "brush_show": "brush",
    "calibrate_file": "calibrate",
    "cell_check": "cell",
    "cell_list": "cell",
    "cell_new": "cell",
    "cell_place": "cell",
    "cell_show": "cell",
    "chart_file": "chart",
    "check_file": "check",
    "compare_files": "compare",
    "convert_file": "convert",
    "demo_picture": "demo",
    "first_run_file": "first_run",
    "height_file": "height",
    "import_file": "import_drawing",
    "install_plugin": "plugin",
    "list_installation": "doctor",
    "predict_file": "predict",
    "report_file": "report",
    "scan_file": "scan",
    "simulate_photo_file": "simulate_photo",
    "text_file": "text",
}

__all__ = sorted(_HOME)


def __getattr__(name: str):
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)
