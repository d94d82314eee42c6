"""A judge of programs that shares no code with their writers and with `check`.

`gcode`, `urscript` and others run a program's text as the controllers' manuals say, into `moves.Run`.
`verdict` compares the run with a cell's limits and with a plan. `damage` makes damaged programs, and
`checked` runs `brushsvg check`.
"""
