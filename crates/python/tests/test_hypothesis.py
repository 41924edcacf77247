"""Random input: an answer or an exception with words, ten thousand times."""

import hc
import numpy as np
import tdoa
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

# The same cases in every run.
MANY = dict(deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck))

ANYTHING = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5), st.binary(max_size=5), st.complex_numbers()),
    lambda each: st.one_of(st.lists(each, max_size=4), st.dictionaries(st.text(max_size=3), each, max_size=3)),
    max_leaves=12,
)
NUMBERS = st.one_of(st.floats(), st.floats(-1e3, 1e3), st.just(float("nan")), st.integers(-5, 5).map(float))


def check(function, *arguments, **options):
    try:
        function(*arguments, progress=False, threads=1, **options)
    except (hc.InputError, hc.UndeterminedError) as error:
        assert str(error)


@settings(max_examples=1000, **MANY)
@given(ANYTHING)
def test_anything_as_a_table(thing):
    check(tdoa.solve, thing)
    check(tdoa.calibrate, thing, max_starts=1)


@settings(max_examples=1000, **MANY)
@given(st.integers(1, 7), st.integers(1, 6), st.data())
def test_tables(m, n, data):
    values = data.draw(st.lists(NUMBERS, min_size=m * n, max_size=m * n))
    table = np.array(values).reshape(m, n)
    if data.draw(st.booleans()):
        table = np.asfortranarray(table)
    check(tdoa.calibrate, table, max_starts=1, sigma=data.draw(st.one_of(st.none(), NUMBERS)))
    if m * n <= 12:
        check(tdoa.solve, table)


ALPHABET = st.text(alphabet="xyzi0123456789.+-*/^²⁻·−()=;:,# \n\"[]eE", max_size=30)


@settings(max_examples=4000, **MANY)
@given(st.one_of(ALPHABET, st.lists(ALPHABET, max_size=3), ANYTHING))
def test_anything_as_a_system(thing):
    check(hc.solve, thing, max_paths=64)
    check(hc.mixed_volume, thing)


@settings(max_examples=4000, **MANY)
@given(ANYTHING, ANYTHING)
def test_anything_as_arguments(thing, other):
    family = _family()
    check(family.track, thing)
    check(hc.certify, ["x^2 - 2"], thing)
    check(hc.solve, ["x^2 - 2"], seed=thing, max_paths=other)
    check(tdoa.calibrate, TABLE, anchors=thing, max_starts=1) if not isinstance(thing, (bool, int)) else None
    check(tdoa.calibrate, TABLE, names=thing, sigma=other, max_starts=1)


TABLE = np.arange(12.0).reshape(3, 4)


def _family(kept=[]):
    if not kept:
        kept.append(hc.Family(["x^2 - a*x + b"], "x", "a b", roots=2))
        kept[0].monodromy()
    return kept[0]
