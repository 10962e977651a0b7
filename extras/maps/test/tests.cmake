in_program(maps -O1)
srbf_test(basis                all  fit)
