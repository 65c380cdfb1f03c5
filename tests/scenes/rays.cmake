# Rays and the example scenes; taken in by CMakeLists.txt.
estara_test(rays ray_scene_test.cpp offset_test.cpp footprint_test.cpp deformation_test.cpp
            LABEL unit LIBS estara::scenes TBB::tbb)
estara_test(examples examples_test.cpp LABEL end_to_end LIBS estara::scenes)
add_dependencies(test_examples estara-scenes)
