test_program(extras -O1)
tests(extras unit scene render likeness)

test_program(extras_files -O0 SANITIZED)
tests(extras_files "unit;input" mesh environment)
if(reads_sanitized)
  set(render ${CMAKE_CURRENT_LIST_DIR}/..)
  add_library(render_reading_sanitized OBJECT ${render}/exr.cpp ${render}/mesh_files.cpp)
  target_link_libraries(render_reading_sanitized PRIVATE srbf_build srbf_sanitized srbf_render TBB::tbb fmt::fmt
                        nlohmann_json::nlohmann_json PkgConfig::OpenEXR)
  target_compile_options(render_reading_sanitized PRIVATE -O1 -g1 -w)
  set_target_properties(render_reading_sanitized PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_link_libraries(extras_files_tests PRIVATE render_reading_sanitized)
endif()

test_program(paths -O0)
tests(paths unit glsl)  # the kernels as shaders
tests(paths "program;input;cores" path)
tests(paths program map_exr)
target_compile_definitions(paths_tests PRIVATE ${compilers})
target_link_libraries(paths_tests PRIVATE PkgConfig::OpenEXR)

test_program(extras_program -O0)
tests(extras_program "program;fit" page)
browser_test(page_in_browser extras_program page Page.ABrowserDrawsThePictureOfTheDesktop)
if(EPOXY_LIBRARY)
  tests(extras_program "program;long" raster)
  set_property(TEST raster PROPERTY ENVIRONMENT LP_NUM_THREADS=1)  # Mesa draws on the processor
endif()
