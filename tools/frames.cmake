# The frame options of the programs that take volumes.
add_library(tet4d_frame_options STATIC frames/frame_options.cpp frames/option_text.cpp)
add_library(tet4d::frame_options ALIAS tet4d_frame_options)
target_link_libraries(tet4d_frame_options PUBLIC tet4d::cli tet4d::exchange PRIVATE tet4d_warnings)
