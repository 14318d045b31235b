tet4d_add_program(hyper-qslim SOURCES hyper-qslim.cpp qslim/options.cpp qslim/simplify_cells.cpp qslim/simplify_parts.cpp qslim/tell.cpp
                  DEPENDS tet4d::qslim4d tet4d::measure tet4d::cli)
