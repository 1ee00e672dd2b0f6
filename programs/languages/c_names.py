"""Names of the standard library of C and C++: macros, functions and types.

A macro replaces its name wherever it stands, so no name in exported code may be one. Functions and
types are in the way of functions, structures and namespaces only: an argument may hide them.

The lists are of C17 and C23 (ISO/IEC 9899) with the functions that POSIX and glibc add to <math.h>,
and of C++20. A test compares them with the headers of the compiler.
"""

from itertools import product

from programs.languages.spelling import words

# What follows INT in the names of integer types and their limits: INT8_MAX, INT_FAST8_MAX, …
_INTEGER_WIDTHS = [
    *map(str, (8, 16, 32, 64)),
    *(f"{kind}{width}" for kind in ("_FAST", "_LEAST") for width in (8, 16, 32, 64)),
]
# Codes of <errno.h>, without the E
_FAILURES = words(
    "2BIG ACCES ADDRINUSE ADDRNOTAVAIL ADV AFNOSUPPORT AGAIN ALREADY BADE BADF BADFD BADMSG BADR",
    "BADRQC BADSLT BFONT BUSY CANCELED CHILD CHRNG COMM CONNABORTED CONNREFUSED CONNRESET DEADLK",
    "DEADLOCK DESTADDRREQ DOM DOTDOT DQUOT EXIST FAULT FBIG HOSTDOWN HOSTUNREACH HWPOISON IDRM",
    "ILSEQ INPROGRESS INTR INVAL IO ISCONN ISDIR ISNAM KEYEXPIRED KEYREJECTED KEYREVOKED L2HLT",
    "L2NSYNC L3HLT L3RST LIBACC LIBBAD LIBEXEC LIBMAX LIBSCN LNRNG LOOP MEDIUMTYPE MFILE MLINK",
    "MSGSIZE MULTIHOP NAMETOOLONG NAVAIL NETDOWN NETRESET NETUNREACH NFILE NOANO NOBUFS NOCSI",
    "NODATA NODEV NOENT NOEXEC NOKEY NOLCK NOLINK NOMEDIUM NOMEM NOMSG NONET NOPKG NOPROTOOPT",
    "NOSPC NOSR NOSTR NOSYS NOTBLK NOTCONN NOTDIR NOTEMPTY NOTNAM NOTRECOVERABLE NOTSOCK NOTSUP",
    "NOTTY NOTUNIQ NXIO OPNOTSUPP OVERFLOW OWNERDEAD PERM PFNOSUPPORT PIPE PROTO PROTONOSUPPORT",
    "PROTOTYPE RANGE REMCHG REMOTE REMOTEIO RESTART RFKILL ROFS SHUTDOWN SOCKTNOSUPPORT SPIPE SRCH",
    "SRMNT STALE STRPIPE TIME TIMEDOUT TOOMANYREFS TXTBSY UCLEAN UNATCH USERS WOULDBLOCK XDEV",
    "XFULL",
)
_SIGNALS = words(
    "ABRT ALRM BUS CHLD CLD CONT FPE HUP ILL INT IO IOT KILL PIPE POLL PROF PWR QUIT RTMAX RTMIN",
    "SEGV STKFLT STOP SYS TERM TRAP TSTP TTIN TTOU URG USR1 USR2 VTALRM WINCH XCPU XFSZ",
)
_INTEGERS = words(
    "CHAR SCHAR UCHAR SHRT USHRT INT UINT LONG ULONG LLONG ULLONG SIZE PTRDIFF INTMAX UINTMAX",
    "INTPTR UINTPTR SIG_ATOMIC WCHAR WINT MB_LEN",
)

