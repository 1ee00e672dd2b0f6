"""Errors of toolchains: code that fails, tools that are missing, invalid inputs."""

import subprocess
import sys

import numpy as np
import pytest

from programs.functions import Function, Parameter
from programs.toolchains import (
    TOOLCHAINS,
    ToolchainError,
    device,
    osl,
    process,
    toolchain,
)
from tests.programs.toys import ready

pytestmark = pytest.mark.usefixtures("clean_folder")

RATIO = Function("Ratio", "one in, one out", (Parameter("x", (-1.0, 1.0)),), None, "y", lambda x: x)
MEAN = Function(
    "Mean", "an array in", (Parameter("c", (-1.0, 1.0), size=2),), None, "y", lambda c: c
)
C_LIKE = "float Ratio(float x) { return (1.0f + 0.5f * x) / (2.0f + x * x); }\n"
PLAIN = C_LIKE.replace("f *", " *").replace("f +", " +")
CODE = {
    "c": C_LIKE,
    "cpp": C_LIKE,
    "hlsl": C_LIKE,
    "glsl": C_LIKE,
    "glsl-es": PLAIN,
    "slang": C_LIKE,
    "metal": f"#include <metal_stdlib>\nusing namespace metal;\n{C_LIKE}",
    "wgsl": "fn Ratio(x: f32) -> f32 { return (1.0 + 0.5 * x) / (2.0 + x * x); }\n",
    "osl": PLAIN,
    "cuda": f"__host__ __device__ {C_LIKE}",
    "python": "import numpy as np\ndef Ratio(x):\n"
    "    return (np.float32(1) + np.float32(0.5) * x) / (np.float32(2) + x * x)\n",
    "javascript": "function Ratio(x) { return (1.0 + 0.5 * x) / (2.0 + x * x); }\n",
}
ZERO = np.zeros((1, 1))


@pytest.mark.parametrize("language", CODE)
def test_a_compile_error_has_the_compiler_s_message(language):
    precision = "double" if language == "javascript" else "float"
    chain = ready(language, precision)
    wrong = CODE[language].replace("x * x", "x * undeclared")
    with pytest.raises(ToolchainError) as caught:
        chain.run(wrong, RATIO, ZERO, precision)
    assert "undeclared" in caught.value.log
    assert "Ratio" in caught.value.summary
    assert "\n" not in caught.value.summary
    assert str(caught.value) == f"{caught.value.summary}\n{caught.value.log}"


@pytest.mark.parametrize(
    ("language", "before", "after", "complaint"),
    [
        ("c", "0.5f", "0.5", "double-promotion"),
        ("cpp", "0.5f", "0.5", "double-promotion"),
        ("python", "np.float32(0.5)", "np.float64(0.5)", "float64"),
        ("metal", "0.5f", "(double)0.5f", "no double"),
        ("osl", "0.5", "0.5f", "suffix"),
        ("osl", "float Ratio", "static float Ratio", "'static'"),
        ("wgsl", "0.5", "0.5h", "f16"),
        ("glsl", "float x)", "float y)", "undeclared"),
    ],
)
def test_code_that_the_language_forbids_is_refused(language, before, after, complaint):
    text = CODE[language]
    assert before in text
    with pytest.raises(ToolchainError, match=complaint):
        ready(language, "float").run(text.replace(before, after, 1), RATIO, ZERO, "float")


def test_metal_references_need_an_address_space():
    text = "float Mean(const float (&c)[2]) { return 0.5f * (c[0] + c[1]); }\n"
    chain = ready("metal", "float")
    with pytest.raises(ToolchainError, match="address space"):
        chain.run(text, MEAN, np.ones((1, 2)), "float")
    assert chain.run(f"{text[:11]}thread {text[11:]}", MEAN, np.ones((1, 2)), "float") == 1.0


