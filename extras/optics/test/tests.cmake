in_program(extras_files SANITIZED)
srbf_test(scatter              one  unit input)
filtered(scatter -*.WriteReadIdentity)
target_link_libraries(extras_files_tests PRIVATE srbf::optics)
