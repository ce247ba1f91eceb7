"""What the headers of `operators.h` declare and define beyond C99, in newlib 3.3 for the Blackfin and in glibc 2.36.

As GCC reads them in its GNU mode. A compiler has tried each word of the preprocessed headers: these are the ones for
which it refuses a kernel of that name.
"""

_FUNCTIONS = """drem dremf dreml finite finitef finitel fpclassify gamma gamma_r gammaf gammaf_r gammal infinity infinityf isfinite
isinf isinff isinfl isnan isnanf isnanl isnormal j0 j0f j0l j1 j1f j1l jn jnf jnl lgamma_r lgammaf_r lgammal_r scalb scalbf scalbl
signbit significand significandf significandl y0 y0f y0l y1 y1f y1l yn ynf ynl
a64l aligned_alloc alloca arc4random arc4random_buf arc4random_uniform at_quick_exit atoff cfree clearenv drand48 drand48_r ecvt
ecvt_r erand48 erand48_r fcvt fcvt_r gcvt getloadavg getsubopt initstate initstate_r itoa jrand48 jrand48_r l64a lcong48 lcong48_r
lrand48 lrand48_r mkdtemp mkstemp mkstemps mktemp mrand48 mrand48_r nrand48 nrand48_r on_exit posix_memalign pselect putenv qecvt
qecvt_r qfcvt qfcvt_r qgcvt qsort_r quick_exit rand_r random random_r reallocarray reallocf realpath rpmatch seed48 seed48_r select
setenv setstate setstate_r srand48 srand48_r srandom srandom_r strtodf strtoq strtouq unsetenv utoa valloc"""
_TYPES = """blkcnt_t blksize_t caddr_t clock_t clockid_t daddr_t dev_t div_t double_t fd_mask fd_set float_t fsblkcnt_t fsfilcnt_t
fsid_t gid_t id_t ino_t intmax_t intptr_t key_t ldiv_t lldiv_t loff_t max_align_t mode_t nlink_t off_t pid_t ptrdiff_t quad_t
register_t sigset_t size_t ssize_t suseconds_t time_t timer_t u_char u_int u_int8_t u_int16_t u_int32_t u_int64_t u_long u_quad_t
u_short uid_t uint uintmax_t uintptr_t ulong ushort wchar_t wint_t"""
DECLARED = frozenset((*_FUNCTIONS.split(), *_TYPES.split()))
"""No kernel can have these names; a local of a kernel can."""
_MACROS = """BFIN BIG_ENDIAN BYTE_ORDER EXIT_FAILURE EXIT_SUCCESS FD_CLR FD_ISSET FD_SET FD_SETSIZE FD_ZERO FP_ILOGB0 FP_ILOGBNAN
FP_INFINITE FP_NAN FP_NORMAL FP_SUBNORMAL FP_ZERO HUGE_VAL HUGE_VALF HUGE_VALL INFINITY LITTLE_ENDIAN MATH_ERREXCEPT MATH_ERRNO
MAXFLOAT MB_CUR_MAX M_1_PI M_2_PI M_2_SQRTPI M_3PI_4 M_E M_INVLN2 M_IVLN10 M_LN10 M_LN2 M_LN2HI M_LN2LO M_LOG10E M_LOG2E M_LOG2_E
M_PI M_PI_2 M_PI_4 M_SQRT1_2 M_SQRT2 M_SQRT3 M_SQRTPI M_TWOPI NAN NFDBITS PDP_ENDIAN PTRDIFF_MAX PTRDIFF_MIN RAND_MAX
SIG_ATOMIC_MAX SIG_ATOMIC_MIN SIZE_MAX WCHAR_MAX WCHAR_MIN WCONTINUED WEXITED WEXITSTATUS WIFCONTINUED WIFEXITED WIFSIGNALED
WIFSTOPPED WINT_MAX WINT_MIN WNOHANG WNOWAIT WSTOPPED WSTOPSIG WTERMSIG WUNTRACED bfin linux math_errhandling offsetof signgam
suboptarg unix"""
MACROS = frozenset(_MACROS.split())
"""Nothing in a program can have these names."""
