// srbf manual: the manual page and the completions of shells, made of what --help says.
#include "app/commands.h"

namespace srbf {
namespace {

/// Text as roff shows it unchanged.
std::string roff(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if ((out.empty() || out.back() == '\n') && (c == '.' || c == '\'')) out += "\\&";
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else
            out += c;
    }
    return out;
}

/// Lines as they stand.
std::string roff_lines(const std::string& text) { return ".nf\n" + roff(text) + "\n.fi\n"; }

std::string roff(const OptionHelp& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.names) names.push_back("\\fB" + roff(name) + "\\fR");
    const std::string type = option.type.empty() ? "" : " \\fI" + roff(option.type) + "\\fR";
    return fmt::format(".TP\n{}{}\n{}\n", fmt::join(names, ", "), type, roff(option.about));
}

std::string manual_page(const Help& help) {
    const std::size_t colon = help.about.find(": ");
    std::string options;
    for (const OptionHelp& option : help.options) options += roff(option);
    std::string page = fmt::format(
        ".TH {} 1 \"{}\" \"{} {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n"
        ".I SUBCOMMAND\n[\\fIOPTIONS\\fR]\n.SH DESCRIPTION\n{}\n.SH OPTIONS BEFORE THE SUBCOMMAND\n{}.SH SUBCOMMANDS\n",
        "SRBF", SRBF_DATE, help.name, SRBF_VERSION, help.name,
        roff(help.about.substr(colon + 2, help.about.find(".\n") - colon - 2)), help.name,
        roff(help.about.substr(help.about.find('\n') + 1)), options);
    for (const SubcommandHelp& sub : help.subcommands) {
        std::string positionals;
        for (const OptionHelp& option : sub.options)
            if (option.positional) positionals += " " + option.names[0];
        page += fmt::format(".SS {} {} [OPTIONS]{}\n{}.\n", help.name, sub.name, positionals, roff(sub.about));
        for (const OptionHelp& option : sub.options) page += roff(option);
        page += ".PP\n" + roff_lines(sub.footer);
    }
    return page + ".SH EXAMPLE AND EXIT STATUS\n" + roff_lines(help.footer);
}

/// Names of options, without those of positional arguments.
std::vector<std::string> dashed(const SubcommandHelp& sub) {
    std::vector<std::string> names;
    for (const OptionHelp& option : sub.options)
        if (!option.positional) names.insert(names.end(), option.names.begin(), option.names.end());
    return names;
}

std::vector<std::string> names(const Help& help) {
    std::vector<std::string> all;
    for (const SubcommandHelp& sub : help.subcommands) all.push_back(sub.name);
    return all;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// In single quotes, for any shell.
std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

std::string bash(const Help& help) {
    std::string choices, options;
    for (const SubcommandHelp& sub : help.subcommands) {
        options += fmt::format("    {}:*:-*) words='{}' ;;\n", sub.name, fmt::join(dashed(sub), " "));
        for (const OptionHelp& option : sub.options)
            for (const std::string& name : option.names)
                if (!option.choices.empty())
                    choices +=
                        fmt::format("    {}:{}:*) words='{}' ;;\n", sub.name, name, fmt::join(option.choices, " "));
    }
    return fmt::format(
        "# Completion of {0} for bash.\n"
        "_{0}() {{\n"
        "    local word=${{COMP_WORDS[COMP_CWORD]}} words=\n"
        "    case ${{COMP_WORDS[1]}}:${{COMP_WORDS[COMP_CWORD-1]}}:$word in\n"
        "{1}{2}    esac\n"
        "    [ \"$COMP_CWORD\" -gt 1 ] || words='{3}'\n"
        "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
        "}}\n"
        "complete -o default -F _{0} {0}\n",
        help.name, choices, options, fmt::join(names(help), " "));
}

std::string zsh(const Help& help) {
    std::string subcommands, cases;
    for (const SubcommandHelp& sub : help.subcommands) {
        subcommands += fmt::format("    {}\n", quoted(sub.name + ":" + sub.about));
        cases += fmt::format("{})\n    _arguments", sub.name);
        for (const OptionHelp& option : sub.options) {
            // In a specification brackets end the description and colons the parts.
            std::string about;
            for (const char c : first_line(option.about))
                about += std::string("[]:\\").find(c) < 4 ? std::string("\\") + c : std::string(1, c);
            const std::string text =
                option.choices.empty() ? "_files" : fmt::format("({})", fmt::join(option.choices, " "));
            if (option.positional) continue;
            for (const std::string& name : option.names)
                cases +=
                    " \\\n        " + quoted(fmt::format("{}[{}]{}", name, about, option.flag ? "" : ":text:" + text));
        }
        cases += " \\\n        '*:file:_files'\n    ;;\n";
    }
    return fmt::format(
        "#compdef {0}\n# Completion of {0} for zsh.\n"
        "local -a subcommands=(\n{1})\n"
        "if ((CURRENT == 2)); then\n    _describe subcommand subcommands\n    return\nfi\n"
        "shift words\n((CURRENT--))\ncase $words[1] in\n{2}esac\n",
        help.name, subcommands, cases);
}

std::string fish(const Help& help) {
    std::string text = fmt::format("# Completion of {0} for fish.\n", help.name);
    for (const SubcommandHelp& sub : help.subcommands) {
        text += fmt::format("complete -c {} -n __fish_use_subcommand -f -a {} -d {}\n", help.name, sub.name,
                            quoted(sub.about));
        for (const OptionHelp& option : sub.options) {
            if (option.positional) continue;
            text += fmt::format("complete -c {} -n '__fish_seen_subcommand_from {}'", help.name, sub.name);
            for (const std::string& name : option.names)
                text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
            if (!option.choices.empty())
                text += fmt::format(" -x -a '{}'", fmt::join(option.choices, " "));
            else if (!option.flag)
                text += " -r";
            text += " -d " + quoted(first_line(option.about)) + "\n";
        }
    }
    return text;
}

struct Manual {
    const char* name;
    std::string (*text)(const Help&);
};
constexpr Manual k_manuals[] = {{"man", manual_page}, {"bash", bash}, {"zsh", zsh}, {"fish", fish}};

}  // namespace

void add_manual(CommandLine& app, int& status) {
    const auto as = std::make_shared<std::string>("man");
    const Subcommand sub = app.add_subcommand("manual", "Print the manual page, or a shell's completion of options");
    std::vector<std::string> all;
    for (const Manual& manual : k_manuals) all.emplace_back(manual.name);
    sub.add_option("--for", *as, "man: the manual page; otherwise the completion of that shell")
        .type_name("NAME")
        .one_of(all)
        .capture_default_str();
    sub.footer(
        "Examples:\n  srbf manual | man -l -\n"
        "  srbf manual --for bash > ~/.local/share/bash-completion/completions/srbf");
    sub.callback([&app, as, &status] {
        for (const Manual& manual : k_manuals)
            if (*as == manual.name) fmt::print("{}", manual.text(app.help()));
        status = k_done;
    });
}

}  // namespace srbf
