// The subcommands, a file each: level 7.
#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace srbf {

/// Exit statuses of the program.
enum Status { k_done = 0, k_input_error = 1, k_usage = 2 };

// Each adds its subcommand; when it is the one chosen, parsing runs it and leaves its exit status in
// `status`.
void add_fit(CLI::App& app, int& status);
void add_info(CLI::App& app, int& status);
void add_eval(CLI::App& app, int& status);
void add_compare(CLI::App& app, int& status);

}  // namespace srbf
