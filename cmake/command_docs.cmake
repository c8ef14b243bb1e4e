# Man page and completions of a command, made from its --help when it is built, and tested.
# isoshell_command_docs(vdb_isomesh) is all that a further command needs, beside its cases in test_command_docs.sh.
find_package(Python3 COMPONENTS Interpreter QUIET)
find_program(ISOSHELL_GZIP gzip)
# Where zsh looks: Debian keeps completions of packages elsewhere.
set(isoshell_zsh_dir ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
if(EXISTS /etc/debian_version)
  set(isoshell_zsh_dir ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
endif()

function(isoshell_command_docs command)
  if(NOT Python3_Interpreter_FOUND OR NOT ISOSHELL_GZIP OR CMAKE_CROSSCOMPILING)
    message(STATUS "No man page and completions of ${command}: they need Python, gzip and a command that runs here")
    return()
  endif()
  set(folder ${PROJECT_BINARY_DIR}/command_docs)
  set(script ${PROJECT_SOURCE_DIR}/scripts/command_docs.py)
  set(make ${Python3_EXECUTABLE} ${script} $<TARGET_FILE:${command}>)
  file(MAKE_DIRECTORY ${folder})
  set(page ${folder}/${command}.1)
  add_custom_command(OUTPUT ${page} ${page}.gz ${folder}/${command}.bash ${folder}/_${command} ${folder}/${command}.fish
    COMMAND ${make} man > ${page}
    COMMAND ${ISOSHELL_GZIP} -9nc ${page} > ${page}.gz
    COMMAND ${make} bash > ${folder}/${command}.bash
    COMMAND ${make} zsh > ${folder}/_${command}
    COMMAND ${make} fish > ${folder}/${command}.fish
    DEPENDS ${command} ${script} VERBATIM)
  add_custom_target(${command}_docs ALL DEPENDS ${page}.gz)
  install(FILES ${page}.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
  install(FILES ${folder}/${command}.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
          RENAME ${command} COMPONENT runtime)
  install(FILES ${folder}/_${command} DESTINATION ${isoshell_zsh_dir} COMPONENT runtime)
  install(FILES ${folder}/${command}.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
          COMPONENT runtime)
  if(ISOSHELL_TESTS)
    add_test(NAME ${command}_docs COMMAND ${PROJECT_SOURCE_DIR}/tests/cli/test_command_docs.sh ${command} ${folder})
  endif()
endfunction()
