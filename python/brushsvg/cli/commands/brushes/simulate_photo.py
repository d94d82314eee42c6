"""brushsvg simulate-photo: render the photograph of a painted job."""

from __future__ import annotations

from ...console import print_text, refuse_errors, stage, warn
from ...steps.options import make_choices
from ...steps.output_places import check_outputs, write_outputs


def simulate_photo_file(args) -> None:
    from ....simulated.simulate_photo import photograph_job

    check_outputs(args, args.output)
    with refuse_errors(""):  # errors name their file themselves
        made = photograph_job(make_choices(args), None, args.studio, args.true_brush, args.seed, stage, warn)
    write_outputs(args, {args.output: made.jpeg}, made.stroke_count, more="simulated")
    if args.studio is None:
        print_text(made.studio)
