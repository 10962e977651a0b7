# Debian packages, by `./run package`: srbf (the program), libsrbf0.1 (the shared library) and libsrbf-dev.
set(library libsrbf${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(folder_program srbf)
set(folder_library ${library})
set(folder_development libsrbf-dev)
set(about_program "The program, its manual page and completions of bash, zsh and fish.")
set(about_library "The shared library.")
set(about_development "Headers, the component of shading code, and what find_package of CMake reads.")

# Every Debian package contains the licence and the changelog, compressed without name and time.
set(changes ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz)
if(GZIP)
  execute_process(COMMAND ${GZIP} -9n -c ${PROJECT_SOURCE_DIR}/CHANGELOG.md OUTPUT_FILE ${changes})
endif()
set(CPACK_COMPONENTS_ALL program library development)
foreach(component ${CPACK_COMPONENTS_ALL})
  set(documents ${CMAKE_INSTALL_DATADIR}/doc/${folder_${component}})
  install(FILES LICENSE DESTINATION ${documents} COMPONENT ${component} RENAME copyright EXCLUDE_FROM_ALL)
  install(FILES ${changes} DESTINATION ${documents} COMPONENT ${component} EXCLUDE_FROM_ALL OPTIONAL)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${folder_${component}})
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "A measured BRDF of a megabyte or more becomes a formula of 210 bytes,
a few spherical radial basis functions, which is evaluated, importance
sampled, rendered and exported as shading code.
.
${about_${component}}")
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR srbf)
set(CPACK_PACKAGE_CONTACT "The authors of srbf <srbf@localhost>")
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_SOURCE_DIR}/build/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)  # dpkg-shlibdeps finds the libraries of the binaries
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_CURRENT_BINARY_DIR})
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${library} (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libegl1, libopengl0, libgl1-mesa-dri")  # to draw with OpenGL
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "${library} (= ${PROJECT_VERSION}), libtbb-dev, libhwy-dev, libfmt-dev, libpugixml-dev")
include(CPack)
