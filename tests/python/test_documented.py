"""Everything public is documented: names, parameters, results and errors."""

import inspect
import re
from operator import attrgetter

import pytest

import brushsvg

MODULES = ("laws",)
NAMES = sorted(
    {name for name in brushsvg.__all__ if name not in ("__version__", *MODULES)}
    | {f"{module}.{name}" for module in MODULES for name in getattr(brushsvg, module).__all__}
)
FUNCTIONS = [name for name in NAMES if not inspect.isclass(attrgetter(name)(brushsvg))]
IN_PYTHON = [name for name in FUNCTIONS if inspect.isfunction(attrgetter(name)(brushsvg))]
OF_LAWS = [name for name in IN_PYTHON if name.startswith("laws.")]


def words_of(name: str) -> str:
    found = inspect.getdoc(attrgetter(name)(brushsvg)) or ""
    return re.sub(r"^\w+\(.*\) -> .*$", "", found, flags=re.M).strip()  # without pybind11's signature


@pytest.mark.parametrize("name", NAMES)
def test_every_public_name_has_a_docstring(name):
    assert len(words_of(name).split()) >= 3, f"{name}: {words_of(name)!r}"
    if inspect.isclass(attrgetter(name)(brushsvg)):
        assert not words_of(name).startswith(f"{name.split('.')[-1]}("), "that is its signature"


@pytest.mark.parametrize("name", [name for name in NAMES if name in FUNCTIONS or name.startswith("laws.B")])
def test_every_public_method_has_a_docstring(name):
    thing = attrgetter(name)(brushsvg)
    for method, body in vars(thing).items() if inspect.isclass(thing) else ():
        if not method.startswith("_") and inspect.isfunction(body):
            assert body.__doc__, f"{name}.{method}"


@pytest.mark.parametrize("name", OF_LAWS)
def test_a_law_documents_shapes_errors_and_each_of_its_arguments(name):
    law = attrgetter(name)(brushsvg)
    reported = words_of(name)
    assert "Raises Error" in reported
    assert re.search(r"\(\.\.\.|\(n", reported), "no shape"
    for argument in inspect.signature(law).parameters:
        assert re.search(rf"\b{argument}\b", reported), f"{argument} is not described"
    assert re.search(r"\((\d+)\)|section \d|Theorem \d|Lemma", reported), "no source"


@pytest.mark.parametrize("name", ["Brush", "Profile", "Footprint", "FootprintTable"])
def test_each_field_and_method_of_a_brush_is_described(name):
    """Each field and method of a brush is described.

    The description is its own docstring or part of its class's docstring.
    """
    kind = getattr(brushsvg, name)
    for field, body in vars(kind).items():
        if field.startswith("_"):
            continue
        own = re.sub(r"^\w+\(.*\) -> .*$", "", inspect.getdoc(body) or "", flags=re.M).strip()
        assert own or re.search(rf"\b{field}\b", words_of(name)), f"{name}.{field}"
