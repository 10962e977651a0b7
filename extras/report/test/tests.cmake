if(NOT SRBF_SANITIZE)  # its fits take too long under sanitizers
  test_program(extras_program -O0)
  tests(extras_program "program;fit;long" report)
  browser_test(report_in_browser extras_program report Report.IsShownByABrowser)
endif()
