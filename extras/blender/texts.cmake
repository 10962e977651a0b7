# The texts of Blender's materials, which the page for any browser has too.
embed_texts(blender/script_text.h ${CMAKE_CURRENT_LIST_DIR}/app/nodes.py ${CMAKE_CURRENT_LIST_DIR}/app/closures.osl)
