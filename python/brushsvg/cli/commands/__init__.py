"""What the commands do, a file for each: call the steps in order, warn, refuse, write everything or nothing.

An import inside a function is of what only that command needs: the others start without it.
"""

from .animate import animate_file
from .article import article_files
from .batch import batch_files
from .border import border_file
from .brush import brush_check, brush_list, brush_new, brush_plot, brush_show
from .calibrate import calibrate_file
from .cell import cell_check, cell_list, cell_new, cell_place, cell_show
from .chart import chart_file
from .check import check_file
from .compare import compare_files
from .convert import convert_file
from .first_run import first_run_file
from .height import height_file
from .import_drawing import import_file
from .plugin import install_plugin
from .predict import predict_file
from .report import report_file
from .scan import scan_file
from .simulate_photo import simulate_photo
from .text import text_file

__all__ = [
    "animate_file",
    "article_files",
    "batch_files",
    "border_file",
    "brush_check",
    "brush_list",
    "brush_new",
    "brush_plot",
    "brush_show",
    "calibrate_file",
    "cell_check",
    "cell_list",
    "cell_new",
    "cell_place",
    "cell_show",
    "chart_file",
    "check_file",
    "compare_files",
    "convert_file",
    "first_run_file",
    "height_file",
    "import_file",
    "install_plugin",
    "predict_file",
    "report_file",
    "scan_file",
    "simulate_photo",
    "text_file",
]
