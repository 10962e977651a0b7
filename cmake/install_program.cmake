install(TARGETS srbf_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
# Files that are made by running the program: completions, and the manual page by help2man.
# install_output(FILE FOLDER COMMAND..): installs the output of the command, written to `manual` in the build folder.
set(printed_files)
function(install_output file folder)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/manual/${file})
  add_custom_command(OUTPUT ${file} COMMAND ${CMAKE_COMMAND} -E make_directory manual COMMAND ${ARGN} > ${file}
                     DEPENDS srbf_app VERBATIM)
  install_if_built(${file} ${folder} program)
  set(printed_files ${printed_files} ${file} PARENT_SCOPE)
endfunction()
install_output(srbf ${CMAKE_INSTALL_DATADIR}/bash-completion/completions srbf_app completion bash)
install_output(_srbf ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions srbf_app completion zsh)
install_output(srbf.fish ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d srbf_app completion fish)
find_program(GZIP gzip)
find_program(HELP2MAN help2man)
if(HELP2MAN AND GZIP)  # compressed, as in distributions
  set(help2man ${HELP2MAN} --no-info --help-option=--help-all --name=${PROJECT_DESCRIPTION} $<TARGET_FILE:srbf_app>)
  install_output(srbf.1.gz ${CMAKE_INSTALL_MANDIR}/man1 ${help2man} | ${GZIP} -9nc)
else()
  message(STATUS "Without help2man or gzip (Debian: help2man, gzip): built without the manual page")
endif()
add_custom_target(srbf_manual ALL DEPENDS ${printed_files})
