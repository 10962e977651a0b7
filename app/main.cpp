#include "app/commands.h"

#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#include <windows.h>
#endif

int main(int argc, char** argv) {
#ifdef _WIN32
    // Text is UTF-8, as arguments are by srbf.manifest, and lines end as on other systems.
    ::SetConsoleOutputCP(CP_UTF8);
    ::_setmode(1, _O_BINARY);
    ::_setmode(2, _O_BINARY);
#endif
    return srbf::run_program(argc, argv);
}