# The last line has macros of <windows.h> and those that compilers define in GNU mode.
C_MACROS = frozenset(
    {f"E{code}" for code in _FAILURES}
    | {f"SIG{name}" for name in _SIGNALS}
    | {f"{kind}_{end}" for kind in _INTEGERS for end in ("MIN", "MAX")}
    | {
        f"{sign}INT{width}_{end}"
        for sign, width, end in product(("", "U"), _INTEGER_WIDTHS, ("MIN", "MAX"))
    }
    | {
        f"{way}{letter}{width.replace('_', '')}"
        for way, letters in (("PRI", "diouxX"), ("SCN", "dioux"))
        for letter, width in product(letters, [*_INTEGER_WIDTHS, "MAX", "PTR"])
    }
    | {
        f"{kind}_{limit}"
        for kind in ("FLT", "DBL", "LDBL")
        for limit in words(
            "DECIMAL_DIG DIG EPSILON HAS_SUBNORM MANT_DIG MAX MAX_10_EXP MAX_EXP MIN MIN_10_EXP",
            "MIN_EXP TRUE_MIN NORM_MAX",
        )
    }
    | {f"FE_{each}" for each in words("DFL_ENV DIVBYZERO INEXACT INVALID OVERFLOW UNDERFLOW")}
    | {f"FE_{each}" for each in words("ALL_EXCEPT DOWNWARD TONEAREST TOWARDZERO UPWARD")}
    | {f"FP_{each}" for each in words("INFINITE NAN NORMAL SUBNORMAL ZERO ILOGB0 ILOGBNAN")}
    | {f"FP_FAST_FMA{suffix}" for suffix in ("", "F", "L")}
    | {f"ATOMIC_{each}_LOCK_FREE" for each in words("BOOL CHAR CHAR16_T CHAR32_T INT LLONG LONG")}
    | {f"ATOMIC_{each}_LOCK_FREE" for each in words("POINTER SHORT WCHAR_T")}
    | {f"LC_{each}" for each in words("ADDRESS ALL COLLATE CTYPE IDENTIFICATION MEASUREMENT")}
    | {f"LC_{each}" for each in words("MESSAGES MONETARY NAME NUMERIC PAPER TELEPHONE TIME")}
    | {
        f"M_{each}{kind}"
        for each in words("1_PI 2_PI 2_SQRTPI E LN10 LN2 LOG10E LOG2E PI PI_2 PI_4 SQRT1_2 SQRT2")
        for kind in ("", "f", "l", "_F", "_H")
    }
) | words(
    "ATOMIC_FLAG_INIT BUFSIZ CHAR_BIT CLOCKS_PER_SEC DECIMAL_DIG EOF EXIT_FAILURE EXIT_SUCCESS",
    "FILENAME_MAX FLT_EVAL_METHOD FLT_RADIX FLT_ROUNDS FOPEN_MAX HUGE HUGE_VAL HUGE_VALF HUGE_VALL",
    "HUGE_VALH I INFINITY L_tmpnam MATH_ERREXCEPT MATH_ERRNO MAXFLOAT MB_CUR_MAX NAN NULL",
    "ONCE_FLAG_INIT RAND_MAX SEEK_CUR SEEK_END SEEK_SET SIG_DFL SIG_ERR SIG_IGN SNAN SNANF SNANL",
    "FP_INT_DOWNWARD FP_INT_TONEAREST FP_INT_TONEARESTFROMZERO FP_INT_TOWARDZERO FP_INT_UPWARD",
    "FP_LLOGB0 FP_LLOGBNAN TIME_UTC TMP_MAX TSS_DTOR_ITERATIONS WEOF alignas alignof bool complex",
    "errno false imaginary math_errhandling noreturn signgam static_assert stderr stdin stdout",
    "thread_local true NDEBUG OPTIONAL VOID far i386 interface linux near unix",
)

