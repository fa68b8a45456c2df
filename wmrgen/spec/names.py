"""Names that may become identifiers of C, C++, Python and files: what is allowed and what is taken."""

from __future__ import annotations

import re

from wmrgen.spec.nodes import Scalar
from wmrgen.spec.text import quoted

_FORM = re.compile(r"[a-z][a-z0-9_]{0,30}")
NAME_PATTERN = "^[a-z][a-z0-9_]{0,30}$"

_LANGUAGE = """
alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor bool break case
catch char class compl concept const const_cast consteval constexpr constinit continue co_await co_return
co_yield decltype default delete do double dynamic_cast else enum explicit export extern false final float
for friend goto if import inline int long module mutable namespace new noexcept not not_eq nullptr operator
or or_eq override private protected public reflexpr register reinterpret_cast requires restrict return short
signed sizeof static static_assert static_cast struct switch synchronized template this thread_local throw
true try typedef typeid typename typeof typeof_unqual union unsigned using virtual void volatile wchar_t
while xor xor_eq main fortran as assert async await def del elif except from global in is lambda nonlocal
pass raise with yield none null jac hess nan inf infinity unix linux near far errno offsetof complex
imaginary
"""
_LIBRARY = """
acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 exp10 expm1 fabs fdim
floor fma fmax fmin fmod frexp gamma hypot ilogb j0 j1 jn ldexp lgamma llrint llround log log10 log1p log2
logb lrint lround modf nearbyint nextafter nexttoward pow pow10 powi remainder remquo rint round roundeven
scalbln scalbn scalb sin sincos sinh sqrt tan tanh tgamma trunc y0 y1 yn drem finite significand signbit
isnan isinf isfinite isnormal fpclassify signgam abs labs llabs div ldiv lldiv min max clearerr fclose feof
ferror fflush fgetc fgetpos fgets fopen fprintf fputc fputs fread freopen fscanf fseek fsetpos ftell fwrite
getc getchar gets perror printf putc putchar puts remove rename rewind scanf setbuf setvbuf snprintf sprintf
sscanf tmpfile tmpnam ungetc vfprintf vfscanf vprintf vscanf vsnprintf vsprintf vsscanf stdin stdout stderr
dprintf getline getdelim fileno fdopen popen pclose abort atexit atof atoi atol atoll bsearch calloc exit
free getenv malloc mblen mbstowcs mbtowc qsort rand realloc srand strtod strtof strtol strtold strtoll
strtoul strtoull system wcstombs wctomb random srandom memchr memcmp memcpy memmove memset strcat strchr
strcmp strcoll strcpy strcspn strerror strlen strncat strncmp strncpy strpbrk strrchr strspn strstr strtok
strxfrm index rindex bcmp bcopy bzero asctime clock ctime difftime gmtime localtime mktime strftime time
signal raise setjmp longjmp
"""
_WINDOWS = " ".join(["con prn aux nul clock", *(f"com{i} lpt{i}" for i in range(10))])
_FILES = """
math stdio stdint stdlib stdbool string stddef stdarg float limits tgmath fenv inttypes numpy sympy casadi
wmrgen
"""

RESERVED: dict[str, str] = {}
for _words, _reason in (
    (_FILES, ""),
    (_WINDOWS, "Windows keeps that name for a device."),
    (_LIBRARY, "The C library has a function or variable of that name."),
    (_LANGUAGE, "C, C++, Python or CasADi keeps that word for itself."),
):
    if _reason:
        RESERVED.update(dict.fromkeys(_words.split(), _reason))

_FILE_NAMES = frozenset(_FILES.split())
_EXPRESSION_WORDS = frozenset(
    ["pi", "sqrt", "sin", "cos", "tan", "atan2", "vx", "vy", "omega", "slip", "x", "y", "theta", "dt"]
)


def _check(node: Scalar, what: str) -> str:
    """The name, when it is one; ``what`` says whose: robot, wheel, parameter."""
    name = node.text
    if not name:
        raise node.error(f"the {what} name is empty", "", "Write a name such as front_left.")
    if not _FORM.fullmatch(name):
        raise node.error(
            f"{quoted(name)} is not a valid {what} name",
            "Names become identifiers of generated C: [a-z][a-z0-9_]*, at most 31 characters.",
            f"Write {quoted(_repaired(name))}." if _repaired(name) else "Write a name such as front_left.",
        )
    reason = RESERVED.get(name, "")
    if "__" in name:
        reason = "C++ keeps names with a double underscore for the implementation."
    if name.endswith("_t"):
        reason = "POSIX keeps names that end in _t for types."
    if reason:
        raise node.error(
            f"the {what} name {quoted(name)} is reserved", reason, f"Write {quoted(_free(name))}."
        )
    return name


def _free(name: str) -> str:
    """A name near a reserved one that is not reserved."""
    return re.sub(r"__+", "_", name.removesuffix("_t"))[:28].rstrip("_") + "_1"


def _repaired(name: str) -> str:
    """A valid name near ``name``, or nothing."""
    near = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:31].rstrip("_")
    return near if _FORM.fullmatch(near) and near not in RESERVED and not near.endswith("_t") else ""


def robot_name(node: Scalar) -> str:
    """A robot's name, which also names its files and folder."""
    if node.text == "textbook":
        raise node.error(
            "the robot name 'textbook' is reserved",
            "Beside the robots' folders, `wmrgen textbook` writes a folder of that name: one would replace the other.",
            "Write textbook_robot.",
        )
    if node.text in _FILE_NAMES:
        raise node.error(
            f"the robot name {quoted(node.text)} is reserved",
            "The generated files would be taken for a standard header or module.",
            f"Write {node.text}_robot.",
        )
    return _check(node, "robot")


def wheel_name(node: Scalar) -> str:
    return _check(node, "wheel")


def parameter_name(node: Scalar) -> str:
    """A parameter's name, which must not be a word of expressions or of the contract either."""
    if node.text in _EXPRESSION_WORDS or re.fullmatch(r"eta[0-9]+", node.text):
        raise node.error(
            f"the parameter name {quoted(node.text)} is reserved",
            "Expressions or the inputs and outputs of the model use that word already.",
            f"Write {node.text}_0 or a longer name." if node.text != "pi" else "Use pi as it is.",
        )
    return _check(node, "parameter")
