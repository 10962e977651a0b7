list(APPEND parallel_tests closures)
test_program(extras -O1)
tests(extras fit closures)
tests(extras program blender_script)
