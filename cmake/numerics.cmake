# isoshell_numerics: the flags that make floating point give the same bits on every backend, and the warnings.
# All of our targets link it; nothing of it reaches users.
add_library(isoshell_numerics INTERFACE)
target_compile_options(isoshell_numerics INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off;-fno-fast-math;-Wall;-Wextra;-Wshadow>
  $<$<COMPILE_LANGUAGE:CUDA>:-fmad=false;-Xcompiler=-ffp-contract=off,-fno-fast-math,-Wall,-Wextra>)
if(ISOSHELL_STRICT)
  target_compile_options(isoshell_numerics INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-Werror> $<$<COMPILE_LANGUAGE:CUDA>:-Werror=all-warnings;-Xcompiler=-Werror>)
endif()
