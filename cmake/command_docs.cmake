# Man page and completions of a command, made from its --help when it is built, and tested.
#   isoshell_command_docs(NAME [COMPONENT C] [DATADIR DIR] [COMMAND WORD...] [DEPENDS FILE...])
# isoshell_command_docs(vdb_isomesh) is all that a further program needs, beside its cases in test_command_docs.sh.
# COMMAND is what runs it where it is no program of the build, DATADIR where it is installed; without C it is not.
find_package(Python3 COMPONENTS Interpreter QUIET)
find_program(ISOSHELL_GZIP gzip)

function(isoshell_command_docs name)
  if(NOT Python3_Interpreter_FOUND OR NOT ISOSHELL_GZIP OR CMAKE_CROSSCOMPILING)
    message(STATUS "No man page and completions of ${name}: they need Python, gzip and a command that runs here")
    return()
  endif()
  cmake_parse_arguments(PARSE_ARGV 1 of "" "COMPONENT;DATADIR" "COMMAND;DEPENDS")
  if(NOT of_COMMAND)
    set(of_COMMAND $<TARGET_FILE:${name}>)
    set(of_DEPENDS ${name})
    set(of_COMPONENT runtime)
    set(of_DATADIR ${CMAKE_INSTALL_DATADIR})
  endif()
  set(folder ${PROJECT_BINARY_DIR}/command_docs)
  set(scripts ${PROJECT_SOURCE_DIR}/scripts)
  set(make ${Python3_EXECUTABLE} -B ${scripts}/command_docs.py ${of_COMMAND})
  file(MAKE_DIRECTORY ${folder})
  set(page ${folder}/${name}.1)
  add_custom_command(OUTPUT ${page} ${page}.gz ${folder}/${name}.bash ${folder}/_${name} ${folder}/${name}.fish
    COMMAND ${make} man > ${page}
    COMMAND ${ISOSHELL_GZIP} -9nc ${page} > ${page}.gz
    COMMAND ${make} bash > ${folder}/${name}.bash
    COMMAND ${make} zsh > ${folder}/_${name}
    COMMAND ${make} fish > ${folder}/${name}.fish
    DEPENDS ${of_DEPENDS} ${scripts}/command_completions.py ${scripts}/command_docs.py ${scripts}/command_help.py VERBATIM)
  add_custom_target(${name}_docs ALL DEPENDS ${page}.gz)
  if(of_COMPONENT)
    isoshell_install_command_docs(${name} ${folder} ${of_COMPONENT} ${of_DATADIR})
  endif()
  if(ISOSHELL_TESTS)
    add_test(NAME ${name}_docs COMMAND ${PROJECT_SOURCE_DIR}/tests/cli/test_command_docs.sh ${name} ${folder})
  endif()
endfunction()

function(isoshell_install_command_docs name folder component datadir)
  # Where zsh looks: Debian keeps completions of packages elsewhere, and a wheel is none.
  set(zsh_dir zsh/site-functions)
  if(EXISTS /etc/debian_version AND NOT SKBUILD)
    set(zsh_dir zsh/vendor-completions)
  endif()
  install(FILES ${folder}/${name}.1.gz DESTINATION ${datadir}/man/man1 COMPONENT ${component})
  install(FILES ${folder}/${name}.bash DESTINATION ${datadir}/bash-completion/completions RENAME ${name}
          COMPONENT ${component})
  install(FILES ${folder}/_${name} DESTINATION ${datadir}/${zsh_dir} COMPONENT ${component})
  install(FILES ${folder}/${name}.fish DESTINATION ${datadir}/fish/vendor_completions.d COMPONENT ${component})
endfunction()
