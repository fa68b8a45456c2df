"""The words that languages, their libraries and operating systems reserve, which no name may be."""

from __future__ import annotations

import re
from keyword import kwlist
from typing import NamedTuple


class Reserved(NamedTuple):
    """Words that one language or library reserves."""

    words: frozenset[str]  # in lower case; no name may be one of them in any case
    why: str  # in a sentence
    exact: str = ""  # a pattern of further words, which are reserved in upper case only

    def keeps(self, name: str) -> bool:
        """Return whether a name is one of the words."""
        return name.lower() in self.words or (name.isupper() and bool(re.fullmatch(self.exact, name)))


def reserved(words: str, why: str, exact: str = "") -> Reserved:
    """Make a record of reserved words.

    Args:
        words: The words in lower case, separated by white space.
        why: Why they are reserved, in a sentence.
        exact: A pattern of further words, which are reserved in upper case only.
    """
    return Reserved(frozenset(words.split()), why, exact)


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
strftime time signal raise setjmp longjmp bufsiz eof exit_failure exit_success huge_val huge_valf huge_vall maxfloat
math_errhandling null seek_cur seek_end seek_set
""",
    "The C library has a function, variable or macro of that name.",
    r"M_(E|PI|PI_2|PI_4|1_PI|2_PI|3PI_4|TWOPI|SQRTPI|2_SQRTPI|SQRT2|SQRT3|SQRT1_2|LN2|LN2HI|LN2LO|LN10|LOG2_?E|LOG10E|"
    r"INVLN2|IVLN10)|FP_[A-Z0-9]+|MATH_ERR(NO|EXCEPT)|(FLT|DBL|LDBL)_[A-Z0-9_]+|DECIMAL_DIG|CHAR_BIT|MB_LEN_MAX|"
    r"([SU]?CHAR|U?SHRT|U?INT(_LEAST|_FAST)?(8|16|32|64)?|U?LL?ONG|U?INT(MAX|PTR)|PTRDIFF|SIZE|SSIZE|SIG_ATOMIC|WCHAR|"
    r"WINT)_(MIN|MAX|WIDTH)",
)
# Macros of the nine usual AVR chips that have at most three letters, or that could be the name of a wheel or parameter.
# Wheels and parameters may have these names: the generated header reports an error where such a macro is defined. A
# robot may not, because its name is used without a prefix.
AVR_MACROS = Reserved(
    frozenset(),
    "avr-libc or the Arduino core has a macro of that name.",
    (
        "B[01]{1,8}|P[A-L][0-7]|DD[A-L]?[0-7]|(PORT|PIN)([0-7]|[A-L][0-7]?)|DDR[A-L]|[XYZ][HL]|SP[EHL]?|S[EM]|SM[0-2]|"
        "PE|PI|ID|AVR|AC[DIO]|ADC[HLW]?|AS[0-2]|BIN|OCT|DEC|HEX|NAN|EOF|DT[1-8]|IPR|ISR|JTD|LSM|PRR[0-2]?|PUD|RCE|SRE|"
        "TSM|WDE|INT[0-7]|(DOR|FE|RXC|TXC|U2X|UDR)[0-3]?|(CAL|MUX|TWA|TWD|TWS)[0-7]|CS[0-5][0-3]|(ICR|OCR|TCNT)[0-5]"
        "[A-D]?[HL]?|TCCR[0-5][A-E]?|ALLOC|ARDUINO|CHANGE|DEFAULT|DETACH|DISPLAY|EULER|EXTERNAL|FALLING|FUSES|HIGH|HOST|"
        "INFINITY|INPUT|INTERNAL|LOCKBITS|LOW|NULL|OUTPUT|PROGMEM|RISING|SERIAL|SPEED|VBUS"
    ),
)
PYTHON = Reserved(frozenset(map(str.lower, kwlist)), "Python keeps that word for itself.")
# Rust code can use its other words as r#box.
RUST = reserved("crate self super", "Rust keeps that word for itself.")
JAVASCRIPT = reserved(
    "constructor hasownproperty isprototypeof propertyisenumerable tolocalestring tostring valueof",
    "Every object of JavaScript has a property of that name.",
)
CASADI = reserved("null jac hess nan inf infinity", "CasADi keeps that word for itself.")

# Names of Windows devices, which no file may have.
DEVICES = {*"con prn aux nul clock".split(), *(f"com{i}" for i in range(10)), *(f"lpt{i}" for i in range(10))}
# Headers and modules that the files of a robot of this name would hide.
FILE_NAMES = {
    *"math stdio stdint stdlib stdbool string stddef stdarg float limits tgmath fenv inttypes".split(),
    *"numpy sympy casadi wmrgen".split(),
}
# C++ namespaces, functions of POSIX and Arduino, and Rust crates.
NAMES_OF_LIBRARIES = {
    *"std boost eigen ros rclcpp rcl rclpy rmw ament tf2 alloc core".split(),
    *"accept access alarm bind brk chdir chmod chown close connect creat crypt daemon dup execl execv execve fcntl "
    "fork fsync getpid ioctl kill link listen lockf lseek mkdir mount nice open pause pipe poll pread pwrite read "
    "readlink reboot recv rmdir sbrk select send sleep socket stat swab symlink sync syscall truncate umask umount "
    "unlink usleep vfork wait waitpid write delay loop micros millis setup".split(),
}
# Words of expressions, and inputs and outputs of models: no parameter may have them.
EXPRESSION_WORDS = {*"pi sqrt sin cos tan atan2".split()}
MODEL_WORDS = {*"vx vy omega slip x y theta dt".split()}


LANGUAGES: dict[str, tuple[Reserved, ...]] = {  # by the name of the back end for the language
    "c99": (C, C_LIBRARY),
    "numpy": (PYTHON,),
    "casadi": (CASADI,),
    "rust": (RUST,),
    "javascript": (JAVASCRIPT,),
}


def why_reserved(name: str) -> str:
    """Return why ``name`` may not be a name, for the first language that reserves it; empty if no language does."""
    for records in LANGUAGES.values():
        for record in records:
            if record.keeps(name):
                return record.why
    return ""
