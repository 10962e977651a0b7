test_program(extras -O1)
tests(extras "fit;cores" closures)
tests(extras program blender_script)
