"""What the descendants of C have in common: the words, the functions, the way to select."""

from programs.languages.spelling import Precedence, Spelling, words

SELECTION = {"select": Spelling("{0} ? {1} : {2}", Precedence.SELECTION)}

# C has no cheap minimum: fminf is a call that must mind NaN. A comparison is one instruction.
COMPARED = {
    "min": Spelling("{0} < {1} ? {0} : {1}", Precedence.SELECTION, atoms=True),
    "max": Spelling("{0} > {1} ? {0} : {1}", Precedence.SELECTION, atoms=True),
}

# Functions that go by the same name in every shading language that has a common ancestor in C.
SHADING = {
    name: name
    for name in words(
        "abs sqrt min max floor ceil exp exp2 log pow sin cos tan asin acos atan sinh cosh tanh"
    )
}

# The functions of <math.h>, by the operation.
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
    """Give every function of a table its suffix, as C marks the precision of its functions."""
    return {operation: name + suffix for operation, name in names.items()}


def reciprocal_root(one: str, root: str) -> dict[str, Spelling]:
    """Spell the reciprocal square root where there is no function for it."""
    return {"rsqrt": Spelling(f"{one} / {root}({{0}})", Precedence.PRODUCT)}