def test_osl_division_by_zero_is_zero():
    text = "float Ratio(float x) { return sqrt(x) / x; }\n"
    values = ready("osl", "float").run(text, RATIO, np.array([[-1.0], [0.0], [4.0]]), "float")
    np.testing.assert_array_equal(values[:, 0], [0.0, 0.0, 0.5])


def test_code_without_the_function_is_refused():
    text = CODE["python"].replace("Ratio", "Other")
    with pytest.raises(ToolchainError, match="no function Ratio"):
        toolchain("python").run(text, RATIO, ZERO, "float")


def test_a_missing_tool_is_a_reason_and_an_error(monkeypatch):
    monkeypatch.setenv("PATH", "")
    for module in TOOLCHAINS:
        name = f"programs.toolchains.{module}.packaged_file"
        if module in ("slang", "hlsl", "cuda"):
            monkeypatch.setattr(name, lambda package, file: None)
    monkeypatch.setattr(device, "packaged_file", lambda package, file: None)
    monkeypatch.setattr(device, "_workers", [])
    monkeypatch.setattr(osl, "renderer", lambda: None)
    reasons = {language: chain.missing("float") for language, chain in TOOLCHAINS.items()}
    assert reasons.pop("python") is None
    for language, reason in reasons.items():
        assert reason, language
        assert "\n" not in reason
        if language == "javascript":
            continue
        with pytest.raises(ToolchainError, match=f"{language} in float cannot be run here"):
            toolchain(language).run(CODE[language], RATIO, ZERO, "float")
    assert "Debian: nodejs" in (toolchain("javascript").missing("double") or "")


def test_a_machine_without_a_device_is_reported(monkeypatch):
    ready("wgsl", "float")
    monkeypatch.setenv("VK_DRIVER_FILES", "/nonexistent")
    monkeypatch.setenv("VK_ICD_FILENAMES", "/nonexistent")
    monkeypatch.setattr(device, "_workers", [])
    monkeypatch.setattr(device, "_failures", [])
    for language in ("wgsl", "glsl"):
        assert "no Vulkan" in toolchain(language).missing("float")


def test_a_worker_that_dies_is_replaced():
    chain = ready("wgsl", "float")
    device._workers[-1].process.kill()
    text = CODE["wgsl"]
    with pytest.raises(ToolchainError, match="process ended"):
        chain.run(text, RATIO, ZERO, "float")
    assert chain.run(text, RATIO, ZERO, "float") == 0.5


def test_a_program_that_exceeds_the_time_limit_is_ended():
    with pytest.raises(ToolchainError, match=r"no end after 0\.2 s"):
        process.execute(["sleep", "5"], failure="sleeping", seconds=0.2)


def test_every_tool_has_a_version_and_every_note_is_a_sentence():
    for chain in TOOLCHAINS.values():
        assert chain.note.endswith(".")
        if chain.missing("float") is None:
            assert any(letter.isdigit() for letter in chain.tool), chain.tool


def test_no_tool_is_imported_before_it_is_used():
    code = (
        "import sys, programs.toolchains; "
        "print(sorted({'wgpu', 'cffi', 'compushady', 'slangtorch'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("inputs", "precision", "complaint"),
    [
        (np.zeros((3, 2)), "float", r"shape \(3, 2\); allowed: \(n, 1\)"),
        (np.zeros(3), "float", "shape"),
        (np.zeros((0, 1)), "float", "n >= 1"),
        (np.array([[np.nan]]), "float", "finite"),
        (np.array([[1e5]]), "half", "at most 65504"),
        (ZERO, "quarter", "allowed: half, float, double"),
    ],
)
def test_invalid_inputs_are_refused(inputs, precision, complaint):
    with pytest.raises(ValueError, match=complaint):
        toolchain("python").run("", RATIO, inputs, precision)


def test_an_unknown_language_is_refused():
    with pytest.raises(ValueError, match="'fortran'; allowed: c, cpp"):
        toolchain("fortran")
