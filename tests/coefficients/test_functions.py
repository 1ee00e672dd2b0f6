"""All functions that are exported but not fitted: their code in every language, and their names."""

import pytest

from coefficients.catalogue import exported_functions, resolve
from coefficients.exported_code import trial_of
from programs import LANGUAGES, check, precision_of, toolchain
from quantities import problems

# 2¹² rows of arguments each
EXPONENT = 12


@pytest.mark.slow
@pytest.mark.parametrize("key", LANGUAGES)
@pytest.mark.parametrize("name", exported_functions())
def test_code_passes_in_every_language(name, key):
    precision = precision_of(key, None)
    reason = toolchain(key).missing(precision)
    if reason is not None:
        pytest.skip(reason)
    result = check(trial_of(resolve(name), precision, EXPONENT), key)
    assert result.status == "passed", result.reason


def test_functions_are_no_quantities():
    own = {name.partition("/")[2] for name in exported_functions()}
    assert len(own) == len(exported_functions()) and not own & set(problems())


@pytest.mark.parametrize("kind", sorted({name.partition("/")[0] for name in exported_functions()}))
def test_other_names_are_refused_with_those_of_their_kind(kind):
    with pytest.raises(ValueError, match=f"no function is called '{kind}/x': allowed") as caught:
        resolve(f"{kind}/x")
    allowed = str(caught.value).partition("allowed are ")[2].split(", ")
    assert allowed == [name for name in exported_functions() if name.startswith(f"{kind}/")]
