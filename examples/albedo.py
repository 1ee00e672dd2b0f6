"""Forms for measured data: the albedo in albedo.csv, with standard deviations.

shadefit refit -p examples/albedo.py --form all --out /tmp/tables
shadefit export -p examples/albedo.py /tmp/tables/albedo-total-2.json --to hlsl
"""

from shadefit import Axis, Problem, powers, table

albedo = Problem(
    "albedo",
    axes=[
        Axis("mu", 0.02, 1, "μ", meaning="v·n"),
        Axis("alpha", 0.05, 1, "α", meaning="roughness"),
    ],
    reference=table("albedo.csv", x=["NdotV", "alpha"], y="E", sigma="sigma", hold_out=5),
    symbol="E",
    shader="Albedo",
    arguments={"mu": "NdotV"},
)
for degree in (1, 2, 3):
    some = powers(degree, 2, total=True)
    albedo.rational(some, some, one=(0, 1), name=f"total-{degree}")
