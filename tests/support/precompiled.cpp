// Gives limber_test_headers something to compile; the headers are named in tests/CMakeLists.txt.
