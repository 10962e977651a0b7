// srbf completion: completion scripts for shells, made from the content of --help.
#include "app/commands.h"

namespace srbf {
namespace {

/// Names of the options, without positional arguments.
std::vector<std::string> option_names(const SubcommandHelp& sub) {
    std::vector<std::string> names;
    for (const OptionHelp& option : sub.options)
        if (!option.positional) names.insert(names.end(), option.names.begin(), option.names.end());
    return names;
}

std::vector<std::string> names(const Help& help) {
    std::vector<std::string> names;
    for (const SubcommandHelp& sub : help.subcommands) names.push_back(sub.name);
    return names;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// `text` in single quotes, valid in any shell.
std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

/// Names of the options before the subcommand.
enum class OptionKinds { all, with_text };
std::vector<std::string> names_before(const Help& help, OptionKinds kinds) {
    std::vector<std::string> names;
    for (const OptionHelp& option : help.options)
        if (kinds == OptionKinds::all || !option.flag)
            names.insert(names.end(), option.names.begin(), option.names.end());
    return names;
}

std::string bash(const Help& help) {
    std::string choices, options;
    for (const SubcommandHelp& sub : help.subcommands) {
        options += fmt::format("    {}:*:-*) words='{}' ;;\n", sub.name, fmt::join(option_names(sub), " "));
        for (const OptionHelp& option : sub.options)
            for (const std::string& name : option.names)
                if (!option.choices.empty())
                    choices +=
                        fmt::format("    {}:{}:*) words='{}' ;;\n", sub.name, name, fmt::join(option.choices, " "));
    }
    return fmt::format(
        "# Completion of {0} for bash.\n"
        "_{0}() {{\n"
        "    local word=${{COMP_WORDS[COMP_CWORD]}} words= at=1 # of the subcommand\n"
        "    while [ \"$at\" -lt \"$COMP_CWORD\" ]; do\n"
        "        case ${{COMP_WORDS[at]}} in {4}) at=$((at + 1)) ;; -*) ;; *) break ;; esac\n"
        "        at=$((at + 1))\n"
        "    done\n"
        "    case ${{COMP_WORDS[at]-}}:${{COMP_WORDS[COMP_CWORD-1]}}:$word in\n"
        "{1}{2}    esac\n"
        "    if [ \"$COMP_CWORD\" -eq \"$at\" ]; then\n"
        "        case $word in -*) words='{5}' ;; *) words='{3}' ;; esac\n"
        "    fi\n"
        "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
        "}}\n"
        "complete -o default -F _{0} {0}\n",
        help.name, choices, options, fmt::join(names(help), " "),
        fmt::join(names_before(help, OptionKinds::with_text), "|"),
        fmt::join(names_before(help, OptionKinds::all), " "));
}

std::string zsh(const Help& help) {
    std::string subcommands, cases, before;
    for (const OptionHelp& option : help.options)
        for (const std::string& name : option.names)
            before += fmt::format("    {}\n", quoted(name + ":" + first_line(option.about)));
    for (const SubcommandHelp& sub : help.subcommands) {
        subcommands += fmt::format("    {}\n", quoted(sub.name + ":" + sub.about));
        cases += fmt::format("{})\n    _arguments", sub.name);
        for (const OptionHelp& option : sub.options) {
            // In a specification, brackets end the description and colons separate the parts.
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
        "local -a subcommands=(\n{1})\nlocal -a before=(\n{3})\n"
        "while ((CURRENT > 2)); do\n"
        "    case $words[2] in\n"
        "    {4}) ((CURRENT > 3)) || return; words[2,3]=(); ((CURRENT -= 2)) ;;\n"
        "    -*) words[2]=(); ((CURRENT--)) ;;\n"
        "    *) break ;;\n"
        "    esac\n"
        "done\n"
        "if ((CURRENT == 2)); then\n"
        "    case $words[2] in -*) _describe option before ;; *) _describe subcommand subcommands ;; esac\n"
        "    return\nfi\n"
        "shift words\n((CURRENT--))\ncase $words[1] in\n{2}esac\n",
        help.name, subcommands, cases, before, fmt::join(names_before(help, OptionKinds::with_text), "|"));
}

/// The line that completes an option in fish under the condition `when`.
std::string fish(const Help& help, const OptionHelp& option, const std::string& when) {
    std::string text = fmt::format("complete -c {} -n '{}'", help.name, when);
    for (const std::string& name : option.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!option.choices.empty())
        text += fmt::format(" -x -a '{}'", fmt::join(option.choices, " "));
    else if (!option.flag)
        text += " -r";
    return text + " -d " + quoted(first_line(option.about)) + "\n";
}

std::string fish(const Help& help) {
    std::string text = fmt::format("# Completion of {0} for fish.\n", help.name);
    // The condition also holds after an option with a text, since no such text is a subcommand's name.
    const std::string before = fmt::format("not __fish_seen_subcommand_from {}", fmt::join(names(help), " "));
    for (const OptionHelp& option : help.options) text += fish(help, option, before);
    for (const SubcommandHelp& sub : help.subcommands) {
        text += fmt::format("complete -c {} -n '{}' -f -a {} -d {}\n", help.name, before, sub.name, quoted(sub.about));
        for (const OptionHelp& option : sub.options)
            if (!option.positional) text += fish(help, option, "__fish_seen_subcommand_from " + sub.name);
    }
    return text;
}

struct Shell {
    const char* name;
    std::string (*completion)(const Help&);
};
constexpr Shell k_shells[] = {{"bash", bash}, {"zsh", zsh}, {"fish", fish}};

}  // namespace

void add_completion(CommandLine& app, int& status) {
    const auto shell_name = std::make_shared<std::string>();
    const Subcommand sub = app.add_subcommand("completion", "Print a shell's completion of options");
    std::vector<std::string> choices;
    for (const Shell& shell : k_shells) choices.emplace_back(shell.name);
    sub.add_option("SHELL", *shell_name, "bash, zsh or fish").type_name("").required().one_of(choices);
    sub.footer("Example:\n  srbf completion bash > ~/.local/share/bash-completion/completions/srbf");
    sub.callback([&app, shell_name, &status] {
        for (const Shell& shell : k_shells)
            if (*shell_name == shell.name) fmt::print("{}", shell.completion(app.help()));
        status = k_done;
    });
}

}  // namespace srbf
