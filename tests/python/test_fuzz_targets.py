"""The fuzz targets of `make fuzz` read their seeds and report a planted fault."""

import logging
import random
import warnings

import fuzz_target
import mutators
import pytest
import targets

from brushsvg.errors import Error


@pytest.mark.parametrize("name", targets.TARGETS)
def test_each_target_reads_one_of_its_seeds_and_refuses_others_in_one_line(name):
    target = targets.TARGETS[name]
    read = 0
    for data in targets.seeds_of(name):
        targets.judged(target, data)
        try:
            target.read(data)
            read += 1
        except Error:
            pass
    assert read > 0


@pytest.mark.parametrize("name", ["svg", "dxf", "measurements_json", "turn_picture", "css"])
def test_mutators_make_other_inputs_that_are_often_still_read(name):
    """Mutators make new inputs that are often still readable.

    The test covers one target of each form.
    """
    target, seeds, choose = targets.TARGETS[name], targets.seeds_of(name), random.Random(1)
    made = [mutators.structured(choose.choice(seeds), target, seeds, choose) for _ in range(60)]
    assert len(set(made) - set(seeds)) > 40
    codes = set()
    for data in made:
        try:
            target.read(data)
            codes.add("read")
        except Error as refusal:
            codes.add(refusal.code)
    assert len(codes) > 1, codes


def read_with_a_fault(data):
    if b"7" in data:
        raise KeyError("seven")


def test_a_fault_is_found_and_its_input_kept_without_atheris(tmp_path, monkeypatch):
    target = targets.Target(read_with_a_fault, lambda: iter([b"1 2 3"]), words=("7",))
    monkeypatch.setitem(targets.TARGETS, "faulty", target)
    monkeypatch.setattr(fuzz_target, "atheris", None)
    with warnings.catch_warnings():
        try:
            status = fuzz_target.main(["", "faulty", "-runs=2000", "-seed=1", f"-artifact_prefix={tmp_path}/"])
        finally:
            logging.disable(logging.NOTSET)
    assert status == 77
    (kept,) = tmp_path.iterdir()
    assert b"7" in kept.read_bytes()


@pytest.mark.parametrize("text, code", [("two\nlines", "a"), ("a" * 9000, "a"), ("no code", ""), ("\x1b[2J", "a")])
def test_a_very_long_refusal_or_one_without_code_is_a_finding(text, code):
    def read(data):
        raise Error(text, code=code)

    with pytest.raises(targets.PropertyBrokenError):
        targets.judged(targets.Target(read, lambda: iter([b""])), b"")
