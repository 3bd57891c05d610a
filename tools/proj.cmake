# For the C++ of PROJ, which cmake builds: its two hundred small files, each with the same headers, are compiled in batches. PROJ
# provides for that (SKIP_UNITY_BUILD_INCLUSION in its lib_proj.cmake).
set(CMAKE_UNITY_BUILD ON)
