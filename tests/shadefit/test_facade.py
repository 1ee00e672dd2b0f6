"""The public names: one import, none of which waits for JAX before it is used."""

import subprocess
import sys

import pytest

import shadefit


@pytest.mark.parametrize("name", shadefit.__all__)
def test_every_public_name_exists(name):
    assert getattr(shadefit, name) is not None
    assert (
        name in (shadefit.__doc__ or "")
        or name in ("Entry", "Table", "Stage", "FittedForm")
        or (name in ("table_of", "exported_values"))
    )


def test_the_import_does_not_wait_for_jax():
    code = "import sys, shadefit; print('jax' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


def test_a_table_is_loaded_and_called():
    value = shadefit.load("best/ps-40")(0.35, 0.785, 0.524, 1.571)
    exact = shadefit.PS.value(0.35, 0.785, 0.524, 1.571)
    assert value == pytest.approx(float(exact), abs=2.5e-3)
