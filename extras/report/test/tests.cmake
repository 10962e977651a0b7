if(NOT SRBF_SANITIZE)  # under which its fits take too long
  in_program(report)
  srbf_test(report               one  program fit)
endif()
