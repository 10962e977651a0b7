// Options of subcommands that read samples. They state what the files do not.
#pragma once
#include "app/options.h"
#include "srbf/measured.h"

namespace srbf {

/// Adds --columns, --quantity and --floor, which set `options`. It must outlive the parsing of the command line.
std::vector<Option> add_read_options(const Subcommand& sub, ReadOptions& options);

}  // namespace srbf
