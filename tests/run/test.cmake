#These tests run the executable itself.
add_dependencies(tests_run_test raystudy_cli)
