tet4d_add_program(tet4d-play
  SOURCES tet4d-play.cpp play/baseline.cpp play/coloring.cpp play/film.cpp play/options.cpp play/pagers.cpp play/window.cpp
  DEPENDS tet4d::host tet4d::cli)