# Each has a version for float, with f at the end, and one for long double, with l.
_OF_THREE_TYPES = words(
    "acos acosh acospi asin asinh asinpi atan atan2 atan2pi atanh atanpi cabs cacos cacosh carg",
    "casin casinh catan catanh cbrt ccos ccosh ceil cexp cimag clog conj copysign cos cosh cospi",
    "cpow cproj creal csin csinh csqrt ctan ctanh drem erf erfc exp exp10 exp2 expm1 fabs fdim",
    "finite floor fma fmax fmin fmod frexp gamma hypot ilogb isinf isnan j0 j1 jn ldexp lgamma",
    "canonicalize fmaximum fmaximum_mag fmaximum_mag_num fmaximum_num fminimum fminimum_mag",
    "fminimum_mag_num fminimum_num fadd fdiv ffma fmul fromfp fromfpx fsqrt fsub ufromfp ufromfpx",
    "llogb llrint llround log log10 log1p log2 logb lrint lround modf nan nearbyint nextafter",
    "nextdown nexttoward nextup pow pow10 remainder remquo rint round roundeven rsqrt scalb",
    "scalbln scalbn significand sin sincos sinh sinpi sqrt tan tanh tanpi tgamma trunc y0 y1 yn",
)
_FUNCTIONS = words(
    "CMPLX CMPLXF CMPLXL abort abs aligned_alloc asctime assert at_quick_exit atexit atof atoi",
    "atol atoll bcmp bcopy bsearch btowc bzero c16rtomb c32rtomb call_once calloc clearerr clock",
    "ctime difftime div exit fclose feclearexcept fegetenv fegetexceptflag fegetround feholdexcept",
    "feof feraiseexcept ferror fesetenv fesetexceptflag fesetround fetestexcept feupdateenv fflush",
    "ffs fgetc fgetpos fgets fgetwc fgetws fopen fpclassify fprintf fputc fputs fputwc fputws",
    "fread free freopen fscanf fseek fsetpos ftell fwide fwprintf fwrite fwscanf getc getchar",
    "getenv gets getwc getwchar gmtime imaxabs imaxdiv index isalnum isalpha isascii isblank",
    "iscntrl isdigit isfinite isgraph isgreater isgreaterequal isless islessequal islessgreater",
    "islower isnormal daddl ddivl dfmal dmull dsqrtl dsubl iscanonical iseqsig issignaling",
    "issubnormal iszero isprint ispunct isspace isunordered isupper iswalnum iswalpha iswblank",
    "iswcntrl iswctype iswdigit iswgraph iswlower iswprint iswpunct iswspace iswupper iswxdigit",
    "isxdigit kill_dependency labs ldiv lgamma_r lgammaf_r lgammal_r llabs lldiv localeconv",
    "localtime longjmp malloc mblen mbrlen mbrtoc16 mbrtoc32 mbrtowc mbsinit mbsrtowcs mbstowcs",
    "mbtowc memchr memcmp memcpy memmove memset mktime offsetof perror printf putc putchar puts",
    "putwc putwchar qsort quick_exit raise rand random realloc remove rename rewind rindex scanf",
    "setbuf setjmp setlocale setvbuf signal signbit snprintf sprintf srand srandom sscanf",
    "strcasecmp strcat strchr strcmp strcoll strcpy strcspn strdup strerror strftime strlen",
    "strncasecmp strncat strncmp strncpy strndup strpbrk strrchr strspn strstr strtod strtof",
    "strtoimax strtok strtol strtold strtoll strtoul strtoull strtoumax strxfrm swprintf swscanf",
    "system time timespec_get tmpfile tmpnam toascii tolower toupper towctrans towlower towupper",
    "ungetc ungetwc va_arg va_copy va_end va_start vfprintf vfscanf vfwprintf vfwscanf vprintf",
    "vscanf vsnprintf vsprintf vsscanf vswprintf vswscanf vwprintf vwscanf wcrtomb wcscat wcschr",
    "wcscmp wcscoll wcscpy wcscspn wcsftime wcslen wcsncat wcsncmp wcsncpy wcspbrk wcsrchr",
    "wcsrtombs wcsspn wcsstr wcstod wcstof wcstoimax wcstok wcstol wcstold wcstoll wcstombs",
    "wcstoul wcstoull wcstoumax wcsxfrm wctob wctomb wctrans wctype wmemchr wmemcmp wmemcpy",
    "wmemmove wmemset wprintf wscanf alloca ffsl ffsll read write open close link unlink access",
    "pipe sleep usleep pause select accept bind connect listen send recv",
)
_ATOMIC = (
    "compare_exchange_strong compare_exchange_weak exchange fetch_add fetch_and fetch_or fetch_sub",
    "fetch_xor flag_clear flag_test_and_set load store",
)
_THREADS = {
    "cnd": "broadcast destroy init signal t timedwait wait",
    "mtx": "destroy init lock plain recursive t timed timedlock trylock unlock",
    "thrd": "busy create current detach equal error exit join nomem sleep start_t success t"
    " timedout yield",
    "tss": "create delete dtor_t get set t",
    "memory_order": "acq_rel acquire consume relaxed release seq_cst",
}
_TYPES = words(
    "FILE clock_t div_t double_t fenv_t fexcept_t float_t fpos_t imaxdiv_t intmax_t intptr_t",
    "jmp_buf ldiv_t lldiv_t max_align_t mbstate_t memory_order nullptr_t once_flag ptrdiff_t",
    "sig_atomic_t size_t ssize_t time_t tm timespec lconv uintmax_t uintptr_t va_list wchar_t",
    "wctrans_t wctype_t wint_t char16_t char32_t",
) | {f"{sign}int{width.lower()}_t" for sign, width in product(("", "u"), _INTEGER_WIDTHS)}

