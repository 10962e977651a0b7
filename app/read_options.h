// Options of subcommands that read samples: what their files do not state.
#pragma once
#include <string>
#include <vector>

#include "app/options.h"
#include "srbf/measured.h"

namespace srbf {

/// Adds --columns, --quantity and --floor, which set `to`; it must outlive the command line's parsing.
std::vector<Option> add_read_options(const Subcommand& sub, ReadOptions& to);

}  // namespace srbf
