// Command lines of a grammar: the subcommands and options that --help lists, with valid and invalid arguments.
#pragma once
#include <filesystem>
#include <fstream>
#include <map>
#include <span>

#include "../test/support/models.h"
#include "base/text.h"
#include "in_process.h"

namespace srbf {

/// A folder with a small file of each kind, and invalid files.
class CommandFolder {
  public:
    CommandFolder() {
        std::filesystem::create_directory(path() / "f");
        const std::string header = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z", direction = "0,0.6,0.8,0,0,1";
        add("p.csv", header + "\n" + direction + "\n");
        add("s.csv", header + ",value\n" + direction + ",1\n");
        add("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        add("e.hdr", "#?RADIANCE\n\n-Y 1 +X 2\n\x80\x40\x40\x81\x20\x40\x80\x80");
        add("empty", "");
        add("text", "nothing that is known\n");
        add("m.srbf", as_text(write_model({axial_gaussians({{0.3f, 0.2f, 0.1f}}, {8}), {}})));
        add("g.srbf", as_text(write_model({grey_facets(), {}})));
        const std::string head = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 3), }\n";
        add("t.npy", "\x93NUMPY" + std::string("\1\0", 2) + char(head.size()) + '\0' + head + std::string(12, '\0'));
    }
    const std::filesystem::path& path() const { return folder_.path; }
    /// The names of new files.
    std::vector<std::string> outputs() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(path()))
            if (const std::string name = entry.path().filename().string(); !files_.contains(name) && name != "f")
                names.push_back(name);
        return names;
    }
    /// Aborts if a file has changed that the line does not name exactly once, as output.
    void check_inputs(const std::vector<std::string>& words) const {
        for (const auto& [name, text] : files_) {
            const auto file = path() / name;
            if (read_text(file) == text) continue;
            require(std::ranges::count(words, name) == 1, "inputs are left as they are");
            write_text(file, text);
        }
    }
    void remove_outputs() const {
        for (const std::string& name : outputs()) std::filesystem::remove_all(path() / name);
        for (const auto& entry : std::filesystem::directory_iterator(path() / "f"))
            std::filesystem::remove_all(entry.path());
    }

  private:
    void add(const std::string& name, std::string_view text) {
        write_text(path() / name, text);
        files_[name] = text;
    }

    TemporaryFolder folder_;
    std::map<std::string, std::string> files_;
};

/// Makes command lines from bytes.
class Grammar {
  public:
    Grammar() {
        int status = 0;
        CommandLine app("srbf", "", "", "");
        add_subcommands(app, status);
        help_ = app.help();
    }

    std::vector<std::string> line(std::span<const std::byte> bytes) const {
        bytes_ = bytes;
        const std::size_t which = next(help_.subcommands.size() + 1);
        if (which == help_.subcommands.size()) return {"srbf", text()};
        const SubcommandHelp& sub = help_.subcommands[which];
        std::vector<std::string> words{"srbf", sub.name};
        // Required arguments are usually present, and pictures are small.
        if (sub.name == "render") words.insert(words.end(), {"--size", "3x2", "--spp", "1"});
        for (const OptionHelp& option : sub.options) {
            const bool is_output = option.names.back() == "--output" && sub.name != "fit";
            if ((option.positional || is_output || option.names.back() == "--to") && next(16) > 0) add(words, option);
        }
        for (std::size_t left = next(k_max_options); left > 0; --left) {
            const OptionHelp& option = sub.options[next(sub.options.size())];
            const bool is_given = std::ranges::count(words, option.names.back()) > 0;
            if (!is_given || next(16) == 1) add(words, option);
        }
        return words;
    }

  private:
    static constexpr std::size_t k_max_options = 5;

    std::size_t next(std::size_t count) const {
        if (bytes_.empty()) return 0;
        const auto byte = std::to_integer<std::size_t>(bytes_[0]);
        bytes_ = bytes_.subspan(1);
        return byte % count;
    }
    template <std::size_t n> std::string choose(const std::array<const char*, n>& all) const { return all[next(n)]; }

    void add(std::vector<std::string>& words, const OptionHelp& option) const {
        if (!option.positional) words.push_back(next(16) == 1 ? option.names[0] : option.names.back());
        if (!option.flag || next(32) == 1) words.push_back(argument(option));
    }
    std::string argument(const OptionHelp& option) const {
        if (next(16) == 1) return text();
        if (!option.choices.empty()) return option.choices[next(option.choices.size())];
        if (option.names.back() == "--output" || option.names.back() == "--json" || option.names.back() == "--preview")
            return output();
        const bool is_file = option.positional || option.type.starts_with("FILE") || option.type.starts_with("REF") ||
                             option.type.starts_with("MEASURED") || option.type.starts_with("P.csv");
        return is_file ? input() : number();
    }
    std::string input() const {
        return choose(std::array{"m.srbf", "g.srbf", "p.csv", "s.csv", "m.obj", "e.hdr", "empty", "text", "t.npy",
                                 "missing", "f", "m.srbf", "m.srbf"});
    }
    std::string output() const {
        return choose(std::array{"x.png", "x.exr", "x.srbf", "x.csv", "x.binary", "x.bsdf", "x.mbsdf", "x.html", "x",
                                 "f", "f/", "f/x.png", "no/x.png", "m.srbf", "/dev/full"});
    }
    std::string number() const {
        return choose(std::array{"1", "2", "0", "8", "30", "0.5", "auto", "-1", "nan", "4x3", "0x1", "0:1", "1:0", "12",
                                 "m=label", "=", "1e9", "99999999999999999999"});
    }
    std::string text() const {
        return choose(std::array{"", "-", "--", "x", "a\nb", "--bogus", "-h", "--version", "\xff\x1b[2J", "/dev/null",
                                 "-o", "=", "--seed=1", "none", "studio", "knot"});
    }

    Help help_;
    mutable std::span<const std::byte> bytes_;
};

/// Runs a command line, and checks that wrong usage writes no file and that inputs remain unchanged. Returns the
/// status.
inline int check_command_line(std::span<const std::byte> bytes) {
    static const CommandFolder folder;
    static const Grammar grammar;
    const std::vector<std::string> words = grammar.line(bytes);
    const InProcess done = run_in_process(folder.path(), words);
    if (done.status == k_usage)
        require(folder.outputs().empty(), fmt::format("{}: wrong usage writes nothing", fmt::join(words, " ")));
    folder.check_inputs(words);
    folder.remove_outputs();
    return done.status;
}

}  // namespace srbf
