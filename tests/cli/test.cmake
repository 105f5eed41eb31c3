# These tests run the executable.
add_dependencies(tests_cli_test raystudy_cli)
