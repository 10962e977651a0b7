if(NOT SRBF_SANITIZE)  # under which its fits take too long
  in_program(extras_program)
  srbf_test(report               one  program fit)
  in_host(report_in_browser report Report.IsShownByABrowser)
endif()
