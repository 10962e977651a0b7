# The library in each other form in which it is configured (alone or with the program, static or shared), used as in
# install.cmake.
include(${CMAKE_CURRENT_LIST_DIR}/used.cmake)
# The static library is that of the build, without srbf_runtime.h. The shared one is compiled, quickly.
file(GLOB libraries ${BUILD}/libsrbf.a ${BUILD}/libsrbf_shader.a)
# configured(BUILD OPTION..)
function(configured build)
  run(${configure} -S ${SOURCE} -B ${build} -DSRBF_TESTS=OFF -DSRBF_PYTHON=OFF ${ARGN})
  file(COPY ${libraries} DESTINATION ${build})
endfunction()
if(NOT SHARED)
  configured(${FOLDER}/library_static -DSRBF_LIBRARY_ONLY=ON)
  used(${FOLDER}/library_static)
endif()
configured(${FOLDER}/library_shared -DSRBF_LIBRARY_ONLY=ON -DBUILD_SHARED_LIBS=ON -DCMAKE_CXX_FLAGS_RELEASE=-O1)
run(${CMAKE_COMMAND} --build ${FOLDER}/library_shared)
used(${FOLDER}/library_shared)
file(GLOB libraries ${FOLDER}/library_shared/libsrbf*)
configured(${FOLDER}/whole_shared -DBUILD_SHARED_LIBS=ON)
used(${FOLDER}/whole_shared library development)  # its program is not built

# This example draws with environments, which take long to filter.
find_program(XVFB xvfb-run)
run(${BUILD}/srbf export --help)
if(XVFB AND EXISTS ${FOLDER}/examples/environment_light AND out MATCHES "NAME_environment" AND out MATCHES "dds:")
  run(${BUILD}/srbf export ${FOLDER}/paper.srbf --to glsl --with environment -o ${FOLDER}/paper.glsl)
  run(${BUILD}/srbf export studio --to dds -o ${FOLDER}/studio.dds)
  run(${XVFB} -a ${FOLDER}/examples/environment_light ${FOLDER}/paper.glsl ${FOLDER}/studio.dds ${FOLDER}/paper.png)
  file(SIZE ${FOLDER}/paper.png bytes)
  if(bytes LESS 20000)
    message(FATAL_ERROR "not the picture of a sphere: ${bytes} bytes")
  endif()
endif()
