# pugixml, compiled from source.
file(GLOB pugixml_source ${SRBF_SOURCES}/pugixml-*/src)
add_library(pugixml STATIC ${pugixml_source}/pugixml.cpp)
target_include_directories(pugixml SYSTEM PUBLIC ${pugixml_source})
target_compile_definitions(pugixml PUBLIC PUGIXML_NO_STL) # without streams, which are large
add_library(pugixml::pugixml ALIAS pugixml)
set(pugixml_FOUND TRUE)