C_LIBRARY = (
    _FUNCTIONS
    | _TYPES
    | {name + suffix for name, suffix in product(_OF_THREE_TYPES, ("", "f", "l"))}
    | {f"atomic_{each}{how}" for each in words(*_ATOMIC) for how in ("", "_explicit")}
    | {f"atomic_{each}" for each in words("init is_lock_free signal_fence thread_fence flag bool")}
    | {f"atomic_{each.removesuffix('_t')}_t" for each in _TYPES if each.endswith("_t")}
    | {f"atomic_{sign}{each}" for each in words("char short int long llong") for sign in ("", "u")}
    | {"atomic_schar"}
    | {f"{group}_{each}" for group, names in _THREADS.items() for each in names.split()}
    | {f"{sign}INT{width}_C" for sign in ("", "U") for width in (8, 16, 32, 64, "MAX")}
    | {"ATOMIC_VAR_INIT"}
)

# Functions of C++ that "using namespace std" brings in, and macros of <windows.h>
CPP_LIBRARY = C_LIBRARY | words(
    "accumulate advance all_of any_of array assoc_laguerre assoc_laguerref assoc_laguerrel",
    "assoc_legendre assoc_legendref assoc_legendrel atomic begin beta betaf betal bind bitset byte",
    "cbegin cend cerr cin clamp clog comp_ellint_1 comp_ellint_1f comp_ellint_1l comp_ellint_2",
    "comp_ellint_2f comp_ellint_2l comp_ellint_3 comp_ellint_3f comp_ellint_3l copy count count_if",
    "cout cyl_bessel_i cyl_bessel_if cyl_bessel_il cyl_bessel_j cyl_bessel_jf cyl_bessel_jl",
    "cyl_bessel_k cyl_bessel_kf cyl_bessel_kl cyl_neumann cyl_neumannf cyl_neumannl data deque",
    "distance ellint_1 ellint_1f ellint_1l ellint_2 ellint_2f ellint_2l ellint_3 ellint_3f",
    "ellint_3l empty end endl equal exchange expint expintf expintl fill find find_if for_each",
    "forward function gcd generate get hash hermite hermitef hermitel hypot iota laguerre",
    "laguerref laguerrel lcm legendre legendref legendrel lerp less list map max max_element merge",
    "midpoint min min_element minmax move mutex next none_of norm numeric_limits optional pair",
    "plus polar prev proj queue ranges real reduce ref remove_if replace reverse riemann_zeta",
    "riemann_zetaf riemann_zetal rotate search set shuffle size sort span sph_bessel sph_besself",
    "sph_bessell sph_legendre sph_legendref sph_legendrel sph_neumann sph_neumannf sph_neumannl",
    "stack string swap thread tie transform tuple unique unordered_map unordered_set valarray",
    "variant vector abs_diff imag arg",
)
