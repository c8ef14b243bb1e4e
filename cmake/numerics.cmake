# isoshell_numerics: the flags that make floating point give the same bits on every backend, and the warnings.
# All of our targets link it; nothing of it reaches users.
add_library(isoshell_numerics INTERFACE)
target_compile_options(isoshell_numerics INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off;-fno-fast-math;-Wall;-Wextra;-Wshadow>
  $<$<COMPILE_LANGUAGE:CUDA>:-fmad=false;-Xcompiler=-ffp-contract=off,-fno-fast-math,-Wall,-Wextra>)
# Bit counts and integer minima in single instructions: any x86 processor since 2009. Hot loops choose wider ones at run time.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT CMAKE_CXX_FLAGS MATCHES "-march=")
  target_compile_options(isoshell_numerics INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-march=x86-64-v2> $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-march=x86-64-v2>)
endif()
if(ISOSHELL_STRICT)
  target_compile_options(isoshell_numerics INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-Werror> $<$<COMPILE_LANGUAGE:CUDA>:-Werror=all-warnings;-Xcompiler=-Werror>)
endif()
