#include "app/commands.h"

int main(int argc, char** argv) { return srbf::run_program(argc, argv); }
