# Installs the build into an empty folder and builds against that alone: a user's project and the examples, which are run, and a
# project that asks for a component that does not exist.
include(${CMAKE_CURRENT_LIST_DIR}/used.cmake)
used(${BUILD})
run(${FOLDER}/prefix/bin/srbf info ${FOLDER}/paper.srbf)

# A user's project may compile the library as its part; here, what the build has compiled is copied. Files are joined as
# they are there: a build without ccache joins them, as one does where ccache is switched off.
set(joined)
if(COMPILED_ONCE)
  set(joined ${CMAKE_COMMAND} -E env CCACHE_DISABLE=1)
endif()
run(${joined} ${configure} -S ${SOURCE}/test/install/fetched -B ${FOLDER}/fetched -DFETCHCONTENT_SOURCE_DIR_SRBF=${SOURCE}
    -DCCACHE=${SOURCE}/test/install/fetched/prebuilt.sh)
run(${CMAKE_COMMAND} -E env PREBUILT=${BUILD} ${CMAKE_COMMAND} --build ${FOLDER}/fetched --target user)
run(${FOLDER}/fetched/user ${paper} ${FOLDER}/fetched.srbf)

try(${configure} -S ${SOURCE}/test/install -B ${FOLDER}/without -DCOMPONENTS=window)
if(status EQUAL 0 OR NOT out MATCHES "no component 'window'")
  message(FATAL_ERROR "a component that there does not exist is found, or the error does not name it:\n${out}")
endif()

file(MAKE_DIRECTORY ${FOLDER}/measured)
file(COPY ${paper} ${FOLDER}/paper.srbf DESTINATION ${FOLDER}/measured)
run(${FOLDER}/examples/convert_folder ${FOLDER}/measured ${FOLDER}/converted)
foreach(table paper paper_white_rgb)
  run(${FOLDER}/prefix/bin/srbf info ${FOLDER}/converted/${table}.binary)
  if(NOT out MATCHES "MERL")
    message(FATAL_ERROR "not a MERL table:\n${out}")
  endif()
endforeach()
run(${FOLDER}/examples/path_material ${FOLDER}/paper.srbf)
message("${out}")
run(${FOLDER}/examples/pbrt_test ${FOLDER}/paper.srbf)
run(${FOLDER}/examples/direct_light ${FOLDER}/paper.srbf ${FOLDER}/ball.ppm 1)
run(${FOLDER}/examples/paths ${FOLDER}/paper.srbf ${FOLDER}/paths.ppm 1)
file(READ ${FOLDER}/paper.frag text)
set(number "[^ \n]+")
if(NOT text MATCHES "#define PM_LOBES 4\n.*Vec3 brdf.*void main.*PmNumbers.*\n(// ${number} ${number} ${number} ${number}\n)+$")
  message(FATAL_ERROR "not a shader of four lobes and its numbers:\n${text}")
endif()
if(GLSLANG)
  run(${GLSLANG} ${FOLDER}/paper.frag)
endif()
