"""What languages derived from C have in common: reserved words, functions and selections."""

from programs.languages.spelling import Precedence, Spelling, words

SELECTION = {"select": Spelling("{0} ? {1} : {2}", Precedence.SELECTION)}

# In C, fminf is a slow call, since it must treat NaN. A comparison compiles to one instruction.
COMPARED = {
    "min": Spelling("{0} < {1} ? {0} : {1}", Precedence.SELECTION, atoms=True),
    "max": Spelling("{0} > {1} ? {0} : {1}", Precedence.SELECTION, atoms=True),
}

# Functions that have the same name in all shading languages derived from C
SHADING = {
    name: name
    for name in words(
        "abs sqrt min max floor ceil exp exp2 log pow sin cos tan asin acos atan sinh cosh tanh"
    )
}

# Operation -> function of <math.h>
MATH = {"abs": "fabs"} | {
    name: name
    for name in words(
        "sqrt floor ceil exp exp2 expm1 log log1p pow sin cos tan asin acos atan atan2",
        "sinh cosh tanh",
    )
}

C_WORDS = words(
    "auto break case char const continue default do double else enum extern float for goto if",
    "inline int long register restrict return short signed sizeof static struct switch typedef",
    "union unsigned void volatile while _Alignas _Alignof _Atomic _Bool _Complex _Float16",
    "_Generic _Imaginary _Noreturn _Static_assert _Thread_local bool true false asm main",
    "alignas alignof constexpr nullptr static_assert thread_local typeof typeof_unqual I",
)

CPP_WORDS = C_WORDS | words(
    "and and_eq bitand bitor catch char8_t char16_t char32_t class compl concept consteval",
    "constinit const_cast co_await co_return co_yield decltype delete dynamic_cast explicit",
    "export friend mutable namespace new noexcept not not_eq operator or or_eq private protected",
    "public reinterpret_cast requires static_cast template this throw try typeid typename using",
    "virtual wchar_t xor xor_eq std",
)


def suffixed(names: dict[str, str], suffix: str) -> dict[str, str]:
    """Append a suffix to every function of a table: in C it shows the precision, as in sinf."""
    return {operation: name + suffix for operation, name in names.items()}


def reciprocal_root(one: str, root: str) -> dict[str, Spelling]:
    """Spell the reciprocal square root for a language without a function for it."""
    return {"rsqrt": Spelling(f"{one} / {root}({{0}})", Precedence.PRODUCT)}
