# Completions and manual pages, made by the program that was built. Not of a
# sanitized build, which is not installed, and not where it cannot be run.

if(ALIDADE_SANITIZE OR CMAKE_CROSSCOMPILING)
  return()
endif()

set(directory ${PROJECT_BINARY_DIR}/shell)
set(script ${PROJECT_SOURCE_DIR}/scripts/shell_files)
add_custom_command(OUTPUT ${directory}/alidade
  COMMAND ${script} $<TARGET_FILE:alidade_cli> ${directory}
  DEPENDS alidade_cli ${script}
  COMMENT "Writing completions and manual pages")
add_custom_target(alidade_shell_files ALL DEPENDS ${directory}/alidade)

install(FILES ${directory}/alidade
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${directory}/_alidade
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES ${directory}/alidade.fish
  DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(DIRECTORY ${directory}/
  DESTINATION ${CMAKE_INSTALL_MANDIR}/man1
  FILES_MATCHING PATTERN "*.1")
