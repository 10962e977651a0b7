in_program(optics SANITIZED)
srbf_test(scatter              one  unit input)
filtered(scatter -*.WriteReadIdentity)
