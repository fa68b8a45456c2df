"""Words that the languages of the backends keep: no robot, wheel or parameter may bear them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Reserved:
    """Words, in lower case, and why no name may be one of them."""

    words: frozenset[str]
    why: str


def reserved(words: str, why: str) -> Reserved:
    """The words of a text, separated by white space."""
    return Reserved(frozenset(words.split()), why)


C = reserved(
    """
alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor bool break
case catch char class compl concept const const_cast consteval constexpr constinit continue co_await
co_return co_yield decltype default delete do double dynamic_cast else enum explicit export extern false
final float for friend goto if import inline int long module mutable namespace new noexcept not not_eq
nullptr operator or or_eq override private protected public reflexpr register reinterpret_cast requires
restrict return short signed sizeof static static_assert static_cast struct switch synchronized template
this thread_local throw true try typedef typeid typename typeof typeof_unqual union unsigned using virtual
void volatile wchar_t while xor xor_eq main fortran unix linux near far errno offsetof complex imaginary
""",
    "C or C++ keeps that word for itself.",
)
C_LIBRARY = reserved(
    """
acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 exp10 expm1 fabs fdim
floor fma fmax fmin fmod frexp gamma hypot ilogb j0 j1 jn ldexp lgamma llrint llround log log10 log1p log2
logb lrint lround modf nearbyint nextafter nexttoward pow pow10 powi remainder remquo rint round roundeven
scalbln scalbn scalb sin sincos sinh sqrt tan tanh tgamma trunc y0 y1 yn drem finite significand signbit
isnan isinf isfinite isnormal fpclassify signgam abs labs llabs div ldiv lldiv min max clearerr fclose
feof ferror fflush fgetc fgetpos fgets fopen fprintf fputc fputs fread freopen fscanf fseek fsetpos ftell
fwrite getc getchar gets perror printf putc putchar puts remove rename rewind scanf setbuf setvbuf
snprintf sprintf sscanf tmpfile tmpnam ungetc vfprintf vfscanf vprintf vscanf vsnprintf vsprintf vsscanf
stdin stdout stderr dprintf getline getdelim fileno fdopen popen pclose abort atexit atof atoi atol atoll
bsearch calloc exit free getenv malloc mblen mbstowcs mbtowc qsort rand realloc srand strtod strtof strtol
strtold strtoll strtoul strtoull system wcstombs wctomb random srandom memchr memcmp memcpy memmove memset
strcat strchr strcmp strcoll strcpy strcspn strerror strlen strncat strncmp strncpy strpbrk strrchr strspn
strstr strtok strxfrm index rindex bcmp bcopy bzero asctime clock ctime difftime gmtime localtime mktime
strftime time signal raise setjmp longjmp
""",
    "The C library has a function or variable of that name.",
)
PYTHON = reserved(
    """
and as assert async await break class continue def del elif else except false finally for from global if
import in is lambda none nonlocal not or pass raise return true try while with yield
""",
    "Python keeps that word for itself.",
)
CASADI = reserved("null jac hess nan inf infinity", "CasADi keeps that word for itself.")
