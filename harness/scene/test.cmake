# Fixtures are packed by libarchive.
target_link_libraries(harness_scene_test PRIVATE LibArchive::LibArchive rapidcheck)
