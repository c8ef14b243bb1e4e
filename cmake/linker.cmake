# The build tree has some sixty executables with the library inside: mold, where it is installed, links them in a fifth of
# the time. What is made for others is linked by the system's own linker.
find_program(ISOSHELL_MOLD mold)
mark_as_advanced(ISOSHELL_MOLD)
if(ISOSHELL_MOLD AND ISOSHELL_TESTS AND PROJECT_IS_TOP_LEVEL)
  include(CheckLinkerFlag)
  check_linker_flag(CXX -fuse-ld=mold ISOSHELL_LINKS_WITH_MOLD)
  if(ISOSHELL_LINKS_WITH_MOLD)
    add_link_options(-fuse-ld=mold)
  endif()
endif()
