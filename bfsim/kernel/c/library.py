"""Names of the C library's functions: a kernel with such a name would replace the function wherever both are linked."""

import re

_MATH = """acos asin atan atan2 cos sin tan acosh asinh atanh cosh sinh tanh exp exp2 expm1 frexp ilogb ldexp log log10 log1p log2
logb modf scalbn scalbln cbrt fabs hypot pow sqrt erf erfc lgamma tgamma ceil floor nearbyint rint lrint llrint round lround
llround trunc fmod remainder remquo copysign nan nextafter nexttoward fdim fmax fmin fma"""
_OTHERS = """isalnum isalpha isblank iscntrl isdigit isgraph islower isprint ispunct isspace isupper isxdigit tolower toupper
setlocale localeconv setjmp longjmp signal raise
remove rename tmpfile tmpnam fclose fflush fopen freopen setbuf setvbuf fprintf fscanf printf scanf snprintf sprintf sscanf vfprintf
vfscanf vprintf vscanf vsnprintf vsprintf vsscanf fgetc fgets fputc fputs getc getchar gets putc putchar puts ungetc fread fwrite
fgetpos fseek fsetpos ftell rewind clearerr feof ferror perror
atof atoi atol atoll strtod strtof strtold strtol strtoll strtoul strtoull rand srand calloc free malloc realloc abort atexit exit
getenv system bsearch qsort abs labs llabs div ldiv lldiv mblen mbtowc wctomb mbstowcs wcstombs
memcpy memmove strcpy strncpy strcat strncat memcmp strcmp strcoll strncmp strxfrm memchr strchr strcspn strpbrk strrchr strspn
strstr strtok memset strerror strlen
clock difftime mktime time asctime ctime gmtime localtime strftime"""
LIBRARY = frozenset(
    (*_OTHERS.split(), *(f"{name}{kind}" for name in _MATH.split() for kind in ("", "f", "l")))
)
"""[C99 7.1.3] Those of a hosted implementation, except functions of wide characters and complex numbers."""
RESERVED = re.compile("_[_a-z]")
"""[C99 7.1.3] The beginning of names that a program leaves to the compiler's library; `_Z...` is C++ of a program."""


def is_of_library(name: str) -> bool:
    """Whether a function in C belongs to the compiler's library, by its name."""
    return name in LIBRARY or RESERVED.match(name) is not None
