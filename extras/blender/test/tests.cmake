in_program(extras -O1)
srbf_test(closures             all  fit)
srbf_test(blender_script       one  program)
