in_program(optics SANITIZED)
srbf_test(scatter              one  unit input)
filtered(scatter -*.WriteReadIdentity)
target_link_libraries(optics_tests PRIVATE srbf::optics)
