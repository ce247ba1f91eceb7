"""What guards call when a kernel runs, as LLVM IR: each fails with the number of its guard and two values, or returns."""

from __future__ import annotations

FAIL = """
declare void @longjmp(ptr, i32) noreturn
define internal void @bfsim.fail(i64 %number, i64 %first, i64 %second) cold noinline noreturn {{
  store i64 %number, ptr {note}
  store i64 %first, ptr getelementptr (i64, ptr {note}, i64 1)
  store i64 %second, ptr getelementptr (i64, ptr {note}, i64 2)
  call void @longjmp(ptr @bfsim.return, i32 1)
  unreachable
}}
"""
ELEMENT = """
define internal ptr @bfsim.element.{kind}(ptr %array, i32 %length, i64 %distance, i64 %number) alwaysinline {{
  %elements = ashr i64 %distance, {shift}
  %index = trunc i64 %elements to i32
  %is_inside = icmp ult i32 %index, %length
  %position = zext i32 %index to i64
  br i1 %is_inside, label %inside, label %outside
outside:
  %size = zext i32 %length to i64
  call void @bfsim.fail(i64 %number, i64 %position, i64 %size)
  unreachable
inside:
  %address = getelementptr {kind}, ptr %array, i64 %position
  ret ptr %address
}}
"""
DIVISIBLE = """
define internal void @bfsim.divisible.{sign}.{kind}({kind} %a, {kind} %b, i64 %number) alwaysinline {{
  %zero = icmp eq {kind} %b, 0
  %low = icmp eq {kind} %a, {lowest}
  %minus = icmp eq {kind} %b, -1
  %both = and i1 %low, %minus
  %wraps = and i1 %both, {signed}
  %is_undefined = or i1 %zero, %wraps
  br i1 %is_undefined, label %undefined, label %defined
undefined:
  %first = {extend} {kind} %a to i64
  %second = {extend} {kind} %b to i64
  call void @bfsim.fail(i64 %number, i64 %first, i64 %second)
  unreachable
defined:
  ret void
}}
"""

ENDS = """
define internal void @bfsim.ends(i32 %start, i32 %stop, i32 %step, i64 %number) alwaysinline {
  %goes_up = icmp sgt i32 %step, 0
  br i1 %goes_up, label %up, label %wrong
up:
  %from = sext i32 %start to i64
  %to = sext i32 %stop to i64
  %by = zext i32 %step to i64
  %distance = sub i64 %to, %from
  %less = sub i64 %by, 1
  %rounded = add i64 %distance, %less
  %times = sdiv i64 %rounded, %by
  %way = mul i64 %times, %by
  %end = add i64 %from, %way
  %fits = icmp sle i64 %end, 2147483647
  br i1 %fits, label %right, label %wrong
wrong:
  %first = sext i32 %step to i64
  %second = sext i32 %stop to i64
  call void @bfsim.fail(i64 %number, i64 %first, i64 %second)
  unreachable
right:
  ret void
}
"""
"""A loop ends if its step is 1 or more, and if the counter that ends it does not wrap."""

SHIFTS = """
define internal void @bfsim.shifts(i32 %count, i64 %number) alwaysinline {
  %is_wrong = icmp ugt i32 %count, 31
  br i1 %is_wrong, label %wrong, label %right
wrong:
  %first = sext i32 %count to i64
  call void @bfsim.fail(i64 %number, i64 %first, i64 0)
  unreachable
right:
  ret void
}
"""
