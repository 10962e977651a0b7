# The texts of shaders and of the page, which the page for any browser has too.
set(texts surface surface_pixel whole develop shading pixel environment environment_pixel)
list(TRANSFORM texts REPLACE "(.+)" "${CMAKE_CURRENT_LIST_DIR}/\\1.glsl")
embed_texts(render/shader_text.h ${texts})
set(texts frame.html page.html pictures.html style.css light.js painter.js viewer.js exported.js)
list(TRANSFORM texts PREPEND ${PROJECT_SOURCE_DIR}/web/)
embed_texts(render/page_text.h ${texts})
