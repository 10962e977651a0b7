// The subcommands, one file each.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>

#include "app/options.h"
#include "fit/fit_options.h"

namespace srbf {

/// Exit statuses of the program. k_usage: the command line is invalid regardless of the files' content. k_input_error:
/// a file, a folder or the machine caused the error; the other inputs are still processed.
enum Status { k_done = 0, k_input_error = 1, k_usage = 2 };

/// The program, from its command line to its exit status.
int run_program(int argc, char** argv);

/// A number of type T within [min, max]; not a NaN.
template <typename T> Check within(T min, T max) {
    return [=](const std::string& text) -> std::string {
        T number{};
        const char* end = text.data() + text.size();
        const auto [parsed_end, error] = std::from_chars(text.data(), end, number);
        if (error == std::errc() && parsed_end == end && number >= min && number <= max) return {};
        return fmt::format("expected {} to {}, found {}", min, max, text);
    };
}

/// Adds --threads; 0 stands for all threads of the machine.
inline Option add_threads(const Subcommand& sub, int& threads, const std::string& about) {
    const Option option = sub.add_option("--threads", threads, about).type_name("T");
    return option.check(within(0, k_max_threads)).capture_default_str();
}

/// Accepts "x.png", "x.PNG" and names without an extension, such as the name of a pipe.
inline Check png_name() {
    return [](const std::string& name) -> std::string {
        std::string ending = std::filesystem::path(name).extension().string();
        std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
        return ending.empty() || ending == ".png" ? ""
                                                  : fmt::format("expected a name that ends in .png, found {}", name);
    };
}

// Each function adds its subcommand. If it is chosen, parsing runs it and stores its exit status in `status`.
void add_fit(CommandLine& app, int& status);
void add_info(CommandLine& app, int& status);
void add_eval(CommandLine& app, int& status);
void add_compare(CommandLine& app, int& status);
void add_convert(CommandLine& app, int& status);
void add_edit(CommandLine& app, int& status);
void add_blend(CommandLine& app, int& status);
void add_export(CommandLine& app, int& status);
/// Shell completion. Call it after the others, whose options it prints.
void add_completion(CommandLine& app, int& status);
/// Adds all subcommands.
void add_subcommands(CommandLine& app, int& status);

}  // namespace srbf
