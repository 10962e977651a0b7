# `cmake --install`. Users then have find_package(srbf) with the target srbf::srbf, and srbf::shader with
# find_package(srbf COMPONENTS shader). Components of the installation: program, library (if shared), development.
include(GNUInstallDirs)
# install_if_built(FILE FOLDER COMPONENT): installs a file that not every build has, or says that it is left out.
function(install_if_built file folder component)
  install(FILES ${file} DESTINATION ${folder} COMPONENT ${component} OPTIONAL)
  install(CODE "if(NOT EXISTS \"${file}\")
  message(STATUS \"Left out: ${file}. To have it, type: cmake --build ${PROJECT_BINARY_DIR}\")\nendif()"
          COMPONENT ${component})
endfunction()
if(DEFINED SRBF_SOURCES)  # a build with compiled sources of libraries; for WebAssembly ./run site makes the page
  install(CODE "message(FATAL_ERROR \"here only the program is installed: --component program\")" COMPONENT development)
else()
  include(CMakePackageConfigHelpers)
  set(SRBF_PACKAGE ${CMAKE_INSTALL_LIBDIR}/cmake/srbf)
  install(TARGETS srbf EXPORT srbf
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development
          INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  if(TARGET srbf_runtime)
    install_if_built(${CMAKE_CURRENT_BINARY_DIR}/srbf_runtime.h ${CMAKE_INSTALL_INCLUDEDIR} development)
  endif()
  install(TARGETS srbf_shader EXPORT srbf-shader ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  foreach(headers IN LISTS public_headers)
    install(DIRECTORY ${headers}/srbf DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
  endforeach()
  foreach(extra IN LISTS format_extras)
    install(DIRECTORY extras/${extra}/include/srbf DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
  endforeach()
  foreach(exported srbf srbf-shader)
    install(EXPORT ${exported} NAMESPACE srbf:: FILE ${exported}-targets.cmake DESTINATION ${SRBF_PACKAGE}
            COMPONENT development)
  endforeach()
  configure_package_config_file(cmake/srbf-config.cmake.in srbf-config.cmake INSTALL_DESTINATION ${SRBF_PACKAGE})
  write_basic_package_version_file(srbf-config-version.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/srbf-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/srbf-config-version.cmake
          cmake/Findhwy.cmake DESTINATION ${SRBF_PACKAGE} COMPONENT development)
  # The file for pkg-config. Its folder may be moved with the prefix.
  file(RELATIVE_PATH PREFIX_FROM_PKGCONFIG /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  set(REQUIRES Requires)  # a program that links the static library links these too
  if(BUILD_SHARED_LIBS)
    set(REQUIRES Requires.private)
  endif()
  configure_file(cmake/srbf.pc.in srbf.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/srbf.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endif()
