"""A judge of programs that shares nothing with what writes or checks them.

`gcode` and `urscript` run a program's text as the controllers' manuals say, into `moves.Run`; `verdict` holds what is
run against a cell's limits and against a plan; `damage` makes damaged programs; `checked` asks `brushsvg check`.
"""
