"""E_lit, the part of uniform light that a fibre scatters to a view, by P_s and two constants.

shadefit refit -p examples/lit_fraction.py --out /tmp/tables
shadefit export -p examples/lit_fraction.py /tmp/tables/lit.json --to hlsl
"""

from quantities.fuzz import lit

e_lit = lit.LIT
