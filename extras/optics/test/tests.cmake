test_program(extras_files -O0 SANITIZED)
tests(extras_files "unit;input" scatter)
target_link_libraries(extras_files_tests PRIVATE srbf::optics)
