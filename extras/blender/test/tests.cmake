in_program(blender -O1)
srbf_test(closures             all  fit)
srbf_test(blender_script       one  program)
