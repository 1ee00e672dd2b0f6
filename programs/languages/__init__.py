"""The languages that functions are written in: one file for each, and one line in the registry.

A `Language` says how code is spelled: types, literals, functions, signatures and reserved words. It
knows nothing of what a function computes. A new language also needs a toolchain, which compiles
and runs its code (programs/toolchains).
"""

from programs.languages.registry import LANGUAGES as LANGUAGES
from programs.languages.registry import language as language
from programs.languages.registry import language_of_file as language_of_file
from programs.languages.registry import precision_of as precision_of
from programs.languages.registry import require_suffix as require_suffix
from programs.languages.spelling import Language as Language
from programs.languages.spelling import Precedence as Precedence
from programs.languages.spelling import Spelling as Spelling
from programs.languages.spelling import shortest_decimal as shortest_decimal
from programs.precision import PRECISIONS as PRECISIONS
