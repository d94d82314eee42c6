"""The colours of all pictures, as in SVG."""

WHITE = "#ffffff"
TEXT = "#22252b"
MUTED_TEXT = "#767a82"
REFUSED_TEXT = "#b3261e"
PAPER = "#fdfcf9"  # around panels and the cards of a contact sheet

# pictures of marks
TOOLPATH = "#2f6fd0"
INTERVAL_BAND = "#e0862b"  # the 95 % band of an edge

# pictures of overlap
BOTH, MISSING, OVERSPILL = "#b4b8c0", "#d1431f", "#2f6fd0"
OVERLAP_COLOURS = (
    (BOTH, "painted as drawn"),
    (MISSING, "drawn, not painted"),
    (OVERSPILL, "painted, not drawn"),
)

# panels that compare marks
PANEL = "#f3f1ec"
TARGET = "#b7b6b0"
PREDICTED_INK = "#2b3a67"
TCP_LINE = "#3f8fd9"
MIDDLE_LINE = TEXT

# pictures of a drawing as it was understood
IMPORT_BACKGROUND = "#f3f1ec"
IMPORT_MUTED_TEXT = "#6d717a"
SHEET_EDGE = "#c9c7c0"
SHAPE_FILL = "#d9d7d0"
WARNING_TEXT = "#b3401f"
STROKE_INKS = ("#2b3a67", "#b3401f", "#2f7d4f", "#8a3ffc", "#c07a00", "#0f7c8a", "#c2185b", "#5d6d1e")

# pictures of a table with a robot arm
REACHED_AREA, LIMITED_AREA, SINGULAR_AREA, UNREACHED_AREA = "#bfe3c4", "#f4c37d", "#d99bd0", "#e4e4e6"
SHEET_OUTLINE, ALTERNATIVE_SHEET_OUTLINE = "#22252b", "#1b66c9"
GRID_LINE = "#ffffff"
